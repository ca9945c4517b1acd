"""Bodies of plane faces in the water: a prism that is a box moves like the box; prisms and solids of triangles float, and
move alike on any number of ranks."""

import json

import support
from layouts import table

END = 0.08  # [s]

# An L, and a lying wedge from an STL file: no symmetry, and principal axes of their own.
MIXED = """shape prism 0.04 6 0 0 0.08 0 0.08 0.04 0.04 0.04 0.04 0.08 0 0.08 density 600 spacing 0.02 &
                position 0.05 0.06 0.09 shape stl wedge.stl scale 0.001 density 600 spheres 30 &
                position 0.145 0.06 0.09
"""
MASSES = {1: 600 * 0.0048 * 0.04, 2: 600 * 0.00245 * 0.05}  # [kg]


def wedge():
    """A triangular prism in millimetres."""
    corner = [(0, 0), (70, 0), (0, 70)]
    low, high = [(x, y, 0) for x, y in corner], [(x, y, 50) for x, y in corner]
    triangles = [tuple(high), tuple(reversed(low))]
    for k in range(3):
        after = (k + 1) % 3
        triangles += [(low[k], low[after], high[after]), (low[k], high[after], high[k])]
    facets = ("facet normal 0 0 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*c) for c in t) +
              "endloop\nendfacet\n" for t in triangles)
    return "solid wedge\n" + "".join(facets) + "endsolid wedge\n"


class Shapes(support.SceneTest):
    def bodies(self, name, ranks=1, end=END):
        """Columns of bodies.csv."""
        self.out = self.folder / name
        outcome = self.run_scene("--layout", "shared", "--fluid-ranks", ranks, "--end-time", end)
        self.assertEqual(outcome.status, 0, outcome)
        return table(self.out / "bodies.csv")

    def assert_same(self, one, other, tolerance):
        self.assertEqual(one["tag"], other["tag"])
        for name in ("t", "x", "y", "z", "qw", "qx", "qy", "qz"):
            for a, b in zip(one[name], other[name], strict=True):
                self.assertAlmostEqual(a, b, delta=tolerance, msg=name)

    def use_mixed(self):
        self.edit("in.blocks", "shape box 0.06 0.06 0.03 density 870 spacing 0.015 &\n"
                               "                position 0.055 0.06 0.0689 position 0.145 0.06 0.0689 velocity -0.3 0 0\n",
                  MIXED)
        (self.scene / "wedge.stl").write_text(wedge())

    def test_a_prism_that_is_a_box_moves_like_it(self):
        box = self.bodies("box")
        self.edit("in.blocks", "shape box 0.06 0.06 0.03", "shape prism 0.03 4 0 0 0.06 0 0.06 0.06 0 0.06")
        prism = self.bodies("prism")
        self.assertGreater(max(box["vz"]), 0.01)  # the water moves them
        self.assert_same(box, prism, 1e-9)

    def test_ranks_agree(self):
        self.use_mixed()
        one = self.bodies("1")
        for ranks in (2, 4):
            self.assert_same(one, self.bodies(str(ranks), ranks), 1e-9)
        kinds = [shape["kind"] for shape in json.loads((self.out / "shapes.json").read_text())["shapes"]]
        self.assertEqual(kinds, ["prism", "surface"])

    def test_they_float(self):
        self.use_mixed()
        bodies = self.bodies("float", 2, 0.5)
        for tag, mass in MASSES.items():
            lift = [f for t, number, f in zip(bodies["t"], bodies["tag"], bodies["fz"]) if number == tag and t > 0.25]
            self.assertAlmostEqual(sum(lift) / len(lift) / (9.81 * mass), 1, delta=0.05)
        summary = json.loads((self.out / "summary.json").read_text())
        self.assertIn('"water_inside_bodies": 0', json.dumps(summary))

    def test_a_solid_in_flat_water_is_refused(self):
        self.use_mixed()
        for name, old, new in [("scene.toml", "dimension = 3", "dimension = 2"),
                               ("scene.toml", '["-5 cm", "-5 cm", "-5 cm"]', '["-5 cm", "-5 cm"]'),
                               ("scene.toml", '["25 cm", "17 cm", "30 cm"]', '["25 cm", "30 cm"]'),
                               ("scene.toml", '[0, 0, "-9.81 m/s2"]', '[0, "-9.81 m/s2"]'),
                               ("scene.toml", 'lower = [0, 0, 0]\nupper = ["20 cm", "12 cm", "20 cm"]\nopen = ["z+"]',
                                'lower = [0, 0]\nupper = ["20 cm", "20 cm"]\nopen = ["y+"]'),
                               ("scene.toml", 'lower = [0, 0, 0]\nupper = ["20 cm", "12 cm", "8 cm"]',
                                'lower = [0, 0]\nupper = ["20 cm", "8 cm"]'),
                               ("in.blocks", "vector 0 0 -1", "vector 0 -1 0")]:
            self.edit(name, old, new)
        self.assert_refused(self.run_scene(), 2, "two-dimensional water.*boxes, prisms or cylinders")


if __name__ == "__main__":
    support.main()
