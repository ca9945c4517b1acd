"""Single spheres: stock hertz in liggghts-mps is stock hertz; the contact laws of the plugin against it, against each other
and against closed forms. Usage: contact_laws.py MPIEXEC LIGGGHTS_MPS PRELOAD_LIBRARY [LIGGGHTS]"""

import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

MPIEXEC, LIGGGHTS_MPS, PRELOAD = sys.argv[1:4]
LIGGGHTS = sys.argv[4] if len(sys.argv) > 4 else "liggghts"
MASS, RADIUS, GRAVITY = 1200 * math.pi / 6 * 1e-3, 0.05, 9.81

# Stock liggghts 3.8.0, time step 1e-6 s, sphere of 0.1 m and 1200 kg/m3 from 2 m onto a floor (thesis, table 4.3), restitution
# 0.5: duration [s], largest force [N], height of the centre before [m] of the contacts in turn.
DROP_CONTACTS = [(0.002389, 4956.146, 2.00000), (0.002749, 2155.881, 0.53569), (0.003168, 937.239, 0.17042),
                 (0.003668, 406.883, 0.07954), (0.004295, 176.072, 0.05706)]


def ratio_of(restitution):
    """Contact ratio of the same damping as LIGGGHTS' restitution."""
    logarithm = math.log(restitution)
    return -math.sqrt(10) / 3 * logarithm / math.hypot(logarithm, math.pi)


def head(model, restitution=0.5, young=7e7, friction=0.6, floor=2.1e11, poisson=0.1):
    ratio = ratio_of(restitution)
    return f"""atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
units si
hard_particles yes
region reg block -1 1 -1 1 -0.5 3 units box
create_box 2 reg
neighbor 0.05 bin
neigh_modify delay 0
fix m1 all property/global youngsModulus peratomtype {young!r} {floor!r}
fix m2 all property/global poissonsRatio peratomtype {poisson} 0.3
fix m3 all property/global coefficientRestitution peratomtypepair 2{f" {restitution!r}" * 4}
fix m4 all property/global coefficientFriction peratomtypepair 2{f" {friction!r}" * 4}
fix m5 all property/global contactRatio peratomtypepair 2{f" {ratio!r}" * 4}
fix m6 all property/global collisionDampingRatio peratomtypepair 2{f" {ratio!r}" * 4}
pair_style gran {model}
pair_coeff * *
timestep 1e-6
"""


def drop(model, wall="primitive type 2 zplane 0.0", steps=1900000, **properties):
    return head(model, **properties) + f"""fix gravity all gravity {GRAVITY} vector 0.0 0.0 -1.0
{wall if wall.startswith("fix") else f"fix wall all wall/gran {model} {wall}"}
create_atoms 1 single 0 0 2 units box
set group all density 1200 diameter 0.1
fix motion all nve/sphere
variable z equal z[1]
variable vz equal vz[1]
variable fz equal fz[1]
fix out all print 5 "${{z}} ${{vz}} ${{fz}}" file out screen no title "z vz fz"
thermo 100000
run {steps}
"""


def collision(model, **properties):
    """Two unequal spheres that spin collide off centre, across a border of two ranks."""
    return head(model, **properties) + """create_atoms 1 single -0.06 0.01 0 units box
create_atoms 1 single 0.06 0 0 units box
set atom 1 density 1200 diameter 0.1
set atom 2 density 900 diameter 0.12
velocity all set 0 0 0
set atom 1 vx 2 vy -0.3 vz 0.1
set atom 1 omegax 1 omegay -2 omegaz 9
set atom 2 vx -1 vy 0.2 vz 0
set atom 2 omegax 3 omegay 0.5 omegaz 4
fix motion all nve/sphere
dump d all custom 100 dump.* id x y z vx vy vz omegax omegay omegaz
dump_modify d sort id format "%d %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g"
run 20000
"""


def contacts(rows, step=5e-6):
    """(duration, largest force, height before, velocity in, velocity out) of the contacts in a drop; duration with the
    moments of touching and leaving interpolated."""
    found, apex, start = [], 0, None
    for k in range(1, len(rows)):
        (z0, v0, _), (z1, v1, force) = rows[k - 1], rows[k]
        if start is None:
            apex = max(apex, z1)
            if z1 < RADIUS:
                start, peak, speed = k - (RADIUS - z1) / (z0 - z1), 0, v0
        if start is not None:
            peak = max(peak, force + MASS * GRAVITY)
            if z1 >= RADIUS:
                found.append(((k - (z1 - RADIUS) / (z1 - z0) - start) * step, peak, apex, speed, v1))
                start, apex = None, 0
    return found


class Laws(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="embacle-laws-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_script(self, script, program=LIGGGHTS_MPS, ranks=1, status=0, preload=None):
        (self.folder / "in.script").write_text(script)
        for old in [*self.folder.glob("dump.*"), *self.folder.glob("out")]:
            old.unlink()
        command = [MPIEXEC, "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "--mca",
                   "btl_vader_single_copy_mechanism", "none", "-n", str(ranks), program, "-in", "in.script"]
        done = subprocess.run(command if ranks > 1 else command[-3:], cwd=self.folder, capture_output=True, text=True,
                              timeout=200, env=os.environ | ({"LD_PRELOAD": preload} if preload else {}))
        self.assertEqual(done.returncode, status, done.stdout[-2000:] + done.stderr)
        return done.stdout + done.stderr

    def rows(self):
        lines = (self.folder / "out").read_text().splitlines()[1:]
        return [tuple(map(float, line.split())) for line in lines]

    def dumps(self):
        """Text of all dumps, by step."""
        return {int(path.suffix[1:]): path.read_text() for path in self.folder.glob("dump.*")}

    def last_state(self):
        dumps = self.dumps()
        lines = dumps[max(dumps)].splitlines()
        start = next(i for i, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
        return [tuple(map(float, line.split()[1:])) for line in lines[start + 1:]]

    def test_stock_hertz_is_the_same_in_the_driver(self):
        model = "model hertz tangential history"
        self.run_script(drop(model), LIGGGHTS)
        printed = (self.folder / "out").read_text()
        self.run_script(collision(model), LIGGGHTS)
        dumped = self.dumps()
        self.run_script(drop(model))
        self.assertEqual((self.folder / "out").read_text(), printed)
        self.run_script(collision(model))
        self.assertEqual(self.dumps(), dumped)
        self.assertGreater(len(dumped), 100)

    def test_drop_is_that_of_the_reference(self):
        self.run_script(drop("model hertz tangential history"))
        measured = contacts(self.rows())
        self.assertGreaterEqual(len(measured), len(DROP_CONTACTS))
        for number, (found, expected) in enumerate(zip(measured, DROP_CONTACTS), 1):
            errors = [100 * (a / b - 1) for a, b in zip(found, expected)]
            print("contact {}: duration {:+.3f} %, largest force {:+.3f} %, apex {:+.4f} %".format(number, *errors))
            self.assertLess(abs(errors[0]), 0.5)
            self.assertLess(abs(errors[1]), 0.5)
            self.assertLess(abs(errors[2]), 1)

    def test_laws_on_a_wall_are_hertz_of_the_same_restitution(self):
        self.run_script(drop("model hertz tangential history", steps=700000))
        hertz = self.rows()
        for law in ("contact_ratio", "river_ice"):
            for tangential in (law, "history", "no_history", "off"):
                with self.subTest(law=law, tangential=tangential):
                    self.run_script(drop(f"model {law} tangential {tangential}", steps=700000))
                    for a, b in zip(self.rows(), hertz):
                        self.assertAlmostEqual(a[0], b[0], delta=1e-9)
                        self.assertAlmostEqual(a[1], b[1], delta=1e-7)

    def test_mesh_is_as_the_primitive_wall(self):
        (self.folder / "floor.stl").write_text(
            "solid s\nfacet normal 0 0 1\nouter loop\nvertex -0.9 -0.9 0\nvertex 0.9 -0.9 0\nvertex 0 0.9 0\nendloop\n"
            "endfacet\nendsolid s\n")
        for law in ("contact_ratio", "river_ice"):
            model = f"model {law} tangential {law}"
            self.run_script(drop(model, steps=700000))
            primitive = self.rows()
            self.run_script(drop(model, "fix floor all mesh/surface file floor.stl type 2\n"
                                 f"fix wall all wall/gran {model} mesh n_meshes 1 meshes floor", steps=700000))
            for a, b in zip(self.rows(), primitive):
                self.assertAlmostEqual(a[0], b[0], delta=1e-9)

    def test_pair_of_spheres(self):
        """Without friction contact_ratio is hertz, and river_ice, whose length is the diameter, hertz of sqrt 2 the modulus."""
        for law, factor in (("contact_ratio", 1), ("river_ice", math.sqrt(2))):
            self.run_script(collision("model hertz tangential history", young=factor * 7e7, friction=0.0))
            hertz = self.last_state()
            self.run_script(collision(f"model {law} tangential {law}", friction=0.0))
            for a, b in zip(self.last_state(), hertz):
                for value, expected in zip(a, b):
                    self.assertAlmostEqual(value, expected, delta=1e-9)

    def momenta(self, state):
        """Momentum, angular momentum about the origin and kinetic energy of the two spheres."""
        linear, angular, energy = [0.0] * 3, [0.0] * 3, 0.0
        for (x, y, z, vx, vy, vz, *spin), (density, radius) in zip(state, ((1200, 0.05), (900, 0.06))):
            mass = density * 4 / 3 * math.pi * radius**3
            inertia = 0.4 * mass * radius**2
            cross = (y * vz - z * vy, z * vx - x * vz, x * vy - y * vx)
            for d in range(3):
                linear[d] += mass * (vx, vy, vz)[d]
                angular[d] += mass * cross[d] + inertia * spin[d]
            energy += 0.5 * mass * (vx**2 + vy**2 + vz**2) + 0.5 * inertia * sum(w * w for w in spin)
        return linear + angular, energy

    def test_collision_conserves_momentum_on_any_number_of_ranks(self):
        for law in ("contact_ratio", "river_ice"):
            self.run_script(collision(f"model {law} tangential {law}"))
            after = self.last_state()
            before = [(-0.06, 0.01, 0, 2, -0.3, 0.1, 1, -2, 9), (0.06, 0, 0, -1, 0.2, 0, 3, 0.5, 4)]
            (start, energy_before), (end, energy_after) = self.momenta(before), self.momenta(after)
            for a, b in zip(end, start):
                self.assertAlmostEqual(a, b, delta=1e-12)
            self.assertLess(energy_after, 0.8 * energy_before)
            self.assertGreater(abs(after[0][6] - 1) + abs(after[0][8] - 9), 0.1)  # friction has turned it
            self.run_script(collision(f"model {law} tangential {law}"), ranks=2)
            for a, b in zip(self.last_state(), after):
                for value, expected in zip(a, b):
                    self.assertAlmostEqual(value, expected, delta=1e-11)

    def test_restart_amid_a_contact_changes_nothing(self):
        for law in ("contact_ratio", "river_ice"):
            whole = collision(f"model {law} tangential {law}").replace(
                "run 20000", "run 3700\nwrite_restart amid.restart\nrun 4300")
            self.run_script(whole)
            after = self.last_state()
            start, end = whole.index("region reg"), whole.index("neighbor")
            rest = whole[:start] + "read_restart amid.restart\n" + whole[end:whole.index("create_atoms")]
            rest += whole[whole.index("fix motion"):].replace("run 3700\nwrite_restart amid.restart\n", "")
            for ranks in (1, 2):
                self.run_script(rest, ranks=ranks)
                self.assertNotIn(3600, self.dumps())
                self.assertEqual(self.last_state(), after)

    def test_sliding_sphere_ends_rolling(self):
        """From 1 m/s without spin to 5/7 m/s, in 2 v / (7 mu g) with sharp friction, not before with a smooth one."""
        for law in ("contact_ratio", "river_ice"):
            model = f"model {law} tangential {law}"
            self.run_script(head(model, friction=0.3) + f"""fix gravity all gravity {GRAVITY} vector 0 0 -1
fix wall all wall/gran {model} primitive type 2 zplane 0.0
create_atoms 1 single -0.5 0 0.04999 units box
set group all density 1200 diameter 0.1
set group all vx 1
fix motion all nve/sphere
variable vx equal vx[1]
variable spin equal omegay[1]
variable fx equal fx[1]
fix out all print 100 "${{vx}} ${{spin}} ${{fx}}" file out screen no title "vx spin fx"
run 600000
""")
            rows = self.rows()
            rolling = next(k for k, (v, w, _) in enumerate(rows) if v - w * RADIUS < 0.01)
            print(f"{law}: rolls after {rolling * 1e-4:.4f} s (sharp friction: 0.0971 s), ends at {rows[-1][0]:.6f} m/s")
            self.assertGreater(rolling * 1e-4, 0.095)
            self.assertLess(rolling * 1e-4, 0.2)
            self.assertAlmostEqual(rows[-1][0], 5 / 7, delta=2e-3)
            self.assertAlmostEqual(rows[-1][1] * RADIUS, 5 / 7, delta=2e-3)

    def test_what_does_not_fit_is_refused(self):
        works = "works with tangential {0}, history, no_history or off"
        for model, message in [
                ("model contact_ratio tangential tan_luding", works.format("contact_ratio")),
                ("model contact_ratio tangential river_ice", works.format("contact_ratio")),
                ("model river_ice tangential history rolling_friction epsd2", works.format("river_ice")),
                ("model river_ice tangential off cohesion sjkr", works.format("river_ice")),
                ("model contact_ratio tangential history surface multicontact", works.format("contact_ratio")),
                ("model hertz tangential river_ice", "tangential river_ice: works with model river_ice only"),
                ("model river_ice tangential river_ice slip_velocity 0", "must be a number above 0"),
                ("model river_ice tangential river_ice slip_velocity fast", "must be a number above 0")]:
            with self.subTest(model=model):
                self.assertIn(message, self.run_script(drop(model, steps=1), status=2))
                self.assertIn(message, self.run_script(drop(model, steps=1), LIGGGHTS, status=2, preload=PRELOAD))
                if "slip" not in model:
                    wall = f"fix wall all wall/gran {model} primitive type 2 zplane 0.0"
                    stock = drop("model hertz tangential history", wall, steps=1)
                    self.assertIn(message, self.run_script(stock, status=2))
        model, options = "model contact_ratio tangential contact_ratio", " limitForce on slip_velocity 0.01"
        good = drop(model, "primitive type 2 zplane 0.0" + options, steps=1).replace(
            f"pair_style gran {model}", f"pair_style gran {model}{options}")
        self.run_script(good)
        self.run_script(good, LIGGGHTS, preload=PRELOAD)
        ratio = f" {ratio_of(0.5)!r}"
        for law, name in (("contact_ratio", "contactRatio"), ("river_ice", "collisionDampingRatio")):
            good = drop(f"model {law}", steps=1)
            for wrong in ("-0.1", "1.2"):
                line = f"{name} peratomtypepair 2"
                self.assertIn(f"the property '{name}' of the types 1 and 1 is ",
                              self.run_script(good.replace(line + ratio * 4, line + f" {wrong}" * 4), status=2))
            self.assertIn(name, self.run_script(good.replace(f"all property/global {name}", "all property/global other"),
                                                status=2))
            self.assertIn("units si", self.run_script(good.replace("units si", "units cgs"), status=2))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
