"""What the end-to-end tests share: copies of the small scene, runs of the front door, and checks of what is left."""

import csv
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE = pathlib.Path(__file__).resolve().parent.parent
FRONT_DOOR = SOURCE / "embacle"
SCENES = SOURCE / "tests/scenes"
BUILD = pathlib.Path(os.environ.get("EMBACLE_BUILD", SOURCE / "build"))
END_LIMIT = 10  # [s] in which all ranks must have ended after a failure
# What a library prints when a program dies instead of explaining itself.
NOISE = ("MPI_ABORT", "Primary job", "mpirun noticed", "Traceback", "terminate called", "Aborted", "HDF5-DIAG",
         "ORTE has", "core dumped")


class Outcome:
    def __init__(self, status, stdout, stderr, seconds):
        self.status, self.stdout, self.stderr, self.seconds = status, stdout, stderr, seconds

    def __str__(self):
        return f"status {self.status} after {self.seconds:.1f} s\n--- stdout\n{self.stdout}\n--- stderr\n{self.stderr}"


def environment():
    return dict(os.environ, EMBACLE_BUILD=str(BUILD), OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")


def start(*arguments):
    """Starts `./embacle ARGUMENTS`, which hears SIGINT even where the tests themselves run in the background."""
    return subprocess.Popen([str(FRONT_DOOR), *map(str, arguments)], env=environment(), stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))


def patience(seconds):
    """What a machine as busy as this one may take for what an idle one does in `seconds`."""
    return seconds * max(1, os.getloadavg()[0] / os.cpu_count())


def finish(process, since, limit):
    """Waits for the end of a front door; one that exceeds the limit is ended and fails the test."""
    limit = patience(limit)
    try:
        stdout, stderr = process.communicate(timeout=limit)
    except subprocess.TimeoutExpired:
        process.terminate()
        stdout, stderr = process.communicate(timeout=30)
        raise AssertionError(f"not ended after {limit:.0f} s\n--- stdout\n{stdout}\n--- stderr\n{stderr}") from None
    return Outcome(process.returncode, stdout, stderr, time.monotonic() - since)


def embacle(*arguments, limit=120):
    since = time.monotonic()
    return finish(start(*arguments), since, limit)


class SceneTest(unittest.TestCase):
    """A test on its own copy of a small scene in `self.scene`, with results in `self.out`."""

    SCENE = "small-tank"

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="embacle-test-"))
        self.addCleanup(shutil.rmtree, self.folder, True)
        self.scene = self.folder / "scene"
        self.out = self.folder / "out"
        shutil.copytree(SCENES / self.SCENE, self.scene)

    def edit(self, name, old, new):
        """Replaces text in a file of the scene; the text must be there."""
        path = self.scene / name
        text = path.read_text()
        self.assertIn(old, text, f"{name} has changed: adapt the test")
        path.write_text(text.replace(old, new, 1))

    def run_scene(self, *arguments, limit=120):
        return embacle("run", self.scene, "--out", self.out, "--no-pictures", *arguments, limit=limit)

    def start_scene(self, *arguments):
        return start("run", self.scene, "--out", self.out, "--no-pictures", *arguments)

    def assert_refused(self, outcome, status, *expected, within=END_LIMIT):
        """The run ended in time with the status and one clear message that holds the expected words."""
        self.assertEqual(outcome.status, status, outcome)
        self.assertLess(outcome.seconds, patience(within), outcome)
        for word in expected:
            self.assertRegex(outcome.stderr, re.compile(word), outcome)
        for word in NOISE:
            self.assertNotIn(word, outcome.stderr, outcome)
        messages = [line for line in outcome.stderr.splitlines() if re.match(r"[a-z-]+: ", line)]
        self.assertEqual(len(messages), 1, f"one message is wanted, not {len(messages)}\n{outcome}")

    def ranks(self, program):
        """Process ids of the ranks of a program that belong to this test's run."""
        found = []
        for entry in pathlib.Path("/proc").iterdir():
            if not entry.name.isdigit():
                continue
            try:
                words = (entry / "cmdline").read_bytes().split(b"\0")
                executable = os.path.basename(os.readlink(entry / "exe"))
            except OSError:
                continue
            if executable == program and str(self.out).encode() in words:
                found.append(int(entry.name))
        return sorted(found)

    def wait_for(self, condition, process, limit=60):
        """Until the condition holds; fails if the run ends before."""
        deadline = time.monotonic() + limit
        while not condition():
            if process.poll() is not None:
                raise AssertionError(f"ended too early: {finish(process, time.monotonic(), 10)}")
            if time.monotonic() > deadline:
                process.terminate()
                raise AssertionError(f"nothing happened in {limit} s: {finish(process, time.monotonic(), 30)}")
            time.sleep(0.02)

    def body_rows(self):
        path = self.out / "bodies.csv"
        if not path.exists():
            return []
        with path.open() as stream:
            return list(csv.reader(stream))

    def frames(self):
        return sorted((self.out / "fields").glob("*.h5"))

    def assert_output_readable(self):
        """Every row of bodies.csv but the last is whole, and every frame of the fields opens with its data."""
        rows = self.body_rows()
        self.assertGreater(len(rows), 2)
        for row in rows[:-1]:
            self.assertEqual(len(row), len(rows[0]))
        for row in rows[1:-1]:
            [float(value) for value in row]
        frames = [frame for frame in self.frames() if re.fullmatch(r"\d+\.h5", frame.name)]
        self.assertGreater(len(frames), 0)
        script = ("import sys, h5py\n"
                  "for name in sys.argv[1:]:\n"
                  "    with h5py.File(name) as f:\n"
                  "        sizes = []\n"
                  "        f.visititems(lambda n, o: sizes.append(len(o[...])) if hasattr(o, 'shape') and o.shape else None)\n"
                  "        assert sizes and max(sizes) > 0, name\n")
        subprocess.run(["/usr/bin/python3", "-c", script, *map(str, frames)], check=True)


def kill(process_id):
    os.kill(process_id, signal.SIGKILL)


def main():
    unittest.main(argv=[sys.argv[0], "-v", *sys.argv[1:]])
