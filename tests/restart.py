"""Checkpoints and restarts of whole runs: other numbers of ranks, kills at any moment, signals, the wall-clock limit."""

import json
import math
import os
import pathlib
import random
import shutil
import signal
import subprocess
import time

import support

TABLES = ("energies.csv", "gauges/front.csv", "gauges/left.csv", "gauges/impact.csv")
ENDLESS = ("--end-time", "1000")


def mps(*arguments, limit=120):
    """The program itself on one rank: quicker than the front door."""
    since = time.monotonic()
    return support.finish(start_mps(*arguments), since, limit)


def start_mps(*arguments):
    return subprocess.Popen([str(support.BUILD / "bin/mps"), *map(str, arguments)], env=support.environment(),
                            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))


def rows(path):
    """Numbers of a table without its header and without a last row that was cut."""
    text = path.read_text() if path.exists() else ""
    return [[float(value) for value in line.split(",")] for line in text[:text.rfind("\n") + 1].splitlines()[1:]]


def read(path):
    """Time and steps of a checkpoint, its water by id, and whether all of it is finite: read by h5py, not by mps."""
    script = ("import h5py, json, numpy as np, sys\n"
              "with h5py.File(sys.argv[1]) as f:\n"
              "    data = {name: f[name][...] for name in f}\n"
              "    order = np.argsort(data['water_identity'][:, 0])\n"
              "    print(json.dumps({'time': f.attrs['time'], 'steps': int(f.attrs['steps']),\n"
              "                      'finite': bool(np.isfinite(data['water_state']).all()),\n"
              "                      'water': data['water_state'][order].tolist()}))\n")
    done = subprocess.run(["/usr/bin/python3", "-c", script, str(path)], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def frames(folder):
    """A checksum of every dataset of every frame, through the file of all frames (HDF5 files hold their birth time)."""
    script = ("import h5py, hashlib, sys\n"
              "with h5py.File(sys.argv[1] + '/fields.h5') as f:\n"
              "    print(f['times'][...].tolist(), f['steps'][...].tolist())\n"
              "    for frame in sorted(name for name in f if name.startswith('frame_')):\n"
              "        for name in sorted(f[frame]):\n"
              "            print(frame, name, hashlib.md5(f[frame][name][...].tobytes()).hexdigest())\n")
    done = subprocess.run(["/usr/bin/python3", "-c", script, str(folder)], check=True, capture_output=True, text=True)
    names = sorted(path.name for path in (folder / "fields").iterdir())
    return done.stdout.splitlines() + names


class RestartTest(support.SceneTest):
    """The dam break without solids, coarse."""

    def setUp(self):
        super().setUp()
        shutil.rmtree(self.scene)
        shutil.copytree(support.SOURCE / "examples/dam-break", self.scene)
        self.edit("scene.toml", '"7.3 mm"', '"1.46 cm"')
        self.edit("scene.toml", 'fields_every = "0.1 s"', 'fields_every = "20 ms"\ngauges_every = "1 ms"\n'
                                                          'energies_every = "5 ms"\ncheckpoint_every = "10 ms"')
        self.edit("scene.toml", "pictures = [0, 0.2, 0.4, 0.6, 0.8, 1.0]", "")
        self.checkpoint = self.out / "checkpoint.h5"

    def summary(self, folder=None):
        return json.loads(((folder or self.out) / "summary.json").read_text())

    def restart(self, *arguments, limit=120):
        return support.embacle("run", "--restart", self.out, "--no-pictures", *arguments, limit=limit)

    def assert_same_results(self, folder, other):
        for table in TABLES:
            self.assertEqual((folder / table).read_bytes(), (other / table).read_bytes(), table)
        self.assertEqual(frames(folder), frames(other))
        self.assertEqual((folder / "fields.xdmf").read_bytes(), (other / "fields.xdmf").read_bytes())
        for key in ("steps", "simulated_seconds", "neighbour_list_builds", "decompositions", "extremes", "mass"):
            self.assertEqual(self.summary(folder)[key], self.summary(other)[key], key)


class Continuing(RestartTest):
    def test_as_if_it_had_never_stopped(self):
        """A run that is continued from 50 ms up to 80 ms leaves the files of one that ran through with the same
        checkpoints, bit for bit."""
        whole = self.folder / "whole"
        for ranks in ("1", "2"):
            with self.subTest(ranks=ranks):
                for folder in (whole, self.out):
                    shutil.rmtree(folder, ignore_errors=True)
                done = support.embacle("run", self.scene, "--out", whole, "--no-pictures", "--fluid-ranks", ranks,
                                       "--end-time", "0.08")
                self.assertEqual(done.status, 0, done)
                self.assertEqual(self.run_scene("--fluid-ranks", ranks, "--end-time", "0.053").status, 0)
                done = support.embacle("run", "--restart", self.out / "checkpoint-previous.h5", "--no-pictures",
                                       "--fluid-ranks", ranks, "--end-time", "0.08")
                self.assertEqual(done.status, 0, done)
                self.assertIn("continues from t = 0.0499", done.stdout)
                self.assert_same_results(self.out, whole)
                self.assertEqual(len(self.summary()["restarted_at"]), 1)

    def test_on_other_numbers_of_ranks(self):
        for before, after in (("2", "3"), ("3", "1")):
            with self.subTest(before=before, after=after):
                shutil.rmtree(self.out, ignore_errors=True)
                self.assertEqual(self.run_scene("--fluid-ranks", before, "--end-time", "0.03").status, 0)
                start = read(self.checkpoint)
                end = str(start["time"] + self.summary()["time_step"])
                states = []
                for ranks in (before, after):
                    folder = self.folder / f"on-{ranks}"
                    done = self.restart("--fluid-ranks", ranks, "--end-time", end, "--out", folder)
                    self.assertEqual(done.status, 0, done)
                    states.append(read(folder / "checkpoint.h5"))
                    self.assertEqual(states[-1]["steps"], start["steps"] + 1)
                    shutil.rmtree(folder)
                for column in range(8):
                    values = [[row[column] for row in state["water"]] for state in states]
                    largest = max(map(abs, values[0]))
                    self.assertLessEqual(max(abs(a - b) for a, b in zip(*values)), 1e-12 * largest, column)

    def test_a_new_folder_holds_what_follows(self):
        self.assertEqual(self.run_scene("--end-time", "0.03").status, 0)
        kept = {path: path.read_bytes() for path in self.out.rglob("*") if path.is_file()}
        other = self.folder / "other"
        self.assertEqual(self.restart("--end-time", "0.06", "--out", other).status, 0)
        self.assertEqual(kept, {path: path.read_bytes() for path in self.out.rglob("*") if path.is_file()})
        self.assertGreater(rows(other / "gauges/front.csv")[0][0], 0.03)
        self.assertAlmostEqual(rows(other / "gauges/front.csv")[-1][0], 0.06, delta=1e-3)
        self.assertTrue((other / "shapes.json").exists())

    def test_nothing_left_to_do(self):
        self.assertEqual(self.run_scene("--end-time", "0.02").status, 0)
        done = self.restart()
        self.assertEqual(done.status, 0, done)
        self.assertIn("at its end already", done.stdout)


class KilledTest(RestartTest):
    """Kills of which half come at any moment of a program's life, half amid the frequent checkpoints."""

    OPTIONS = ("--set", "run.end_time=0.2 s", "--set", "numerics.particle_distance=1 cm",
               "--set", "output.checkpoint_every=1 ms")
    LOST = 1e-3 + 1e-3 + 2e-4  # [s] between two checkpoints, two rows of the gauges, and a step

    def setUp(self):
        super().setUp()
        self.seed = int.from_bytes(os.urandom(4), "little")
        self.chance = random.Random(self.seed)
        self.whole = self.folder / "whole"
        self.reached = []

    def identity_of_checkpoint(self):
        return self.checkpoint.stat().st_ino if self.checkpoint.exists() else None

    def wait_for_the_moment(self, process, late):
        before = self.identity_of_checkpoint()
        if late:
            self.wait_for(lambda: self.identity_of_checkpoint() != before or process.poll() is not None, process)
        time.sleep(self.chance.uniform(0, 0.1 if late else 0.5))

    def judge_what_is_left(self):
        """Whether there is a checkpoint; it must be whole, and not older than it may be."""
        last = max((row[0] for row in rows(self.out / "gauges/front.csv")), default=0)
        if not self.checkpoint.exists():
            self.assertLess(last, self.LOST, f"seed {self.seed}: no checkpoint after {last} s")
            return False
        state = read(self.checkpoint)
        self.assertTrue(state["finite"])
        self.assertGreater(state["time"], last - self.LOST, f"seed {self.seed}: more lost than since the last one")
        self.reached.append(state["time"])
        return True


class Killed(KilledTest):
    def test_killed_at_20_random_moments(self):
        """Each restart begins from what the kill left, and the results are those of a run left in peace."""
        done = mps(self.scene, *self.OPTIONS, "--out", self.whole)
        self.assertEqual(done.status, 0, done)
        there = False
        for kill in range(20):
            begin = ("--restart", self.out) if there else (self.scene, *self.OPTIONS, "--out", self.out)
            process = start_mps(*begin)
            self.wait_for_the_moment(process, late=kill % 2 == 1)
            if process.poll() is None:
                process.kill()
            outcome = support.finish(process, time.monotonic(), 10)
            self.assertIn(outcome.status, (0, -signal.SIGKILL), f"seed {self.seed}: {outcome}")
            there = self.judge_what_is_left()
        done = mps("--restart", self.out)
        self.assertEqual(done.status, 0, f"seed {self.seed}: {done}")
        self.assert_same_results(self.out, self.whole)
        print(f"checkpoints left at {[round(t, 3) for t in self.reached]} s, seed {self.seed}; ", end="")


class KilledRank(KilledTest):
    def test_a_rank_of_two_killed(self):
        begin = ("run", self.scene, *self.OPTIONS)
        for which in (0, 1, 0):
            process = support.start(*begin, "--out", self.out, "--no-pictures", "--fluid-ranks", "2")
            self.wait_for_the_moment(process, late=True)
            os.kill(self.ranks("mps")[which], signal.SIGKILL)
            outcome = support.finish(process, time.monotonic(), support.END_LIMIT)
            self.assertEqual(outcome.status, 4, f"seed {self.seed}: {outcome}")
            self.assertTrue(self.judge_what_is_left())
            begin = ("run", "--restart", self.out)
        self.assertEqual(sorted(set(self.reached)), self.reached)


class EndedEarly(RestartTest):
    """What the ways to end a run before its time have in common."""

    def assert_can_go_on(self, ended_by):
        summary = self.summary()
        self.assertEqual(summary["ended_by"], ended_by)
        state = read(self.checkpoint)
        self.assertEqual(state["steps"], summary["steps"])
        done = mps("--restart", self.out, "--end-time", str(math.floor(state["time"] * 1000 + 2) / 1000))
        self.assertEqual(done.status, 0, done)
        self.assertEqual(self.summary()["ended_by"], "end time")
        self.assertGreater(self.summary()["steps"], summary["steps"])


class WallClock(EndedEarly):
    def test_wall_limit(self):
        outcome = self.run_scene("--wall-limit", "1 s", *ENDLESS)
        self.assertEqual(outcome.status, 5, outcome)
        self.assertIn(f"continue with --restart {self.out}", outcome.stdout)
        self.assert_can_go_on("wall limit")

    def test_wall_limit_is_a_time(self):
        self.assert_refused(self.run_scene("--wall-limit", "soon"), 2, "--wall-limit", "30min", "'soon'")
        for value in ("3 m", "0", "-1 s", "$a"):
            self.assert_refused(mps(self.scene, "--check", "--wall-limit=" + value), 2, "--wall-limit", "30min")

    def test_checkpoints_by_the_clock(self):
        outcome = mps(self.scene, "--out", self.out, "--set", "output.checkpoint_every=0", "--set",
                      "output.checkpoint_wall=0.2 s", "--wall-limit", "1.5", *ENDLESS)
        self.assertEqual(outcome.status, 5, outcome)
        self.assertTrue((self.out / "checkpoint-previous.h5").exists())


class Cluster(EndedEarly):
    """tools/slurm/embacle.sbatch, with a scheduler that only writes down what it is told."""

    def submit(self, *options, **environment):
        commands = self.folder / "commands"
        commands.mkdir(exist_ok=True)
        (commands / "sbatch").write_text(f"#!/bin/sh\necho part $EMBACLE_PART: $@ >> {self.folder}/submitted\n")
        (commands / "sbatch").chmod(0o755)
        given = dict(support.environment(), PATH=f"{commands}:{os.environ['PATH']}", EMBACLE_ROOT=str(support.SOURCE),
                     EMBACLE_MPIRUN="mpirun -q --oversubscribe --bind-to none --mca btl_vader_single_copy_mechanism none -n 2", **environment)
        script = support.SOURCE / "tools/slurm/embacle.sbatch"
        return subprocess.run([script, self.scene, self.out, *options], env=given, capture_output=True, text=True)

    def test_a_job_submits_its_continuation(self):
        now = int(time.time())
        done = self.submit(*ENDLESS, SLURM_JOB_END_TIME=str(now + 30), SLURM_JOB_START_TIME=str(now - 90),
                           SLURM_JOB_NUM_NODES="2", SLURM_NTASKS_PER_NODE="4", EMBACLE_SPARE_SECONDS="27")
        self.assertEqual(done.returncode, 5, done)
        self.assertEqual((self.folder / "submitted").read_text().split(), [
            "part", "2:", "--export=ALL", "--nodes=2", "--ntasks-per-node=4", "--time=2",
            str(support.SOURCE / "tools/slurm/embacle.sbatch"), str(self.scene), str(self.out), *ENDLESS])
        time_reached = read(self.checkpoint)["time"]
        done = self.submit("--end-time", str(math.floor(time_reached * 1000 + 2) / 1000), EMBACLE_PART="2")
        self.assertEqual(done.returncode, 0, done)
        self.assertEqual(self.summary()["ended_by"], "end time")
        self.assertEqual(len((self.folder / "submitted").read_text().splitlines()), 1)

    def test_a_job_too_short_says_so(self):
        done = self.submit(SLURM_JOB_END_TIME=str(int(time.time()) + 100))
        self.assertEqual(done.returncode, 2)
        self.assertIn("leaves less than 600 s", done.stderr)


class Signals(EndedEarly):
    def run_until_checkpoint(self, *arguments):
        shutil.rmtree(self.out, ignore_errors=True)
        process = self.start_scene(*arguments, *ENDLESS)
        self.wait_for(self.checkpoint.exists, process)
        return process

    def test_signals_to_the_front_door(self):
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGUSR1, 5)):
            with self.subTest(signal=number.name):
                process = self.run_until_checkpoint("--fluid-ranks", "2")
                since = time.monotonic()
                process.send_signal(number)
                outcome = support.finish(process, since, support.END_LIMIT)
                self.assertEqual(outcome.status, status, outcome)
                self.assertEqual(self.ranks("mps"), [])
                self.assert_can_go_on("SIGUSR1")

    def test_signals_to_any_rank(self):
        for which, number, status in ((0, signal.SIGTERM, 143), (1, signal.SIGUSR1, 5)):
            with self.subTest(rank=which, signal=number.name):
                process = self.run_until_checkpoint("--fluid-ranks", "2")
                since = time.monotonic()
                os.kill(self.ranks("mps")[which], number)
                outcome = support.finish(process, since, support.END_LIMIT)
                self.assertEqual(outcome.status, status, outcome)
                self.assert_can_go_on(number.name)

    def test_sigint_to_the_program(self):
        process = start_mps(self.scene, "--out", self.out, *ENDLESS)
        self.wait_for(self.checkpoint.exists, process)
        process.send_signal(signal.SIGINT)
        self.assertEqual(support.finish(process, time.monotonic(), support.END_LIMIT).status, 130)
        self.assert_can_go_on("SIGINT")

    def test_sigterm_to_mpirun(self):
        """mpirun gives its ranks a second: enough to end cleanly."""
        self.out.mkdir()
        process = subprocess.Popen(
            ["mpirun", "-q", "--oversubscribe", "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1", "-n", "2",
             support.BUILD / "bin/mps", self.scene, "--out", self.out, *ENDLESS],
            env=support.environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.wait_for(self.checkpoint.exists, process)
        since = time.monotonic()
        process.send_signal(signal.SIGTERM)
        support.finish(process, since, support.END_LIMIT)
        self.assert_can_go_on("SIGTERM")


class Refused(RestartTest):
    def test_another_scene(self):
        self.assertEqual(self.run_scene("--end-time", "0.02").status, 0)
        kept = {path: path.read_bytes() for path in self.out.rglob("*") if path.is_file()}
        self.edit("scene.toml", '"1.46 cm"', '"1 cm"')
        self.assert_refused(self.restart(), 2, r"scene\.toml", r"numerics\.particle_distance = 0\.01 \(then: 0\.0146\)",
                            "checkpoint.h5")
        self.assert_refused(mps(self.scene, "--restart", self.out, "--set", "wall.tank.upper=[0.6, 0.6]"), 2,
                            r"wall\.tank\.upper = \[0\.6, 0\.6, 0\]")
        self.assertEqual(kept, {path: path.read_bytes() for path in self.out.rglob("*") if path.is_file()})

    def test_no_checkpoint(self):
        self.assert_refused(self.restart(), 2, "--restart", "out")
        self.out.mkdir()
        self.assert_refused(mps("--restart", self.out), 2, "no checkpoint", "output.checkpoint_every")
        self.checkpoint.write_text("not this")
        self.assert_refused(mps("--restart", self.out), 2, r"checkpoint\.h5", "HDF5")

    def test_a_scene_with_solids(self):
        self.assertEqual(self.run_scene("--end-time", "0.02").status, 0)
        self.assert_refused(mps(support.SCENES / "small-tank" / "scene.toml", "--restart", self.out), 2,
                            r"title|numerics|coupling\.script")


if __name__ == "__main__":
    assert pathlib.Path(support.BUILD).is_dir()
    support.main()
