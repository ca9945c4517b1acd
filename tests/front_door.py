"""The front door: arguments, statuses, result folders, and a run of water alone."""

import json
import os
import subprocess

import support


class Arguments(support.SceneTest):
    def refused(self, *arguments, expect):
        self.assert_refused(support.embacle(*arguments), 2, expect)

    def test_help(self):
        for word in ("help", "--help"):
            outcome = support.embacle(word)
            self.assertEqual(outcome.status, 0)
            for command in ("setup", "run", "test", "validate", "clean"):
                self.assertIn(f"./embacle {command}", outcome.stdout)

    def test_unknown_command(self):
        self.refused("rum", expect="'rum'")

    def test_unknown_options(self):
        self.refused("run", self.scene, "--ranks", "2", expect="'--ranks'")
        self.refused("setup", "--paravue", expect="'--paravue'")

    def test_wrong_values(self):
        self.refused("run", self.scene, "--fluid-ranks", "0", expect="'0'")
        self.refused("run", self.scene, "--fluid-ranks", expect="--fluid-ranks needs a value")
        self.refused("run", self.scene, "--layout", "mixed", expect="'mixed'")
        self.refused("run", self.scene, "--set", "numerics.cfl", expect="'numerics.cfl'")
        self.refused("run", self.scene, self.scene, expect="one scene")
        self.refused("run", self.scene, "--layout", "shared", "--solid-ranks", "2", expect="--fluid-ranks alone")

    def test_a_missing_build_is_named(self):
        environment = dict(os.environ, EMBACLE_BUILD=str(self.folder))
        done = subprocess.run([support.FRONT_DOOR, "run", self.scene], env=environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("EMBACLE_BUILD", done.stderr)


class WaterAlone(support.SceneTest):
    """The dam break without solids, coarse and short."""

    OPTIONS = ("--set", "numerics.particle_distance=1.46cm", "--end-time", "0.05")

    def setUp(self):
        super().setUp()
        self.scene = support.SOURCE / "examples/dam-break"

    def test_run(self):
        outcome = self.run_scene(*self.OPTIONS)
        self.assertEqual(outcome.status, 0, outcome)
        self.assertIn(str(self.out), outcome.stdout)
        for name in ("summary.json", "fields.xdmf", "fields.h5", "gauges/front.csv", "command.txt"):
            self.assertTrue((self.out / name).exists(), name)
        summary = json.loads((self.out / "summary.json").read_text())
        self.assertIsInstance(summary, dict)
        front = (self.out / "gauges/front.csv").read_text().splitlines()
        time, position = (float(value) for value in front[-1].split(",")[:2])
        self.assertAlmostEqual(time, 0.05, delta=0.002)
        self.assertTrue(0.146 < position < 0.25, position)  # between rest and free fall of the foot

    def test_a_scene_file_is_as_good_as_its_folder(self):
        self.scene = self.scene / "scene.toml"
        self.assertEqual(self.run_scene(*self.OPTIONS, "--fluid-ranks", "1").status, 0)

    def test_no_solids_no_solid_ranks(self):
        self.assert_refused(self.run_scene("--solid-ranks", "2"), 2, "no solids")

    def test_end_time_is_the_scene_s(self):
        self.assertEqual(self.run_scene(*self.OPTIONS).status, 0)
        rows = (self.out / "gauges/left.csv").read_text().splitlines()
        self.assertLessEqual(float(rows[-1].split(",")[0]), 0.05 + 1e-3)

    def test_a_folder_that_cannot_be_made(self):
        blocker = self.folder / "file"
        blocker.write_text("")
        self.out = blocker / "out"
        outcome = self.run_scene(*self.OPTIONS)
        self.assertEqual(outcome.status, 4, outcome)
        self.assertIn("cannot make the folder", outcome.stderr)


if __name__ == "__main__":
    support.main()
