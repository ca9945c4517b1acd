"""Checkpoints and restarts of runs with solids: both sides at one moment, on other ranks and in the other layout."""

import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import time

import restart
import support

TABLES = ("bodies.csv", "energies.csv", "record.csv")


def shared(*arguments):
    """Starts the program of the shared layout on one rank: quicker than the front door."""
    return subprocess.Popen([str(support.BUILD / "bin/embacle-shared"), *map(str, arguments)],
                            env=support.environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


class CoupledRestart(support.SceneTest):
    """Three blocks in the small tank: one is pushed against another, the third lies on both."""

    END = "0.06"
    RECORD = "fix record all floe/record every 7 file ${out}/record.csv\n"

    def setUp(self):
        super().setUp()
        self.edit("in.blocks", "position 0.055 0.06 0.0689 position 0.145 0.06 0.0689 velocity -0.3 0 0",
                  "position 0.055 0.06 0.0689 position 0.119 0.06 0.0689 velocity -0.5 0.1 0 &\n"
                  "                position 0.09 0.06 0.1004 rotate 0 0 1 20")
        path = self.scene / "in.blocks"
        text = path.read_text().replace("model hertz tangential history", "model floe")
        path.write_text(text + self.RECORD)
        self.edit("scene.toml", 'bodies_every = "1 ms"',
                  'bodies_every = "1 ms"\nenergies_every = "1 ms"\ncheckpoint_every = "10 ms"')
        self.checkpoint = self.out / "checkpoint.h5"
        self.whole = self.folder / "whole"

    def summary(self, folder=None, name="summary.json"):
        return json.loads(((folder or self.out) / name).read_text())

    def restart(self, *arguments, what=None):
        return support.embacle("run", "--restart", what or self.out, "--no-pictures", *arguments)

    def assert_done(self, outcome):
        self.assertEqual(outcome.status, 0, outcome)
        return outcome

    def run_whole(self, *options):
        shutil.rmtree(self.whole, ignore_errors=True)
        self.assert_done(support.embacle("run", self.scene, "--out", self.whole, "--no-pictures", *options,
                                         "--end-time", self.END))

    def assert_same_results(self, tables=TABLES):
        for table in tables:
            self.assertEqual((self.out / table).read_bytes(), (self.whole / table).read_bytes(), table)
        self.assertEqual(restart.frames(self.out), restart.frames(self.whole))
        for key in ("steps", "simulated_seconds", "neighbour_list_builds", "decompositions", "extremes", "mass"):
            self.assertEqual(self.summary()[key], self.summary(self.whole)[key], key)
        solids = "solid-summary.json"
        for key in ("windows", "sub_steps", "resolved_windows", "bodies", "covering_spheres"):
            self.assertEqual(self.summary(name=solids)[key], self.summary(self.whole, solids)[key], key)

    def positions(self, folder):
        """{(time, tag): position} of all rows of bodies.csv."""
        return {(row[0], row[1]): row[2:5] for row in restart.rows(folder / "bodies.csv")}


class Continuing(CoupledRestart):
    """A run that stops behind the checkpoint and continues from there leaves the files of one that ran through."""

    def compare(self, *options):
        for ranks in ("1", "2"):
            with self.subTest(ranks=ranks):
                shutil.rmtree(self.out, ignore_errors=True)
                self.run_whole("--fluid-ranks", ranks, *options)
                self.assertGreater(self.summary(self.whole, "solid-summary.json")["resolved_windows"], 50)
                self.assert_done(self.run_scene("--fluid-ranks", ranks, *options, "--end-time", "0.043"))
                layout = [option for option in options if option in ("--layout", "separate", "--solid-ranks", "2")]
                done = self.assert_done(self.restart("--fluid-ranks", ranks, *layout, "--end-time", self.END,
                                                     what=self.out / "checkpoint-previous.h5"))
                self.assertIn("continues from t = 0.0399", done.stdout)
                self.assert_same_results()
                self.assertEqual(len(self.summary()["restarted_at"]), 1)
                self.assertTrue((self.out / "log.liggghts.before").exists())

    def test_shared(self):
        self.compare()

    def test_separate(self):
        self.compare("--layout", "separate", "--solid-ranks", "2")

    def test_parallel_scheme(self):
        self.compare("--set", "coupling.scheme=parallel")

    def test_adaptive_steps_and_loads_by_pressure(self):
        self.compare("--set", "coupling.loads=pressure", "--set", "numerics.adaptive_step=true")

    def test_light_bodies(self):
        self.edit("in.blocks", "density 870 ", "density 5 ")
        self.compare()

    def test_contacts_of_spheres_and_their_water_pressure(self):
        path = self.scene / "in.blocks"
        path.write_text(path.read_text().replace("model floe", "model hertz tangential history")
                        .replace("couple/mps", "couple/mps pressures every 7"))
        self.compare()


class MovingMesh(CoupledRestart):
    """A lid of triangles that comes down on the blocks, and a disc on edge that touches it."""

    def test_as_if_it_had_never_stopped(self):
        facets = ""
        for corners in (((0, 0), (0.2, 0), (0.2, 0.12)), ((0, 0), (0.2, 0.12), (0, 0.12))):
            facets += "facet normal 0 0 1\nouter loop\n"
            facets += "".join(f"vertex {x} {y} 0.125\n" for x, y in corners) + "endloop\nendfacet\n"
        (self.scene / "lid.stl").write_text("solid lid\n" + facets + "endsolid lid\n")
        self.edit("in.blocks", "fix             rigid all multisphere",
                  "fix lid all mesh/surface file lid.stl type 1\n"
                  "fix lid_wall all wall/gran model floe mesh n_meshes 1 meshes lid\n"
                  "fix press all move/mesh mesh lid linear 0 0 -0.25\n"
                  "fix             rigid all multisphere")
        self.run_whole("--fluid-ranks", "2")
        self.assert_done(self.run_scene("--fluid-ranks", "2", "--end-time", "0.043"))
        self.assert_done(self.restart("--fluid-ranks", "2", "--end-time", self.END,
                                      what=self.out / "checkpoint-previous.h5"))
        self.assert_same_results()


class OtherRanks(CoupledRestart):
    """Sums run in another order there. What grows from that is the contacts' business: a pile of blocks forgets its
    start within a few dozen windows, also in runs on other ranks from the start."""

    TOLERANCE = 1e-9  # [m]
    OTHERS = (["--fluid-ranks", "1"], ["--fluid-ranks", "3"],
              ["--layout", "separate", "--fluid-ranks", "1", "--solid-ranks", "2"],
              ["--layout", "separate", "--fluid-ranks", "2", "--solid-ranks", "1"])

    def compare(self, until):
        self.assert_done(self.run_scene("--fluid-ranks", "2", "--end-time", "0.03"))
        reference = None
        for options in (["--fluid-ranks", "2"], *self.OTHERS):
            with self.subTest(options=options):
                folder = self.folder / "-".join(options).replace("--", "")
                self.assert_done(self.restart(*options, "--end-time", until, "--out", folder,
                                              "--set", "output.bodies_every=0.3 ms"))
                found = self.positions(folder)
                self.assertGreater(min(time for time, _ in found), 0.03)
                reference = reference or found
                self.assertEqual(found.keys(), reference.keys())
                worst = max(abs(a - b) for key in found for a, b in zip(found[key], reference[key]))
                print(f"{' '.join(options)}: {worst:.1e} m; ", end="")
                self.assertLessEqual(worst, self.TOLERANCE)

    def test_blocks_in_contact_three_windows_later(self):
        self.compare("0.0311")

    def test_blocks_apart_140_windows_later(self):
        shutil.copy(support.SCENES / "small-tank" / "in.blocks", self.scene / "in.blocks")
        self.compare("0.08")


class Killed(CoupledRestart):
    END = "0.1"

    def setUp(self):
        super().setUp()
        self.edit("scene.toml", 'checkpoint_every = "10 ms"', 'checkpoint_every = "2 ms"')
        self.seed = int.from_bytes(os.urandom(4), "little")
        self.chance = random.Random(self.seed)

    def test_killed_at_20_random_moments(self):
        """Half of the kills come at any moment of the program's life, half amid the frequent checkpoints."""
        options = ("--set", "run.end_time=" + self.END)
        begin = (self.scene, *options, "--out", self.whole)
        self.assert_done(support.finish(shared(*begin), time.monotonic(), 120))
        there, reached = False, []
        for kill in range(20):
            process = shared(*(("--restart", self.out) if there else (self.scene, *options, "--out", self.out)))
            if kill % 2 == 1:
                before = self.checkpoint.stat().st_ino if there else None
                self.wait_for(lambda: process.poll() is not None or
                              (self.checkpoint.exists() and self.checkpoint.stat().st_ino != before), process)
            time.sleep(self.chance.uniform(0, 0.1 if kill % 2 == 1 else 0.4))
            process.kill()
            outcome = support.finish(process, time.monotonic(), 10)
            self.assertIn(outcome.status, (0, -signal.SIGKILL), f"seed {self.seed}: {outcome}")
            there = self.checkpoint.exists()
            if there:
                state = restart.read(self.checkpoint)
                self.assertTrue(state["finite"])
                reached.append(state["time"])
        self.assertEqual(reached, sorted(reached), f"seed {self.seed}")
        self.assert_done(support.finish(shared("--restart", self.out), time.monotonic(), 120))
        self.assert_same_results()
        print(f"checkpoints left at {[round(t, 3) for t in reached]} s, seed {self.seed}; ", end="")

    def test_a_rank_of_either_side_killed(self):
        """In the separate layout, amid the checkpoints; the results are those of a run left in peace."""
        layout = ("--layout", "separate", "--fluid-ranks", "2", "--solid-ranks", "1")
        self.run_whole(*layout)
        begin = ("run", self.scene, "--out", self.out, "--end-time", self.END)
        for program in ("mps", "liggghts-mps", "mps"):
            process = support.start(*begin, *layout, "--no-pictures")
            before = self.checkpoint.stat().st_ino if self.checkpoint.exists() else None
            self.wait_for(lambda: self.checkpoint.exists() and self.checkpoint.stat().st_ino != before, process)
            time.sleep(self.chance.uniform(0, 0.1))
            os.kill(self.ranks(program)[0], signal.SIGKILL)
            outcome = support.finish(process, time.monotonic(), support.END_LIMIT)
            self.assertEqual(outcome.status, 4, f"seed {self.seed}: {outcome}")
            begin = ("run", "--restart", self.out)
        self.assert_done(self.restart(*layout))
        self.assert_same_results()


class EndedEarly(CoupledRestart):
    def assert_can_go_on(self, ended_by):
        summary = self.summary()
        self.assertEqual(summary["ended_by"], ended_by)
        state = restart.read(self.checkpoint)
        self.assertEqual(state["steps"], summary["steps"])
        self.assert_done(self.restart("--end-time", str(state["time"] + 3e-3)))
        self.assertEqual(self.summary()["ended_by"], "end time")
        self.assertGreater(self.summary()["steps"], summary["steps"])

    def test_wall_limit(self):
        outcome = self.run_scene("--wall-limit", "2 s", "--end-time", "1000")
        self.assertEqual(outcome.status, 5, outcome)
        self.assertIn(f"continue with --restart {self.out}", outcome.stdout)
        self.assert_can_go_on("wall limit")

    def test_signals_to_the_front_door(self):
        for number, status, layout in ((signal.SIGTERM, 143, ()), (signal.SIGUSR1, 5, ("--layout", "separate"))):
            with self.subTest(signal=number):
                shutil.rmtree(self.out, ignore_errors=True)
                process = self.start_scene(*layout, "--fluid-ranks", "2", "--end-time", "1000")
                self.wait_for(self.checkpoint.exists, process)
                process.send_signal(number)
                outcome = support.finish(process, time.monotonic(), support.END_LIMIT)
                self.assertEqual(outcome.status, status, outcome)
                self.assert_can_go_on("SIGUSR1")

    def test_checkpoints_by_the_wall_clock(self):
        process = self.start_scene("--end-time", "1000", "--set", "output.checkpoint_every=0", "--set",
                                   "output.checkpoint_wall=0.3 s")
        previous = self.out / "checkpoint-previous.h5"
        self.wait_for(previous.exists, process)
        process.send_signal(signal.SIGTERM)
        support.finish(process, time.monotonic(), support.END_LIMIT)
        self.assertGreater(restart.read(self.checkpoint)["time"], restart.read(previous)["time"])


class Refused(CoupledRestart):
    def assert_refused_after(self, old, new, *words, name="in.blocks"):
        """A restart with a changed script is refused and leaves the checkpoint alone."""
        if not self.checkpoint.exists():
            self.assert_done(self.run_scene("--end-time", "0.012"))
        kept = self.checkpoint.read_bytes()
        original = (self.scene / name).read_text()
        self.edit(name, old, new)
        self.assert_refused(self.restart(), 2, *words)
        (self.scene / name).write_text(original)
        self.assertEqual(self.checkpoint.read_bytes(), kept)

    def test_scripts_that_cannot_continue(self):
        create = "create_box      1 box"
        self.assert_refused_after("fix             water all", "run 3\nfix water all", "cannot continue", "restarted")
        self.assert_refused_after(self.RECORD, self.RECORD + "run 3\n", "to step", "restarted")
        self.assert_refused_after(self.RECORD, "fix more all floe/create shape box 0.02 0.02 0.02 density 900 spheres 8 "
                                  "position 0.1 0.06 0.2\n", "8 particles", "restarted")
        self.assert_refused_after("box 0.06 0.06 0.03", "box 0.06 0.06 0.02", "other shapes", "floe/create")
        self.assert_refused_after("fix             water all", "fix other all", "cannot continue", "create_box")
        self.assert_refused_after(create, "read_data nothing", "read_data|nothing")
        guarded = 'if "${restarted} == 0" then "run 3"'
        self.edit("in.blocks", "fix             water all", guarded + "\nfix             water all")
        self.assert_done(self.restart("--end-time", "0.015"))

    def test_scenes_that_differ(self):
        self.assert_refused_after("[coupling]", "[coupling]\nsteps_per_window = 2",
                                  r"coupling\.steps_per_window = 2 \(then: 1\)", name="scene.toml")
        water = self.folder / "water"
        water.mkdir()
        text = (self.scene / "scene.toml").read_text().replace('[coupling]\nscript = "in.blocks"\n', "")
        (water / "scene.toml").write_text(text)
        self.assert_refused(support.embacle("run", water, "--restart", self.out), 2,
                            r"coupling\.script: not there \(then: in\.blocks\)")


if __name__ == "__main__":
    assert pathlib.Path(support.BUILD).is_dir()
    support.main()
