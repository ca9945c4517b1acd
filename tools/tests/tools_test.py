#!/usr/bin/python3
"""Tests of the scripts in tools/, on small run folders made here."""
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

import h5py
import numpy as np

TOOLS = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(TOOLS))

import matplotlib.pyplot as plt  # noqa: E402
import paths  # noqa: E402
import pictures  # noqa: E402
import run_folder  # noqa: E402
import scheme_table  # noqa: E402 (makes validation/ known)
import validate  # noqa: E402
import validation_plots  # noqa: E402

STARTS = [(0.04, 0.04), (0.11, 0.04), (0.04, 0.11), (0.11, 0.11)]  # x, y of tags 1 to 4: B1, B2, A1, A2
HEADER = ("t [s],tag [-],x [m],y [m],z [m],qw [-],qx [-],qy [-],qz [-],vx [m/s],vy [m/s],vz [m/s],wx [rad/s],wy [rad/s],"
          "wz [rad/s],fx [N],fy [N],fz [N],tx [N m],ty [N m],tz [N m]\n")


def make_run(folder, dimension=3, shape=None):
    """Water at rest in a tank, a gate that rises at 0.4 m/s, and four blocks that move by 0.1 m in the first second and
    back by 0.05 m in the next half."""
    up = 2 if dimension == 3 else 1
    gravity = [0.0, 0.0, 0.0]
    gravity[up] = -9.81
    upper = [0.6, 0.15, 0.3] if dimension == 3 else [0.6, 0.3, 0.0]
    gate = {"name": "gate", "kind": "box", "lower": [0.15, 0, 0], "upper": [0.16, *upper[1:]], "velocity": [0, 0, 0],
            "start": 0, "stop": 1e30}
    gate["velocity"][up] = 0.4
    stage = {"gravity": gravity, "dimension": dimension, "particle_distance": 0.01, "pictures": [0, 0.5],
             "domain": {"lower": [-0.02] * 3, "upper": [0.7] * 3},
             "walls": [{"name": "tank", "kind": "tank", "lower": [0, 0, 0], "upper": upper, "velocity": [0, 0, 0],
                        "start": 0, "stop": 1e30}, gate],
             "shapes": [shape or {"kind": "box", "size": [0.06, 0.06, 0.02]}],
             "bodies": [{"tag": tag, "shape": 0} for tag in range(1, 5)],
             "parameters": {"blocks": 4, "depth": 0.01}}
    (folder / "shapes.json").write_text(json.dumps(stage))

    with open(folder / "bodies.csv", "w", encoding="utf-8") as file:
        file.write(HEADER)
        for t in np.arange(0, 1.501, 0.01):
            moved = 0.1 * t if t <= 1 else 0.1 - 0.1 * (t - 1)
            for tag, (x, y) in enumerate(STARTS, start=1):
                place = [x + moved, y, 0.1] if dimension == 3 else [x + moved, 0.1 + 0.5 * y, 0]
                file.write(",".join(f"{v:.9g}" for v in [t, tag, *place, 1, 0, 0, 0] + 12 * [0]) + "\n")

    ranges = [np.arange(0.005, 0.15, 0.01), np.arange(0.005, upper[1] if dimension == 3 else 0.1, 0.01),
              np.arange(0.005, 0.1, 0.01) if dimension == 3 else [0.0]]
    water = np.stack(np.meshgrid(*ranges, indexing="ij"), -1).reshape(-1, 3).astype(np.float32)
    (folder / "fields").mkdir()
    times = np.array([0, 0.5, 1.0])
    with h5py.File(folder / "fields.h5", "w") as master:
        master["times"] = times
        for k in range(len(times)):
            with h5py.File(folder / f"fields/{k:06}.h5", "w") as frame:
                frame["position"] = water
                frame["velocity"] = np.full_like(water, 0.1 * k)
                frame["pressure"] = np.full(len(water), 100.0 * k, np.float32)
                frame["type"] = np.zeros(len(water), np.int8)
            master[f"frame_{k:06}"] = h5py.ExternalLink(f"fields/{k:06}.h5", "/")


def run(script, *arguments):
    return subprocess.run([sys.executable, TOOLS / script, *map(str, arguments)], capture_output=True, text=True, check=False)


class RunTest(unittest.TestCase):
    def setUp(self):
        self._temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self._temporary.cleanup)
        self.folder = pathlib.Path(self._temporary.name)


class ReadingTest(RunTest):
    def test_names_follow_the_grid_of_the_start(self):
        make_run(self.folder)
        bodies = run_folder.Bodies(str(self.folder))
        names = run_folder.body_names(run_folder.read_shapes(str(self.folder)), bodies)
        self.assertEqual(names, {1: "B1", 2: "B2", 3: "A1", 4: "A2"})

    def test_row_of_a_killed_run_is_left_out(self):
        make_run(self.folder)
        before = len(run_folder.Bodies(str(self.folder)).times(1))
        with open(self.folder / "bodies.csv", "a", encoding="utf-8") as file:
            file.write("1.51,1,0.3")
        self.assertEqual(len(run_folder.Bodies(str(self.folder)).times(1)), before)

    def test_gate_moves_between_start_and_stop(self):
        wall = {"lower": [0, 0, 0], "upper": [1, 1, 1], "velocity": [0, 0, 2], "start": 0.5, "stop": 1.0}
        for time, height in [(0.2, 0), (0.75, 0.5), (3, 1)]:
            self.assertAlmostEqual(run_folder.wall_box(wall, time)[0][2], height)

    def test_wall_turns_about_its_displaced_pivot(self):
        wall = {"lower": [1, 0, 0], "upper": [2, 1, 0], "velocity": [1, 0, 0], "start": 0.5, "stop": 1.5, "pivot": [1, 0, 0],
                "turn_axis": [0, 0, 1], "angular_velocity": np.pi / 2}
        view = pictures.View([1, 0, 0], [0, 1, 0])
        np.testing.assert_allclose(pictures.wall_turn(wall, view, 9.0).transform([3, 1]), [1, 1], atol=1e-12)
        self.assertAlmostEqual(run_folder.wall_angle(wall, 1.0), np.pi / 4)
        wall["angles"] = [{"row": [0, 0]}, {"row": [2, -1]}]
        self.assertAlmostEqual(run_folder.wall_angle(wall, 1.0), -0.5)

    def test_rotation_turns_counter_clockwise(self):
        quarter = run_folder.rotation(np.array([np.sqrt(0.5), 0, 0, np.sqrt(0.5)]))
        np.testing.assert_allclose(quarter @ [1, 0, 0], [0, 1, 0], atol=1e-12)

    def test_front_is_seen_with_gravity_down_and_small_y_near(self):
        for dimension, near in [(3, [0, -1, 0]), (2, [0, 0, 1])]:
            gravity = [0, 0, -9.81] if dimension == 3 else [0, -9.81, 0]
            front, above = pictures.views({"gravity": gravity, "dimension": dimension})
            np.testing.assert_array_equal(front(near), [0, 0, 1])
            np.testing.assert_array_equal(front(gravity)[:2], [0, -9.81])
            np.testing.assert_array_equal(above(gravity), [0, 0, -9.81])

    def test_faces_point_outwards_and_close_the_shape(self):
        corners = [0, 0, 0, 0, 3, 0, 2, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 2, 0, 0, 0, 3, 0, 0, 0, 1, 0, 3, 0, 0, 0, 0, 0, 0, 1]
        for shape, volume in [({"kind": "box", "size": [1, 2, 3]}, 6),
                              ({"kind": "surface", "size": [2, 3, 1], "triangles": corners}, 1), ({"kind": "cylinder", "size": [1, 2, 0]}, 2 * np.pi),
                              ({"kind": "sphere", "size": [1, 0, 0]}, 4 / 3 * np.pi)]:
            total = 0
            for face in pictures.faces_of(shape):
                for a, b in zip(face[1:-1], face[2:]):
                    total += face[0] @ np.cross(a, b) / 6
            self.assertAlmostEqual(total / volume, 1, delta=0.05, msg=shape["kind"])

    def test_hidden_particles_are_left_out_and_the_rest_goes_far_to_near(self):
        points = np.array([[0, 0, 0.0], [0, 0, 5.0], [10, 0, -1.0], [0, 0, 4.9]])
        self.assertEqual(pictures.visible(points, 1.0).tolist(), [2, 3, 1])


class PathsTest(RunTest):
    BANDS = ("case,body,quantity,low [m],high [m],near time [s],published model [m],published model near time [s],source\n"
             "blocks=4; depth=0.01,B1,X,0.12,0.20,1.0,0.3,1.1,one\n"
             "blocks=4; depth=0.01,B2,X,0.30,0.40,,,,two\n"
             "blocks=9; depth=0.01,B1,X,0.0,0.01,,,,of another case\n")

    def rows(self):
        with open(self.folder / "displacements.csv", encoding="utf-8") as file:
            return {row["block"]: row for row in csv.DictReader(file)}

    def test_both_readings_are_judged(self):
        make_run(self.folder)
        (self.folder / "bands.csv").write_text(self.BANDS)
        outcome = run("paths.py", self.folder, "--bands", self.folder / "bands.csv")
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        rows = self.rows()
        self.assertEqual(list(rows), ["A1", "A2", "B1", "B2"])
        self.assertAlmostEqual(float(rows["B1"]["largest coordinate [m]"]), 0.14)
        self.assertAlmostEqual(float(rows["B1"]["largest displacement [m]"]), 0.10)
        self.assertAlmostEqual(float(rows["B1"]["time of largest displacement [s]"]), 1.0)
        self.assertEqual(rows["B1"]["coordinate against band"], "inside")
        self.assertEqual(rows["B1"]["displacement against band"], "0.020 below")
        self.assertEqual(rows["B2"]["coordinate against band"], "0.090 below")
        self.assertEqual(rows["A1"]["coordinate against band"], "")
        self.assertNotIn("of another case", outcome.stdout)
        self.assertEqual((self.folder / "displacements.md").read_text().strip(), outcome.stdout.strip())
        self.assertEqual(plt.imread(self.folder / "paths.png").ndim, 3)

    def test_until_limits_the_search(self):
        make_run(self.folder)
        self.assertEqual(run("paths.py", self.folder, "--until", 0.5).returncode, 0)
        self.assertAlmostEqual(float(self.rows()["B1"]["largest displacement [m]"]), 0.05)

    def test_case_without_a_band_is_said(self):
        make_run(self.folder)
        (self.folder / "bands.csv").write_text(self.BANDS)
        outcome = run("paths.py", self.folder, "--bands", self.folder / "bands.csv", "--case", "blocks=5")
        self.assertIn("No measured band", outcome.stdout)

    def test_errors_name_file_and_line(self):
        make_run(self.folder)
        (self.folder / "bands.csv").write_text(self.BANDS.replace("0.30,0.40", "0.30,wide"))
        for arguments, status, message in [
                ([self.folder, "--bands", self.folder / "bands.csv"], 2, "bands.csv, line 3: high [m] is 'wide'"),
                ([self.folder, "--bands", self.folder / "none.csv"], 2, "none.csv is missing"),
                ([self.folder / "none"], 2, "is not a folder")]:
            outcome = run("paths.py", *arguments)
            self.assertEqual(outcome.returncode, status)
            self.assertIn(message, outcome.stderr)
            self.assertNotIn("Traceback", outcome.stderr)

    def test_bands_of_the_example_are_readable(self):
        bands = paths.read_bands(TOOLS.parent / "examples/dam-break-blocks/experiment.csv")
        self.assertEqual(len(bands), 7)
        self.assertTrue(all(set(band["conditions"]) == {"blocks", "downstream_depth"} for band in bands))


class BlockTableTest(RunTest):
    def test_tables_go_between_the_marks_of_a_page(self):
        runs, page = self.folder / "runs", self.folder / "page.md"
        one = runs / "4-blocks-0.01-m"
        one.mkdir(parents=True)
        (one / "displacements.csv").write_text(
            "block,largest coordinate [m],largest displacement [m],time of largest displacement [s],band low [m],"
            "band high [m],coordinate against band,displacement against band,published model [m]\n"
            "A1,0.3,0.25,1.1,,,,,\nB1,0.31,0.24,1.2,0.2,0.26,0.050 above,inside,0.28\n")
        (one / "summary.json").write_text(json.dumps({
            "water_particles": 10, "steps": 5, "wall_seconds": 7.4, "volume_drift": 0.004,
            "extremes": {"water_outside_tank": 0, "water_inside_bodies": 0},
            "coupling": {"waiting_share_of_wall_time": 0.02}, "solid": {"share_of_wall_time": 0.1}}))
        page.write_text("before\n<!-- table: begin -->\nold\n<!-- table: end -->\nafter\n")
        done = run("block_table.py", runs, "--measured", "--into", page)
        self.assertEqual(done.returncode, 0, done.stderr)
        text = page.read_text()
        self.assertIn("| 4 | 1 cm | B1 | 0.310 | 0.240 | 1.20 | 0.20 to 0.26 | 0.28 | X 0.050 above; displacement inside |",
                      text)
        self.assertIn("| 4 | 1 cm | 10 | 5 | 7 | +0.4 % | 0 / 0 | 2.0 % | 10.0 % |", text)
        self.assertTrue(text.startswith("before\n") and text.endswith("after\n"))
        self.assertNotIn("A1", text)
        self.assertNotIn("old", text)

    def test_errors_say_what_is_missing(self):
        for folder, message in ((self.folder / "none", "is not a folder"), (self.folder, "holds no runs like")):
            done = run("block_table.py", folder)
            self.assertEqual(done.returncode, 2)
            self.assertIn(message, done.stderr)


class SchemeTableTest(unittest.TestCase):
    def test_errors_say_what_is_missing(self):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / "page.md"
            page.write_text("no place\n")
            for arguments, message in ((["no-case"], "there is no case 'no-case'; there are: tank-at-rest"),
                                       (["--into", page], "has no place for the table")):
                done = run("scheme_table.py", *arguments)
                self.assertEqual(done.returncode, 2)
                self.assertIn(message, done.stderr)

    def test_a_new_table_takes_the_place_of_the_old_one(self):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / "page.md"
            page.write_text("before\n<!-- schemes: begin -->\nold\n<!-- schemes: end -->\nafter\n")
            scheme_table.put_into(page, "| new |\n")
            self.assertEqual(page.read_text(), "before\n<!-- schemes: begin -->\n| new |\n<!-- schemes: end -->\nafter\n")


class PicturesTest(RunTest):
    def colours(self, name):
        """Shares of the picture that are bluer than red, and the other way round."""
        image = plt.imread(self.folder / "pictures" / name)
        bluer = image[:, :, 2] - image[:, :, 0]
        return np.mean(bluer > 0.1), np.mean(bluer < -0.1)

    def test_chosen_times_and_contact_sheet(self):
        make_run(self.folder)
        outcome = run("pictures.py", self.folder)
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        self.assertEqual(sorted(os.listdir(self.folder / "pictures")), ["0.000s.png", "0.500s.png", "contact-sheet.png"])
        slow, fast = self.colours("0.000s.png"), self.colours("0.500s.png")  # blue at rest, yellow at the highest speed
        self.assertGreater(slow[0], 0.05)
        self.assertLess(slow[1], 0.02)
        self.assertGreater(fast[1], 0.05)
        self.assertLess(fast[0], 0.02)

    def test_two_dimensions_other_shapes_and_pressure(self):
        for k, shape in enumerate([{"kind": "cylinder", "size": [0.02, 0.02, 0]}, {"kind": "sphere", "size": [0.02, 0, 0]}]):
            folder = self.folder / str(k)
            folder.mkdir()
            make_run(folder, 2, shape)
            outcome = run("pictures.py", folder, "--by", "pressure", "--times", "all", "--out", folder / "all")
            self.assertEqual(outcome.returncode, 0, outcome.stderr)
            self.assertEqual(len(os.listdir(folder / "all")), 4)

    def test_missing_frame_is_an_error_with_its_name(self):
        make_run(self.folder)
        os.remove(self.folder / "fields/000001.h5")
        outcome = run("pictures.py", self.folder)
        self.assertEqual(outcome.returncode, 2)
        self.assertIn("fields/000001.h5", outcome.stderr)
        self.assertNotIn("Traceback", outcome.stderr)


class EnergiesTest(RunTest):
    def test_plot(self):
        (self.folder / "energies.csv").write_text("t [s],kinetic [J],potential [J],elastic [J],total [J],mass [kg]\n"
                                                  "0,0,2,0,2,1\n1,1,1,0,2,1\n")
        self.assertEqual(run("energies.py", self.folder).returncode, 0)
        self.assertEqual(plt.imread(self.folder / "energies.png").ndim, 3)

    def test_missing_file(self):
        outcome = run("energies.py", self.folder)
        self.assertEqual(outcome.returncode, 2)
        self.assertIn("energies.csv is missing", outcome.stderr)


class ValidationPlotsTest(RunTest):
    def bar(self, name, value, work, required=True, upper=2.0):
        return {"name": name, "value": value, "lower": 0, "upper": upper, "required": required, "core_seconds": work}

    def test_quantities_are_joined_over_resolutions_and_measured_in_bars(self):
        bars = [self.bar("2-D, 20 layers: RMS", 4.0, 1, required=False), self.bar("2-D, 40 layers: RMS", 1.0, 8),
                self.bar("2-D, 40 layers: lost", 0, 8, upper=0), self.bar("tip", 1.0, 1, required=False)]
        self.assertEqual(validation_plots.precision_of({"bars": bars}), {"2-D: RMS": [(1, 2.0), (8, 0.5)]})

    def test_a_picture_for_each_case_that_has_curves(self):
        curve = {"panel": "front; t; x", "label": "experiment", "x": [0, 1], "y": [1, 2], "reference": True, "points": True}
        case = {"curves": [curve], "bars": [self.bar("a/l0 16: RMS", 3.0, 1), self.bar("a/l0 32: RMS", 1.0, 9)]}
        outcome = {"cases": {"dam": case, "nothing": {"curves": [], "bars": []}}}
        (self.folder / "validation.json").write_text(json.dumps(outcome))
        done = run("validation_plots.py", self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.folder / "dam.png").exists())
        self.assertFalse((self.folder / "nothing.png").exists())

    def test_a_report_keeps_the_cases_that_are_not_run_again(self):
        case = {"title": "Wave", "effort": "full", "revision": "abc", "error": None, "curves": [], "bars": []}
        for name, text in (("wave", "first outcome"), ("drop", "from another run"), ("wave", "new")):
            validate.write_report(name, case | {"text": text}, self.folder)
        report = (self.folder / "report.md").read_text()
        self.assertLess(report.index("from another run"), report.index("new"))  # by name
        self.assertNotIn("first outcome", report)
        self.assertIn("Effort: full; commit abc.", report)

    def test_runs_that_ended_are_taken_when_a_validation_is_resumed(self):
        (self.folder / "embacle").write_text("""#!/bin/sh
while [ "$1" != --out ]; do shift; done
echo run >> "$2.count"
echo '{"wall_seconds": 1}' > "$2/summary.json"
exit ${STATUS:-0}
""")
        (self.folder / "embacle").chmod(0o755)
        results = self.folder / "results"

        def runs(name, settings, revision, status="0"):
            with mock.patch.multiple(validate, ROOT=self.folder, revision=lambda: revision), \
                    mock.patch.dict("os.environ", STATUS=status):
                done = validate.Context("case", "quick", results).run(name, "scene", settings, allowed=(0, 3, 4))
            self.assertEqual(done.status, int(status))
            return (results / "case" / f"{name}.count").read_text().count("run")
        self.assertEqual(runs("a", ["x=1"], "abc"), 1)
        self.assertEqual(runs("a", ["x=1"], "abc"), 1)  # taken
        self.assertEqual(runs("a", ["x=2"], "abc"), 2)  # another command
        self.assertEqual(runs("a", ["x=2"], "def"), 3)  # other sources
        self.assertEqual(runs("b", [], "abc-dirty"), 1)
        self.assertEqual(runs("b", [], "abc-dirty"), 2)  # may be other sources
        self.assertEqual(runs("c", [], "abc", "3"), 1)
        self.assertEqual(runs("c", [], "abc", "3"), 1)  # stopped by itself
        self.assertEqual(runs("d", [], "abc", "4"), 1)
        self.assertEqual(runs("d", [], "abc", "4"), 2)  # the machine failed

    def test_a_report_is_a_page_as_well(self):
        case = {"title": "Wave", "effort": "full", "revision": "abc", "error": None, "curves": []}
        bar = self.bar("a < b: RMS", 3.0, 1) | {"inside": False, "unit": "m"}
        validate.write_report("wave", case | {"bars": [bar], "text": "| quantity |\n|---|\n| **no** |"}, self.folder)
        page = (self.folder / "report.html").read_text()
        self.assertIn('<a href="#wave">wave</a>', page)
        self.assertIn('<h2 id="wave">', page)
        self.assertIn("<td><strong>no</strong></td>", page)
        self.assertIn("a &lt; b: RMS: 3 m", page)

    def test_missing_results(self):
        done = run("validation_plots.py", self.folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("validation.json is missing", done.stderr)


class Arrivals(unittest.TestCase):
    def test_bodies_that_came_later_are_drawn_and_filmed(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            make_run(folder)
            shapes = json.loads((folder / "shapes.json").read_text())
            late = shapes["bodies"].pop()
            (folder / "shapes.json").write_text(json.dumps(shapes))
            (folder / "arrivals.csv").write_text(f"t [s],tag [-],shape [-]\n0.5,{late['tag']},{late['shape']}\n")
            self.assertEqual(run_folder.read_shapes(str(folder))["bodies"][-1], late)
            film = folder / "film.gif"
            done = subprocess.run([sys.executable, str(TOOLS / "pictures.py"), name, "--times", "all", "--view", "above",
                                   "--film", str(film)], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(film.read_bytes()[:4], b"GIF8")
            shapes["walls"].append({"name": "ground", "kind": "stl", "lower": [0, 0, -0.01], "upper": [0.6, 0.15, 0], "open": [],
                                    "triangles": [0, 0, 0, 0.6, 0, 0, 0.6, 0.15, 0]})
            (folder / "shapes.json").write_text(json.dumps(shapes))
            done = subprocess.run([sys.executable, str(TOOLS / "pictures.py"), name, "--view=-30,40", "--times", "0.5"],
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            done = subprocess.run([sys.executable, str(TOOLS / "pictures.py"), name, "--view", "30,90"], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr.count("allowed: front, above, or two numbers")), (2, 1))
            done = subprocess.run([sys.executable, str(TOOLS / "pictures.py"), name, "--film", "film.avi"],
                                  capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr.count("allowed: a name that ends with .gif")), (2, 1))


class Camera(unittest.TestCase):
    UP = ([1, 0, 0], [0, 0, 1])

    def test_it_stands_where_it_is_told(self):
        front = pictures.View(*self.UP)
        np.testing.assert_allclose(pictures.View.camera(0, 0, self.UP).axes, front.axes, atol=1e-15)
        right = pictures.View.camera(90, 0, self.UP).axes  # from the right: y to the right, x towards the viewer
        np.testing.assert_allclose(right, [[0, 1, 0], [0, 0, 1], [1, 0, 0]], atol=1e-15)
        np.testing.assert_allclose(pictures.View.camera(20, 35, self.UP).axes[2], [
            np.sin(np.radians(20)) * np.cos(np.radians(35)), -np.cos(np.radians(20)) * np.cos(np.radians(35)), np.sin(np.radians(35))],
            atol=1e-15)
        axes = pictures.View.camera(33, 50, self.UP).axes
        np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-15)

    def test_what_is_behind_a_face_is_hidden(self):
        face = np.array([[0, 0, 1], [1, 0, 1], [1, 1, 2], [0, 1, 2]], dtype=float)  # depth 1 + y
        points = np.array([[0.5, 0.5, 1.4], [0.5, 0.5, 1.6], [1.5, 0.5, 0], [0.5, 0.9, 1.75], [0.5, 0.1, 1.75]])
        np.testing.assert_array_equal(pictures.hidden(points, [face], 0.05), [True, False, False, True, False])


class Faces(unittest.TestCase):
    def test_triangles_of_a_plane_become_its_outline(self):
        square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
        lower = [[square[0], square[2], square[1]], [square[0], square[3], square[2]]]
        upper = [[[x, y, 0.5] for x, y, _ in reversed(face)] for face in lower]
        sides = []
        for a, b in zip(square, square[1:] + square[:1]):
            up = [[*a[:2], 0.5], [*b[:2], 0.5]]
            sides += [[a, b, up[1]], [a, up[1], up[0]]]
        faces = pictures.flat_faces(np.array(lower + upper + sides, dtype=float))
        self.assertEqual(sorted(len(face) for face in faces), [4] * 6)
        for face in faces:
            normal = np.cross(face[1] - face[0], face[2] - face[1])
            self.assertGreater(normal @ (face.mean(axis=0) - [0.5, 0.5, 0.25]), 0, "outwards")
        hook = np.array([[[0, 0, 0], [2, 0, 0], [0.5, 0.5, 0]], [[0, 0, 0], [0.5, 0.5, 0], [0, 2, 0]]], dtype=float)
        self.assertEqual([len(face) for face in pictures.flat_faces(hook)], [3, 3], "not convex: as it was")


if __name__ == "__main__":
    unittest.main()
