"""Mistakes on the LIGGGHTS side and disagreements of the two sides end all ranks at once, in both layouts."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import support  # noqa: E402

LAYOUTS = (("--layout", "separate", "--fluid-ranks", "2", "--solid-ranks", "1"),
           ("--layout", "separate", "--fluid-ranks", "1", "--solid-ranks", "2"),
           ("--layout", "shared", "--fluid-ranks", "2"))


class SolidMistakes(support.SceneTest):
    def assert_refused_everywhere(self, status, *expected):
        for layout in LAYOUTS:
            with self.subTest(layout=" ".join(layout)):
                self.assert_refused(self.run_scene(*layout), status, *expected)

    def test_script_error(self):
        self.edit("in.blocks", "pair_style", "pair_stile")
        self.assert_refused_everywhere(2, "pair_stile")

    def test_script_error_after_the_handshake(self):
        path = self.scene / "in.blocks"
        path.write_text(path.read_text() + "\nno_such_command\n")
        self.assert_refused_everywhere(2, "no_such_command")

    def test_gravity_differs(self):
        self.edit("in.blocks", "gravity 9.81", "gravity 1.62")
        self.assert_refused_everywhere(2, "gravity", r"9\.81", r"1\.62")

    def test_no_coupling_in_the_script(self):
        path = self.scene / "in.blocks"
        lines = [line for line in path.read_text().splitlines() if "couple/mps" not in line]
        path.write_text("\n".join(lines) + "\n")
        self.assert_refused_everywhere(2, "couple/mps")

    def test_overlapping_bodies(self):
        self.edit("in.blocks", "position 0.145", "position 0.10")
        self.assert_refused_everywhere(2, "overlap")

    def test_body_outside_of_the_solid_box(self):
        self.edit("in.blocks", "position 0.145 0.06 0.0689", "position 0.145 0.06 5")
        self.assert_refused_everywhere(2, "body 2", r"5\.015 m", "simulation box")

    def test_body_outside_of_the_domain_of_the_water(self):
        self.edit("in.blocks", "block -0.01 0.21 -0.01 0.13 -0.01 0.29", "block -0.01 1 -0.01 1 -0.01 1")
        self.edit("in.blocks", "position 0.145 0.06 0.0689", "position 0.145 0.06 0.8")
        self.assert_refused_everywhere(2, "outside|out of", "domain")

    def test_body_that_leaves_is_named_once(self):
        self.edit("in.blocks", "velocity -0.3 0 0", "velocity -0.3 0 3.5")
        for layout in LAYOUTS:
            with self.subTest(layout=" ".join(layout)):
                outcome = self.run_scene(*layout, "--end-time", "0.18")
                self.assertEqual(outcome.status, 0, outcome)
                self.assertEqual(outcome.stderr.count("has left the solids"), 1, outcome)
                self.assertRegex(outcome.stderr, r"warning: by t = 0\.\d+ s body 2, last planned at \(")


if __name__ == "__main__":
    support.main()
