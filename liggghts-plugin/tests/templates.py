"""Templates of `liggghts-mps --template` in the stock program: `insert/pack` and `insert/stream` make bodies of them, with
the mass and moments of the textbook. Usage: templates.py MPIEXEC LIGGGHTS_MPS [LIGGGHTS]"""

import math
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

MPIEXEC, WRITER = sys.argv[1:3]
LIGGGHTS = sys.argv[3] if len(sys.argv) > 3 else "liggghts"
DENSITY = 900.0

HEAD = """units si
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
region domain block -3 3 -3 3 -1 5 units box
create_box 1 domain
neighbor 0.02 bin
neigh_modify delay 0
fix m1 all property/global youngsModulus peratomtype 5e7
fix m2 all property/global poissonsRatio peratomtype 0.3
fix m3 all property/global coefficientRestitution peratomtypepair 1 0.5
fix m4 all property/global coefficientFriction peratomtypepair 1 0.4
pair_style gran model hertz tangential history
pair_coeff * *
timestep 1e-4
fix gravity all gravity 9.81 vector 0 0 -1
"""
TETRAHEDRON = [(0, 0, 0), (600, 0, 0), (0, 600, 0), (0, 0, 600)]  # [mm]


def facets(triangles):
    return "solid s\n" + "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*corner) for corner in triangle) +
        "endloop\nendfacet\n" for triangle in triangles) + "endsolid s\n"


def corner_tetrahedron(leg):
    """Mass and ascending principal moments of the tetrahedron of three equal legs along the axes."""
    mass = DENSITY * leg**3 / 6
    # Integrals over the volume about the corner: x^2: leg^5/60, x y: leg^5/120; centre leg/4.
    square, product = leg**5 / 60 - leg**3 / 6 * leg**2 / 16, leg**5 / 120 - leg**3 / 6 * leg**2 / 16
    about_diagonal, across = 2 * square - 2 * product, 2 * square + product
    return mass, sorted([DENSITY * about_diagonal, DENSITY * across, DENSITY * across])


def shapes():
    """Words of a shape, mass and ascending principal moments."""
    mass = DENSITY * 0.5 * 0.3 * 0.1
    box = mass, sorted(mass / 12 * (a * a + b * b) for a, b in [(0.3, 0.1), (0.5, 0.1), (0.5, 0.3)])
    mass = DENSITY * math.pi * 0.3**2 * 0.1
    disc = mass, sorted([mass * 0.3**2 / 2] + 2 * [mass * (3 * 0.3**2 + 0.1**2) / 12])
    # Right triangle with legs 0.6 and 0.4: moments of the tensor with a product of inertia.
    mass = DENSITY * 0.12 * 0.1
    xx, yy, xy = mass * (0.16 / 18 + 0.01 / 12), mass * (0.36 / 18 + 0.01 / 12), mass * 0.24 / 36
    middle, radius = (xx + yy) / 2, math.hypot((xx - yy) / 2, xy)
    prism = mass, sorted([middle - radius, middle + radius, mass * (0.36 + 0.16) / 18])
    return {
        "box": (["shape", "box", "0.5", "0.3", "0.1", "spacing", "0.1"], box),
        "disc": (["shape", "disc", "0.3", "0.1", "spheres", "40"], disc),
        "prism": ("shape prism 0.1 3 0 0 0.6 0 0 0.4 spheres 25".split(), prism),
        "stl": ("shape stl solid.stl scale 0.001 spheres 30".split(), corner_tetrahedron(0.6)),
    }


class Templates(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="embacle-templates-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        o, a, b, c = TETRAHEDRON
        (self.folder / "solid.stl").write_text(facets([(o, b, a), (o, a, c), (a, b, c), (b, o, c)]))
        (self.folder / "face.stl").write_text(facets([((-1, -1, 3), (1, -1, 3), (1, 1, 3)),
                                                      ((-1, -1, 3), (1, 1, 3), (-1, 1, 3))]))

    def run_here(self, *command):
        return subprocess.run(list(map(str, command)), cwd=self.folder, capture_output=True, text=True, timeout=120)

    def write(self, name, number):
        outcome = self.run_here(WRITER, "--template", name, *shapes()[name][0], "density", DENSITY, "id", name,
                                "type", number)
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        return [tuple(map(float, line.split())) for line in (self.folder / f"{name}.spheres").read_text().splitlines()]

    def liggghts(self, ranks, names, *commands):
        """The log of a run with the templates, in the order of the names."""
        script = HEAD + "".join(f"include {name}.template\n" for name in names)
        shares = " ".join(f"{name} {1 / len(names)}" for name in names)
        script += f"fix shares all particledistribution/discrete 67867979 {len(names)} {shares}\n"
        (self.folder / "in.script").write_text(script + "\n".join(commands) + "\n")
        outcome = self.run_here(MPIEXEC, "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "--mca",
                                "btl_vader_single_copy_mechanism", "none", "-n", ranks, LIGGGHTS, "-in", "in.script")
        self.assertEqual(outcome.returncode, 0, outcome.stdout + outcome.stderr)
        return (self.folder / "log.liggghts").read_text()

    def atoms(self, step):
        """Numbers of each atom by its ID."""
        lines = (self.folder / f"dump.{step}").read_text().splitlines()
        start = next(i for i, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
        return {int(line.split()[0]): tuple(map(float, line.split()[1:])) for line in lines[start + 1:]}

    def test_pack_makes_exact_bodies(self):
        for name, (_, (mass, moments)) in shapes().items():
            spheres = self.write(name, 1)
            for ranks in (1, 2, 4) if name == "prism" else (1,):
                with self.subTest(name=name, ranks=ranks):
                    log = self.liggghts(
                        ranks, [name], "region heap block -2 2 -2 2 0 3 units box",
                        "fix in all insert/pack seed 32452843 distributiontemplate shares insert_every once overlapcheck "
                        "yes orientation random vel constant 0 0 0 particles_in_region 10 region heap",
                        "fix motion all multisphere", "dump d all custom 50 dump.* id x y z radius",
                        'dump_modify d format "%d %.16g %.16g %.16g %.16g"', "run 200")
                    stated = re.search(r"mass = (\S+), radius of bounding", log)
                    self.assertAlmostEqual(float(stated[1]) / mass, 1, delta=1e-6)
                    stated = re.search(r"Principal moments of inertia_: (\S+), (\S+), (\S+)", log)
                    for value, expected in zip(sorted(map(float, stated.groups())), moments):
                        self.assertAlmostEqual(value / expected, 1, delta=1e-6)
                    stated = re.search(r"inserted (\d+) particle templates \(mass (\S+)\)", log)
                    self.assertEqual(int(stated[1]), 10)
                    self.assertAlmostEqual(float(stated[2]) / (10 * mass), 1, delta=1e-6)
                    self.check_fall(len(spheres))
                    if ranks == 1:
                        self.check_shape(spheres)

    def check_fall(self, spheres):
        """Nothing touches: every sphere falls with gravity alone."""
        before, middle, after = self.atoms(100), self.atoms(150), self.atoms(200)
        self.assertEqual(len(after), 10 * spheres)
        for atom, place in after.items():
            acceleration = (place[2] - 2 * middle[atom][2] + before[atom][2]) / 0.005**2
            self.assertAlmostEqual(acceleration, -9.81, delta=1e-6)

    def check_shape(self, spheres):
        """Each body's spheres are apart as in the file (a body has its atoms in the order of the file)."""
        atoms = [place for _, place in sorted(self.atoms(200).items())]
        for first in range(0, len(atoms), len(spheres)):
            for i, sphere in enumerate(spheres):
                self.assertAlmostEqual(atoms[first + i][3], sphere[3], delta=1e-12)
                self.assertAlmostEqual(math.dist(atoms[first + i][:3], atoms[first][:3]),
                                       math.dist(sphere[:3], spheres[0][:3]), delta=1e-9)

    def test_stream_takes_all_templates_together(self):
        names = list(shapes())
        for number, name in enumerate(names, 1):
            self.write(name, number)
        log = self.liggghts(
            2, names, "fix face all mesh/surface/planar file face.stl type 1",
            "fix in all insert/stream seed 32452843 distributiontemplate shares nparticles 12 massrate 2000 overlapcheck "
            "yes orientation random vel constant 0 0 -4 insertion_face face extrude_length 1.7",
            "fix motion all multisphere", "run 1000")
        self.assertIn("a total of 12 particle templates", log)

    def test_mistakes_end_with_status_2(self):
        for words, message in [(["shape", "bax", "1"], "did you mean 'box'"),
                               (["shape", "box", "1", "1", "0.1", "density", "900", "spheres", "3"], "at least 4 spheres"),
                               (["shape", "box", "1", "1", "1", "spacing", "1"], "'density'"),
                               (["shape", "stl", "none.stl"], "cannot read the STL file 'none.stl'"),
                               (["shape", "sphere", "1", "density", "1"], "particletemplate/sphere")]:
            outcome = self.run_here(WRITER, "--template", "wrong", *words)
            self.assertEqual(outcome.returncode, 2, outcome)
            self.assertIn("liggghts-mps: error: liggghts-mps --template: ", outcome.stderr)
            self.assertIn(message, outcome.stderr)
            self.assertFalse((self.folder / "wrong.template").exists())
        outcome = self.run_here(WRITER, "--template", "no/folder", *shapes()["box"][0], "density", DENSITY)
        self.assertEqual(outcome.returncode, 4, outcome)
        self.assertIn("cannot write 'no/folder.spheres'", outcome.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
