"""Floes that enter a reach at their times and leave it at its end."""

import csv
import json
import shutil

import support


class FloeTraffic(support.SceneTest):
    SCENE = "small-reach"
    CYCLE, PERIOD = (0.05, 0.08, 0.1), 0.5  # times [s] of floes.csv, and after which they come again

    def done(self, *options, out=None):
        self.out = self.folder / (out or "out")
        outcome = self.run_scene(*options)
        self.assertEqual(outcome.status, 0, outcome)
        self.assertNotIn("has left the solids", outcome.stderr)
        return outcome

    def table(self, name):
        with (self.out / name).open() as stream:
            rows = list(csv.reader(stream))
        return [dict(zip((column.split()[0] for column in rows[0]), map(float, row))) for row in rows[1:]]

    def tracks(self):
        """{tag: [(time, x), ...]}"""
        result = {}
        for row in self.table("bodies.csv"):
            result.setdefault(int(row["tag"]), []).append((row["t"], row["x"]))
        return result

    def test_the_books_are_right_and_no_tag_comes_twice(self):
        self.done("--fluid-ranks", 1)
        with (self.out / "floes.csv").open() as stream:
            rows = [[float(cell) for cell in row] for row in list(csv.reader(stream))[1:]]
        for _, start, entered, present, left, waiting in rows:
            self.assertEqual(start + entered, present + left)
            due = [t + k * self.PERIOD for k in range(9) for t in self.CYCLE]
            self.assertLessEqual(entered + waiting, len(due))
        last = rows[-1]
        self.assertEqual(last[2], 9, "three cycles")
        self.assertGreaterEqual(last[4], 4)
        tracks = self.tracks()
        self.assertEqual(sorted(tracks), list(range(1, 10)))
        for track in tracks.values():
            places = [x for _, x in track]
            self.assertAlmostEqual(places[0], 0.1, delta=0.02)  # first seen up to 20 ms after it entered
            self.assertEqual(places, sorted(places), "it drifts along")
            self.assertLess(places[-1], 0.43)
            speed = (places[-1] - places[0]) / (track[-1][0] - track[0][0])
            self.assertAlmostEqual(speed, 0.4, delta=0.08)
        starts = {tag: track[0][0] for tag, track in tracks.items()}
        self.assertAlmostEqual(starts[1], 0.05, delta=0.06)  # at the next plan
        self.assertGreater(starts[3], starts[1] + 0.1, "it waits until the place is free")
        summary = json.loads((self.out / "summary.json").read_text())
        self.assertGreater(summary["displaced_by_arrivals"], 0)

    def test_contacts_of_spheres_keep_their_histories(self):
        path = self.scene / "in.floes"
        path.write_text(path.read_text().replace("model floe", "model hertz tangential history")
                        .replace("repeat 0.5", "repeat 0.2").replace("xplane 0.4", "xplane 0.3"))
        self.edit("floes.csv", "0.1, 0.1, 0.11, 0.072, 0.4", "0.1, 0.1, 0.106, 0.072, 0.4")  # nearly touches the others
        self.done("--fluid-ranks", 2)
        tracks = self.tracks()
        self.assertGreater(len(tracks), 8)
        for track in tracks.values():
            for (time, x), (later, next_x) in zip(track, track[1:]):
                self.assertLess(abs(next_x - x), 1.2 * (later - time), "nothing is thrown about")

    def test_ranks_and_layouts_agree(self):
        self.done("--fluid-ranks", 1)
        expected = self.tracks()
        for number, options in enumerate((("--fluid-ranks", 3),
                                          ("--layout", "separate", "--fluid-ranks", 2, "--solid-ranks", 2))):
            with self.subTest(options=options):
                self.done(*options, out=f"other-{number}")
                tracks = self.tracks()
                self.assertEqual(sorted(tracks), sorted(expected))
                for tag, track in tracks.items():
                    self.assertEqual(len(track), len(expected[tag]))
                    for (time, x), (other_time, other_x) in zip(track, expected[tag]):
                        self.assertEqual(time, other_time)
                        # The third floe falls between the others at 0.21 s; what rounding did then grows.
                        self.assertAlmostEqual(x, other_x, delta=1e-12 if time < 0.21 else 2e-3)

    def test_a_run_goes_on_from_a_checkpoint_as_if_it_had_not_stopped(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                self.done("--fluid-ranks", ranks, out=f"whole-{ranks}")
                whole = self.out
                self.done("--fluid-ranks", ranks, "--end-time", 0.9, out=f"part-{ranks}")
                outcome = support.embacle("run", "--restart", self.out / "checkpoint-previous.h5", "--no-pictures",
                                          "--fluid-ranks", ranks, "--end-time", 1.4)
                self.assertEqual(outcome.status, 0, outcome)
                for name in ("floes.csv", "bodies.csv", "openings/outlet.csv"):
                    self.assertEqual((self.out / name).read_bytes(), (whole / name).read_bytes(), name)
                shutil.rmtree(whole)

    def test_mistakes_are_named(self):
        for old, new, message in (
                ("outline [m]", "outlin [m]", r"floes\.csv:2: unknown column 'outlin'"),
                ("0.01 0.03 -0.02 0.02, 0.02", "0.01 0.03 -0.02, 0.02", r"floes\.csv:4: the outline has 7 numbers"),
                ("0.1, 0.11, 0.072", "0.1, 0.16, 0.072", r"floes\.csv:4 reaches from y")):
            with self.subTest(new=new):
                self.edit("floes.csv", old, new)
                self.assert_refused(self.run_scene("--fluid-ranks", 1), 2, message)
                self.edit("floes.csv", new, old)
        self.edit("in.floes", "xplane 0.4 above", "xplane 0.4 up")
        self.assert_refused(self.run_scene("--fluid-ranks", 1), 2, "side 'up'", "above, below")


if __name__ == "__main__":
    support.main()
