#!/usr/bin/python3
"""Tests of the scripts for rivers: grounds of reaches, fields of floes, analysis of a run."""
import contextlib
import csv
import io
import pathlib
import tempfile
import unittest

import numpy as np
from tools_test import make_run

import analyse  # tools/ is known from tools_test
import floes
import reach
import run_folder


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
