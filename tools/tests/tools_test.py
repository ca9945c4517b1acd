#!/usr/bin/python3
"""Tests of the scripts in tools/, on small run folders made here."""
import contextlib
import csv
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

TOOLS = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(TOOLS))

import matplotlib.pyplot as plt  # noqa: E402
import analyse  # noqa: E402
import floes  # noqa: E402
import paths  # noqa: E402
import reach  # noqa: E402
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


class Analysis(unittest.TestCase):
    """Volumes, speeds and impulses that are known."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def analyse(self, *options):
        with contextlib.redirect_stdout(io.StringIO()) as output:
            analyse.main([str(self.folder), *options])
        return output.getvalue()

    def table(self, name):
        return run_folder.read_table(self.folder / "analysis" / name)

    def test_ice_is_all_there_and_drifts(self):
        triangles = reach.sweep(np.array([[0, -0.01, 0, 0], [0, 0.01, 0, 0]], dtype=float),  # a triangular prism along x
                                [(np.array([a, a]), np.array([b, b])) for a, b in ((-0.03, -0.02), (0.03, -0.02), (0.03, 0.02),
                                                                                  (-0.03, 0.02))], ((0, 1, 2, 3),))[0]
        above = self.folder
        for shape in (None, {"kind": "surface", "size": [0.02, 0.06, 0.04], "triangles": triangles.ravel().tolist()}):
            self.folder = above / ("blocks" if shape is None else "surfaces")
            self.folder.mkdir()
            make_run(self.folder, shape=shape)
            volume = 4 * (0.06 * 0.06 * 0.02 if shape is None else 0.02 * 0.06 * 0.04)
            self.assertIn("thickest", self.analyse("--to", "0.99", "--cell", "0.03"))
            cells, profile = self.table("map.csv"), self.table("profile.csv")
            self.assertAlmostEqual(cells["thickness"].sum() * 0.03**2 / volume, 1, delta=0.03)
            icy = cells["thickness"] > 1e-4
            np.testing.assert_allclose(cells["drift speed"][icy], 0.1, rtol=1e-6)
            self.assertAlmostEqual(profile["thickness"].sum() * 0.03 * 0.15 / volume, 1, delta=0.03)
            height = 0.02 if shape is None else 0.04
            full = profile["concentration"] > 0.05
            np.testing.assert_allclose(profile["top to bottom"][full], height, rtol=0.15)
            np.testing.assert_allclose(profile["porosity"][full], 0, atol=0.1)

    def test_forces_are_means_peaks_and_impulses(self):
        make_run(self.folder)
        (self.folder / "structures").mkdir()
        (self.folder / "structures/pier.csv").write_text(
            "t [s],fx [N],fy [N],fz [N],tx [N m],ty [N m],tz [N m]\n0,9,9,9,0,0,0\n0.5,2,0,0,0,0,0\n0.75,-4,3,0,0,0,0\n2,100,0,0,0,0,0\n")
        (self.folder / "ice.csv").write_text(
            "t [s]," + ",".join(f"pier {c} [N]" for c in "fx fy fz".split()) + ",pier tx [N m],pier ty [N m],pier tz [N m]\n"
            "0,0,0,0,0,0,0\n1,0,0,7,0,0,0\n")
        said = self.analyse("--to", "1")
        self.assertIn("ice on pier: mean (0, 0, 7) N, largest 7 N at 1 s", said)
        with open(self.folder / "analysis/forces.csv", encoding="utf-8") as stream:
            rows = list(csv.reader(stream))
        water = next(row for row in rows if row[1] == "water")
        np.testing.assert_allclose([float(cell) for cell in water[2:]], [0, 1, 0, 5, 0.75, 0, 0.75, 0], atol=1e-12)

    def test_mistakes_are_named(self):
        make_run(self.folder)
        for options, message in ((("--from", "7"), "no row from 7"), (("--from", "1", "--to", "0.5"), "from less than to"),
                                 (("--cell", "0"), "above zero")):
            with self.subTest(options=options), self.assertRaisesRegex(run_folder.RunFolderError, message):
                self.analyse(*options)


class Reach(unittest.TestCase):
    """Grounds of reaches: closed surfaces of the right volume, and errors that say what is allowed."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.file = self.folder / "ground.stl"

    def make(self, *options):
        with contextlib.redirect_stdout(io.StringIO()) as output:
            reach.main([*map(str, options), "--out", str(self.file)])
        self.assertGreater((self.folder / "ground.png").stat().st_size, 1000)
        return output.getvalue()

    def triangles(self, path):
        data = np.fromfile(path, dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")], offset=84)
        edges = set()
        for corners in data["corners"]:
            a, b, c = (tuple(map(float, corner)) for corner in corners)
            for edge in ((a, b), (b, c), (c, a)):
                self.assertNotIn(edge, edges)
                edges.add(edge)
        for a, b in edges:
            self.assertIn((b, a), edges, "an edge belongs to two triangles of opposite sense")
        return data["corners"].astype(float)

    def test_a_trapezoidal_channel_has_the_volumes_of_its_sections(self):
        self.make("channel", "--path", "straight 2", "--width", 0.4, "--height", 0.3, "--bank-slope", 1, "--depth", 0.1,
                  "--thickness", 0.1)
        ground = self.triangles(self.file)
        self.assertAlmostEqual(reach.volume(ground), 2.2 * (1.2 * 0.4 - 0.5 * (0.4 + 1.0) * 0.3), places=6)
        np.testing.assert_allclose([ground.min(axis=(0, 1)), ground.max(axis=(0, 1))], [[-0.1, -0.6, -0.1], [2.1, 0.6, 0.3]], atol=1e-6)
        self.assertAlmostEqual(reach.volume(self.triangles(self.folder / "ground-water.stl")), 2 * 0.5 * (0.4 + 0.6) * 0.1, places=6)

    def test_bends_sills_and_contractions_are_closed(self):
        said = self.make("channel", "--path", "straight 1; left 90 radius 1; right 30 radius 2; straight 0.5", "--width", 0.4,
                         "--height", 0.3, "--sill", 0.5, 0.6, 0.05, "--contraction", 2.5, 1, 0.3, "--slope", 0.01, "--depth", 0.2)
        self.assertIn("heading 60 degrees", said)
        self.assertGreater(reach.volume(self.triangles(self.file)), 0)
        water = self.triangles(self.folder / "ground-water.stl")
        # Pappus: the section times the way of its middle, less what sill and contraction take.
        length = 1 + 0.5 * np.pi + np.pi / 3 + 0.5
        self.assertLess(reach.volume(water), 0.08 * length)
        self.assertGreater(reach.volume(water), 0.08 * length - 0.4 * 0.05 * 0.6 - 0.1 * 0.2 * 1)

    def test_a_raster_is_closed_and_keeps_its_heights(self):
        heights = np.array([[5.0, 6, 7, 8], [4, 3, 2, 9], [1, -9999, 3, 4]])  # from north to south
        grid = self.folder / "ground.asc"
        grid.write_text("ncols 4\nnrows 3\nxllcorner 100\nyllcorner 50\ncellsize 2\nNODATA_value -9999\n"
                        + "\n".join(" ".join(map(str, row)) for row in heights) + "\n")
        self.make("raster", grid, "--nodata", 2, "--scale", 0.5, "--thickness", 1)
        ground = self.triangles(self.file)
        corners = {tuple(np.round(corner, 5)) for corner in ground.reshape(-1, 3)}
        for row, line in enumerate(heights[::-1]):
            for column, height in enumerate(line):
                height = 0.5 * ((2 if height == -9999 else height) - 1)
                self.assertIn((column, row, height), corners)
        self.make("raster", grid, "--window", 100, 50, 106, 56, "--every", 2)
        self.assertEqual(np.ptp(self.triangles(self.file)[:, :, 0]), 4)

    def test_mistakes_are_named(self):
        grid = self.folder / "ground.asc"
        channel = ("channel", "--width", 0.4, "--height", 0.3, "--path")
        grid.write_text("ncols 2\nnrows 2\ncellsize 1\n1 2\n3 4\n")
        for options, message in (
                ((*channel, "straight 1; left 90"), "'left 90' is not a part of a path; allowed: straight LENGTH"),
                ((*channel, "left 90 radius 0.2"), "too tight"),
                ((*channel, "straight 1", "--depth", 0.4), "below the banks"),
                ((*channel, "straight 1", "--sill", 0.5, 0.5, 0.4), "closes the channel"),
                (("raster", grid), "the header lacks 'xllcenter'"),
                (("raster", self.folder / "none.asc"), "there is no file")):
            with self.subTest(message=message), self.assertRaisesRegex(run_folder.RunFolderError, message):
                reach.main([*map(str, options), "--out", str(self.file)])
        text = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n3 "
        for rest, message in (("x", "ground.asc:7: a height is not a number"), ("", "3 heights; allowed: nrows times ncols, 4")):
            grid.write_text(text + rest + "\n")
            with self.assertRaisesRegex(run_folder.RunFolderError, message):
                reach.main(["raster", str(grid), "--out", str(self.file)])


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


class Floes(unittest.TestCase):
    """Fields of floes: what is asked for, nothing on top of each other, the same every time."""

    BASE = ("--from", "0", "0", "--to", "6", "3", "--level", "0.5")

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = pathlib.Path(folder.name) / "floes.csv"

    def make(self, *options):
        """Rows of the table as dictionaries, with the outline as an array."""
        with contextlib.redirect_stdout(io.StringIO()):
            floes.main([*self.BASE, *options, "--out", str(self.file)])
        self.assertGreater(self.file.with_suffix(".png").stat().st_size, 1000)
        with self.file.open() as stream:
            self.assertTrue(stream.readline().startswith("# ./embacle floes "))
            table = list(csv.reader(stream))
        names = [name.split("[")[0].strip() for name in table[0]]
        rows = [dict(zip(names, (cell.strip() for cell in row))) for row in table[1:]]
        for row in rows:
            row["corners"] = np.array(row["outline"].split(), dtype=float).reshape(-1, 2)
            row["place"] = row["corners"] + [float(row["x"]), float(row["y"])]
        return rows

    def assert_apart(self, polygons, gap):
        """By brute force: no corner of one is in another or nearer to it than the gap."""
        for i, a in enumerate(polygons):
            for j, b in enumerate(polygons):
                if i == j or np.linalg.norm(a.mean(axis=0) - b.mean(axis=0)) > 3:
                    continue
                along = np.roll(b, -1, axis=0) - b
                offset = a[:, None] - b[None]
                share = np.clip((offset * along).sum(axis=2) / (along**2).sum(axis=1), 0, 1)
                distance = np.linalg.norm(offset - share[..., None] * along, axis=2).min(axis=1)
                outside = (along[:, 0] * offset[..., 1] - along[:, 1] * offset[..., 0]).min(axis=1) < 0
                self.assertTrue(np.all(outside), (i, j))
                self.assertGreaterEqual(distance.min(), gap - 1e-4, (i, j))

    def test_concentration_and_gap(self):
        for shape, allowed in (("polygon", 0.04), ("disc", 0.04), ("voronoi", 0.02)):
            with self.subTest(shape=shape):
                gap = 0 if shape == "voronoi" else 0.02
                rows = self.make("--shape", shape, "--concentration", "0.45", "--size", "uniform:0.2:0.6", "--gap", str(gap))
                areas = [floes.area(row["corners"]) for row in rows]
                self.assertAlmostEqual(sum(areas) / 18, 0.45, delta=allowed)
                for row in rows:
                    np.testing.assert_allclose(floes.centroid(row["corners"]), 0, atol=1e-4)
                    self.assertTrue(np.all(row["place"] >= -1e-5) and np.all(row["place"] <= np.array([6, 3]) + 1e-5))
                self.assert_apart([row["place"] for row in rows], gap)

    def test_drafts_and_seeds(self):
        rows = self.make("--thickness", "uniform:0.05:0.15", "--density", "900")
        for row in rows:
            thickness = float(row["thickness"])
            self.assertAlmostEqual(0.5 - (float(row["z"]) - 0.5 * thickness), 0.9 * thickness, delta=1e-5)
        first = self.file.read_text()
        self.make("--thickness", "uniform:0.05:0.15", "--density", "900")
        self.assertEqual(self.file.read_text(), first)
        self.make("--thickness", "uniform:0.05:0.15", "--density", "900", "--seed", "2")
        self.assertNotEqual(self.file.read_text(), first)

    def test_a_power_law_has_its_quantiles(self):
        for exponent in (1.0, 1.5, 2.5):
            share = np.linspace(0, 1, 11)
            found = floes.power_quantile(share, exponent, 0.02, 0.2)
            self.assertAlmostEqual(found[0], 0.02)
            self.assertAlmostEqual(found[-1], 0.2)
            above = (found**-exponent - 0.2**-exponent) / (0.02**-exponent - 0.2**-exponent)
            np.testing.assert_allclose(above, 1 - share, atol=1e-12)  # the number above d falls as d^-exponent
        self.assertAlmostEqual(floes.power_quantile(0.05, 1.5, 0.02, 0.2), 0.020672807, places=9)
        draw = np.sort(floes.sampler("power:1.5:0.02:0.2", "size")(np.random.default_rng(5), 20000))
        for share in (0.25, 0.5, 0.9):
            expected = floes.power_quantile(share, 1.5, 0.02, 0.2)
            self.assertAlmostEqual(draw[int(share * 20000)] / expected, 1, delta=0.03)

    def test_a_stream_carries_what_is_asked_and_never_overlaps(self):
        rows = self.make("--stream", "30", "--velocity", "0.4", "0", "0", "--size", "uniform:0.2:0.5", "--gap", "0.02")
        times = [float(row["t"]) for row in rows]
        self.assertEqual(times, sorted(times))
        self.assertTrue(all(0 <= time <= 30 for time in times))
        self.assertEqual({row["x"] for row in rows}, {"6"})
        areas = sum(floes.area(row["corners"]) for row in rows)
        self.assertAlmostEqual(areas, 0.4 * 3 * 0.4 * 30, delta=0.04 * 14.4)
        # Where they are when the last one has entered: each carried on since its own time.
        self.assert_apart([row["place"] + [0.4 * (30 - time), 0] for row, time in zip(rows, times)], 0.02 - 1e-4)

    def test_mistakes(self):
        for options in (("--concentration", "1.2"), ("--size", "power:1:2"), ("--size", "power:1:2:1"),
                        ("--thickness", "thick"), ("--stream", "5"), ("--concentration", "0.9", "--gap", "0.1")):
            with self.subTest(options=options), self.assertRaises(run_folder.RunFolderError):
                floes.main([*self.BASE, *options, "--out", str(self.file)])


if __name__ == "__main__":
    unittest.main()
