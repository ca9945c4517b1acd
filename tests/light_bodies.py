"""Bodies that weigh a thousandth of the water that they displace, and less: stable with nothing set for them."""

import json

import support


class LightBodies(support.SceneTest):
    """The two blocks of the small tank, held 26 mm deep and let go."""

    END = 0.06  # [s]

    def setUp(self):
        super().setUp()
        self.density = "870"
        self.edit("in.blocks", " velocity -0.3 0 0", "")

    def heights(self, density, *options):
        """Heights of the blocks at the end [m]. The water's momentum must balance and the solids apply what it felt."""
        self.edit("in.blocks", f"density {self.density} ", f"density {density} ")
        self.density = density
        self.out = self.folder / "-".join(str(part).replace("/", "") for part in (density, *options))
        outcome = self.run_scene("--end-time", self.END, "--set", "output.audit=true", *options)
        self.assertEqual(outcome.status, 0, outcome)
        audit = json.loads((self.out / "summary.json").read_text())["audit"]
        self.assertLess(audit["reaction_mismatch"], 1e-12)
        self.assertLess(audit["momentum_residual"], 1e-10)
        rows = self.body_rows()
        z = [name.split()[0] for name in rows[0]].index("z")
        return [float(row[z]) for row in rows[-2:]]

    def test_a_body_almost_without_weight_takes_the_motion_of_one_with_none(self):
        reference = self.heights("1", "--fluid-ranks", 1)
        rise = min(reference) - 0.0689
        self.assertGreater(rise, 2e-3)
        self.assertLess(rise, 26e-3)  # it has not left the water
        late = 0.15  # without the predictor bodies keep the velocity of the window before
        for share, density, *settings in (
                (0.05, "0.1"), (0.05, "1", "coupling.steps_per_window=10"),
                (late, "1", "coupling.steps_per_window=2", "coupling.predictor=false")):
            options = [word for setting in settings for word in ("--set", setting)]
            with self.subTest(density=density, settings=settings):
                for height, expected in zip(self.heights(density, "--fluid-ranks", 1, *options), reference):
                    self.assertAlmostEqual(height, expected, delta=share * rise)

    def test_ranks_that_share_a_body_agree(self):
        alone = self.heights("1", "--fluid-ranks", 1)
        for height, expected in zip(self.heights("1", "--fluid-ranks", 2), alone):
            self.assertAlmostEqual(height, expected, delta=1e-9)

    def test_the_parallel_scheme_warns(self):
        self.edit("in.blocks", "density 870 ", "density 300 ")
        outcome = self.run_scene("--end-time", "1 ms", "--set", "coupling.scheme=parallel", "--set",
                                 "coupling.steps_per_window=5")
        self.assertEqual(outcome.status, 0, outcome)
        self.assertIn("so light", outcome.stdout + outcome.stderr)


if __name__ == "__main__":
    support.main()
