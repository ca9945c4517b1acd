"""Scenes that cannot be run are refused at once, with the place of the mistake and exit status 2."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import support  # noqa: E402


class SceneMistakes(support.SceneTest):
    def test_unknown_key(self):
        self.edit("scene.toml", "particle_distance", "particle_distnace")
        self.assert_refused(self.run_scene(), 2, r"scene\.toml:\d+", "particle_distnace", "particle_distance")

    def test_unknown_key_in_set(self):
        self.assert_refused(self.run_scene("--set", "numerics.clf=0.3"), 2, r"numerics\.clf", "cfl")

    def test_wrong_unit(self):
        self.edit("scene.toml", 'particle_distance = "1 cm"', 'particle_distance = "1 kg"')
        self.assert_refused(self.run_scene(), 2, r"scene\.toml:\d+", "particle_distance", "kg")

    def test_missing_script(self):
        (self.scene / "in.blocks").unlink()
        self.assert_refused(self.run_scene(), 2, r"in\.blocks")

    def test_missing_scene(self):
        self.assert_refused(support.embacle("run", self.folder / "nowhere"), 2, "nowhere")

    def test_missing_scene_file(self):
        (self.scene / "scene.toml").unlink()
        self.assert_refused(self.run_scene(), 2, r"scene\.toml")

    def test_broken_toml(self):
        self.edit("scene.toml", "[numerics]", "[numerics")
        self.assert_refused(self.run_scene(), 2, r"scene\.toml:\d+")

    def test_nothing_is_written(self):
        self.edit("scene.toml", "particle_distance", "particle_distnace")
        self.run_scene()
        self.assertEqual(list(self.out.iterdir()), [])


if __name__ == "__main__":
    support.main()
