"""The same run, however the water and the solids are spread over ranks: bodies and water agree to round-off."""

import csv

import support

END = 0.08  # [s]: more than 200 windows of the small scene, in which the blocks meet
LAYOUTS = ([("separate", fluid, solid) for fluid in (1, 2, 3, 4) for solid in (1, 2)] +
           [("shared", ranks, ranks) for ranks in (1, 2, 3, 4)])


def table(path):
    """Columns of a CSV file by name without unit."""
    with path.open() as stream:
        rows = list(csv.reader(stream))
    names = [name.split("[")[0].strip() for name in rows[0]]
    return {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(names)}


class Layouts(support.SceneTest):
    def result(self, layout, fluid, solid):
        """Last time, {tag: position} and kinetic energy of the water at the end, and the number of windows."""
        self.out = self.folder / f"{layout}-{fluid}-{solid}"
        options = ["--layout", layout, "--fluid-ranks", fluid]
        options += ["--solid-ranks", solid] if layout == "separate" else []
        outcome = self.run_scene(*options, "--end-time", END, "--set", "output.bodies_every=0")
        self.assertEqual(outcome.status, 0, outcome)
        bodies = table(self.out / "bodies.csv")
        last = bodies["t"][-1]
        positions = {int(tag): (x, y, z) for t, tag, x, y, z in
                     zip(*(bodies[name] for name in ("t", "tag", "x", "y", "z"))) if t == last}
        energies = table(self.out / "energies.csv")
        kinetic = next(values[-1] for name, values in energies.items() if "kinetic" in name)
        return last, positions, kinetic, len(set(bodies["t"]))

    def test_layouts_agree(self):
        reference = self.result(*LAYOUTS[0])
        time, positions, kinetic, windows = reference
        self.assertGreaterEqual(windows, 200)
        self.assertEqual(sorted(positions), [1, 2])
        start = table(self.out / "bodies.csv")
        self.assertGreater(abs(positions[2][0] - start["x"][1]), 5e-3, "the second block must have moved")
        for layout in LAYOUTS[1:]:
            with self.subTest(layout=layout):
                other_time, other_positions, other_kinetic, other_windows = self.result(*layout)
                self.assertEqual((other_time, other_windows), (time, windows))
                self.assertEqual(sorted(other_positions), sorted(positions))
                for tag, position in positions.items():
                    for mine, other in zip(position, other_positions[tag]):
                        self.assertAlmostEqual(mine, other, delta=1e-9)
                self.assertAlmostEqual(other_kinetic, kinetic, delta=1e-9 * kinetic)


if __name__ == "__main__":
    support.main()
