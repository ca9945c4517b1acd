"""A rank that dies, or a user who has seen enough, ends the whole run within seconds; what was written stays readable."""

import pathlib
import shutil
import signal
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import support  # noqa: E402

SEPARATE = ("--layout", "separate", "--fluid-ranks", "2", "--solid-ranks", "2", "--end-time", "1000")
SHARED = ("--layout", "shared", "--fluid-ranks", "2", "--end-time", "1000")


class DyingRanks(support.SceneTest):
    def run_until_frames(self, arguments):
        shutil.rmtree(self.out, ignore_errors=True)
        process = self.start_scene(*arguments)
        self.wait_for(lambda: len(self.frames()) >= 3 and len(self.body_rows()) > 20, process)
        return process

    def kill_rank(self, arguments, program, which):
        process = self.run_until_frames(arguments)
        ranks = self.ranks(program)
        self.assertEqual(len(ranks), 2)
        since = time.monotonic()
        support.kill(ranks[which])
        outcome = support.finish(process, since, support.END_LIMIT)
        self.assert_refused(outcome, 4, "killed|gone|lost")
        self.assert_all_ended()
        self.assert_output_readable()

    def assert_all_ended(self):
        for program in ("mps", "liggghts-mps", "embacle-shared"):
            self.assertEqual(self.ranks(program), [])

    def test_killed_solid_rank(self):
        for which in (0, 1):
            with self.subTest(rank=which):
                self.kill_rank(SEPARATE, "liggghts-mps", which)

    def test_killed_fluid_rank(self):
        for which in (0, 1):
            with self.subTest(rank=which):
                self.kill_rank(SEPARATE, "mps", which)

    def test_killed_shared_rank(self):
        self.kill_rank(SHARED, "embacle-shared", 1)

    def test_interrupted_by_the_user(self):
        for number, arguments in ((signal.SIGINT, SEPARATE), (signal.SIGTERM, SHARED)):
            with self.subTest(signal=number.name):
                process = self.run_until_frames(arguments)
                since = time.monotonic()
                process.send_signal(number)
                outcome = support.finish(process, since, support.END_LIMIT)
                self.assertIn(outcome.status, (0, 128 + number), outcome)
                self.assert_all_ended()
                self.assert_output_readable()


if __name__ == "__main__":
    support.main()
