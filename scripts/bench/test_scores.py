#!/usr/bin/env python3
"""Shows that score_contours.py, score_dem.py and terrain.py measure what they say, on ground that is known beforehand.

    .venv/bin/python scripts/bench/test_scores.py
"""
import contextlib
import io
import json
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

import numpy as np
import pyogrio
import rasterio
import shapely

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))  # the modules that scripts share
import benchmark_accuracy
import score_contours
import score_dem
import terrain
import tools

CELL = 10.0
GIVEN, NEW = 20.0, 5.0  # intervals
SLOPE = 0.2  # of the inclined plane: given contours are GIVEN / SLOPE apart


class Plane(unittest.TestCase):
    """Ground that rises evenly to the east: its contours run straight from south to north."""

    def setUp(self):
        self.transform = rasterio.transform.from_origin(1000, 5000, CELL, CELL)
        column = np.arange(200)
        # A third of a metre off, so that no cell centre lies on a contour.
        self.truth = np.tile(column * CELL * SLOPE + 1 / 3, (150, 1))

    def score(self, lines, levels, truth=None, **other):
        truth = self.truth if truth is None else truth
        return score_contours.score(lines, levels, truth, self.transform, NEW, GIVEN, **other)

    def lines(self):
        return terrain.contours(self.truth, self.transform, NEW)

    def test_own_contours(self):
        out = self.score(*self.lines())
        self.assertAlmostEqual(out["sum"], 0, places=9)
        self.assertAlmostEqual(out["cap"], GIVEN / SLOPE, delta=0.1 * GIVEN / SLOPE)

    def test_moved_lines(self):
        lines, levels = self.lines()
        out = self.score(shapely.transform(lines, lambda xy: xy + [3.0, 0]), levels)
        for way in ("new_to_true", "true_to_new"):
            self.assertAlmostEqual(out[way]["mean"], 3, places=6)
            self.assertAlmostEqual(out[way]["p95"], 3, places=6)

    def test_height_error_is_slope_times_distance(self):
        lines, levels = self.lines()
        moved = shapely.transform(lines, lambda xy: xy + [3.0, 0])
        height = self.score(moved, levels)["height"]["new"]
        for figure in ("rmse", "p95"):
            self.assertAlmostEqual(height[figure], 3 * SLOPE, places=5)
            self.assertAlmostEqual(height[f"{figure}_share"], 3 * SLOPE / GIVEN, places=6)

    def test_uneven_height_error(self):
        # Turned about the middle: the distance grows evenly to `most`, which is at the edge of the area.
        lines, levels = self.lines()
        reach, middle, most = 73.5 * CELL, 5000 - 75 * CELL, 10.0
        lean = lambda xy: xy + np.column_stack([most * (xy[:, 1] - middle) / reach, np.zeros(len(xy))])
        height = self.score(shapely.transform(lines, lean), levels)["height"]["new"]
        self.assertAlmostEqual(height["rmse"], most * SLOPE / 3**0.5, delta=0.02)
        self.assertAlmostEqual(height["p95"], 0.95 * most * SLOPE, delta=0.02)

    def test_height_error_of_a_height_map(self):
        # Lines of a map that is too high by 0.7 lie where the ground is lower than their level by 0.7.
        out = self.score(*self.lines(), dem=(self.truth + 0.7, self.transform))
        self.assertAlmostEqual(out["height"]["dem"]["rmse"], 0.7, places=5)
        self.assertAlmostEqual(out["height"]["new"]["rmse"], 0, places=5)

    def test_area_of_the_cut_contours(self):
        lines, levels = self.lines()
        middle = 1000 + 101 * CELL  # 9 of the 18 strips between given contours lie west of it

        def western(*ground):
            cut, at = terrain.contours(*ground)
            west = shapely.bounds(cut)[:, 2] < middle
            return cut[west], at[west]

        length = lambda **other: self.score(lines, levels, **other)["new_to_true"]["length"]
        self.assertAlmostEqual(length(cut=western) / length(), 9 / 18, places=6)

    def test_zigzag_bends(self):
        # Legs of 4 cells to the north, 0.8 to the side: the corners alone turn, once a leg.
        _, levels = self.lines()
        y = np.arange(3500, 5000, 4 * CELL)
        side = 0.8 * CELL * (np.arange(len(y)) % 2)
        lines = shapely.linestrings([np.column_stack([1000 + CELL / 2 + (z - 1 / 3) / SLOPE + side, y]) for z in levels])
        bends = self.score(lines, levels)["bends"]
        corner, leg = 2 * np.degrees(np.arctan(0.2)), np.hypot(4, 0.8)
        self.assertAlmostEqual(bends["new"]["degrees"], corner / leg, delta=0.05 * corner / leg)
        self.assertLess(bends["true"]["degrees"], 1e-6)

    def test_given_levels_do_not_count(self):
        lines, levels = self.lines()
        given = levels % GIVEN == 0
        moved = np.where(given, shapely.transform(lines, lambda xy: xy + [40.0, 0]), lines)
        self.assertAlmostEqual(self.score(moved, levels)["sum"], 0, places=9)

    def test_missing_level(self):
        lines, levels = self.lines()
        new = np.unique(levels[levels % GIVEN != 0])
        inner = new[len(new) // 2]
        keep = levels != inner
        out = self.score(lines[keep], levels[keep])
        self.assertAlmostEqual(out["new_to_true"]["mean"], 0, places=9)
        missing = out["true_to_new"]["at_cap"]
        self.assertAlmostEqual(out["true_to_new"]["mean"], out["cap"] * missing / 100, places=6)
        self.assertAlmostEqual(missing, 100 / len(new), delta=0.2 * 100 / len(new))

    def test_wrong_level(self):
        lines, levels = self.lines()
        out = self.score(lines, levels + NEW, cap=1000.0)
        # Lines moved up by one level stand NEW / SLOPE from where they belong; the outermost ones may lack a partner.
        self.assertAlmostEqual(out["true_to_new"]["median"], NEW / SLOPE, places=6)

    def test_hole_in_the_truth(self):
        truth = self.truth.copy()
        truth[60:90, 60:120] = np.nan
        self.assertAlmostEqual(self.score(*self.lines(), truth=truth)["sum"], 0, places=6)

    def test_samples_are_even(self):
        line = np.array([shapely.linestrings([[0, 0], [1, 0], [1, 9]])])
        xy, level, weight = score_contours.samples(line, np.array([7]), 2.0)
        np.testing.assert_allclose(xy, [[1, 0], [1, 2], [1, 4], [1, 6], [1, 8]])
        np.testing.assert_allclose(weight, 2)
        self.assertTrue((level == 7).all())

    def test_meets(self):
        vertices = score_dem.lone_vertices(*terrain.contours(self.truth, self.transform, GIVEN), self.transform)
        self.assertGreater(len(vertices[0]), 0)
        use = np.ones_like(self.truth, bool)
        for lift, share in ((0, 100), (0.9 * score_dem.MEETS * GIVEN, 100), (1.1 * score_dem.MEETS * GIVEN, 0)):
            self.assertEqual(score_dem.share_met(self.truth + lift, use, vertices, GIVEN), share)

    def test_near_contours_are_left_out(self):
        # Contours at 2.5 metres stand 12.5 metres apart, less than two cells.
        near = terrain.contours(self.truth, self.transform, 2.5)
        self.assertEqual(len(score_dem.lone_vertices(*near, self.transform)[0]), 0)


class Spline(unittest.TestCase):
    """Heights between cells."""

    def setUp(self):
        self.transform = rasterio.transform.from_origin(1000, 5000, CELL, CELL)
        self.x, self.y = terrain.to_map(self.transform, *np.indices((60, 80)))
        draw = np.random.default_rng(7)
        self.at = draw.uniform(995, 1805, 5000), draw.uniform(4395, 5005, 5000)

    def heights(self, cells):
        return terrain.spline_heights(cells, self.transform, *self.at)

    def test_passes_through_the_cells(self):
        rough = np.random.default_rng(8).normal(size=self.x.shape)
        np.testing.assert_allclose(terrain.spline_heights(rough, self.transform, self.x, self.y), rough, atol=1e-9)

    def test_even_slope_up_to_edges_and_holes(self):
        slope = lambda x, y: 0.3 * x - 0.2 * y
        cells = slope(self.x, self.y)
        cells[20:30, 30:50] = np.nan
        row, column = terrain.to_grid(self.transform, *self.at)
        known = (row >= 0) & (row <= 59) & (column >= 0) & (column <= 79)
        known &= ~((row > 19) & (row < 30) & (column > 29) & (column < 50))
        np.testing.assert_allclose(self.heights(cells), np.where(known, slope(*self.at), np.nan), atol=1e-4)

    def test_wave(self):
        # Bound for cubic splines: 5/384 of the fourth derivative and of the fourth power of the cell, for each direction.
        length, height = 12 * CELL, 40.0
        wave = lambda x: height * np.sin(2 * np.pi * x / length)
        bound = 5 / 384 * height * (2 * np.pi * CELL / length) ** 4
        inner = (self.at[0] > 1100) & (self.at[0] < 1700)
        error = np.abs(self.heights(wave(self.x)) - wave(self.at[0]))[inner]
        self.assertLess(np.nanmax(error), bound)


class Turned(unittest.TestCase):
    """Contours that lie on no raster, on ground in waves."""

    LENGTH, HEIGHT = 40 * CELL, 30.0

    def setUp(self):
        self.transform = rasterio.transform.from_origin(1000, 5000, CELL, CELL)
        x, y = terrain.to_map(self.transform, *np.indices((120, 150)))
        self.truth = self.ground(x, y)
        self.lines, self.levels = terrain.turned_contours(self.truth, self.transform, NEW)

    def ground(self, x, y):
        turn = 2 * np.pi / self.LENGTH
        return self.HEIGHT * np.sin(turn * x) * np.cos(turn * y)

    def test_raster(self):
        shape, turned = terrain.turned_raster((120, 150), self.transform)
        x, y = terrain.to_map(turned, np.array([0, 0]), np.array([0, 1]))
        self.assertAlmostEqual(np.hypot(*np.diff([x, y]).flat), 0.8 * CELL)
        self.assertAlmostEqual(abs(np.degrees(np.arctan2(*np.diff([y, x]).flat))), 27)
        # It covers the map.
        corner = np.array([0, 0, shape[0], shape[0]]) - 0.5, np.array([0, shape[1], shape[1], 0]) - 0.5
        whole = shapely.polygons(np.column_stack(terrain.to_map(turned, *corner)))
        self.assertTrue(shapely.contains(whole, shapely.box(1000, 3800, 2500, 5000)))

    def test_lie_on_the_ground(self):
        xy, owner = shapely.get_coordinates(self.lines, return_index=True)
        inner = shapely.contains_xy(shapely.box(1100, 3900, 2400, 4900), xy)
        error = np.abs(self.ground(*xy.T) - self.levels[owner])[inner]
        # A straight line over a cell is off by an eighth of the second derivative along it times the cell's square. This is the
        # greatest derivative in any direction.
        most = self.HEIGHT * (2 * np.pi / self.LENGTH) ** 2
        self.assertLess(error.max(), most * (0.8 * CELL) ** 2 / 8)

    def test_lie_on_no_raster(self):
        on_raster = lambda lines: np.mean(np.min([np.abs(a - np.round(a)) for a in terrain.to_grid(
            self.transform, *shapely.get_coordinates(lines).T)], axis=0) < 1e-6)
        self.assertEqual(on_raster(terrain.contours(self.truth, self.transform, NEW)[0]), 1)
        self.assertLess(on_raster(self.lines), 0.01)

    def test_cover_the_map(self):
        straight, _ = terrain.contours(self.truth, self.transform, NEW)
        self.assertAlmostEqual(shapely.length(self.lines).sum() / shapely.length(straight).sum(), 1, delta=0.03)
        np.testing.assert_allclose(shapely.total_bounds(self.lines), shapely.total_bounds(straight), atol=CELL)

    def test_hole(self):
        truth = self.truth.copy()
        truth[40:60, 50:90] = np.nan
        lines, _ = terrain.turned_contours(truth, self.transform, NEW)
        west, north = terrain.to_map(self.transform, 40, 50)
        east, south = terrain.to_map(self.transform, 59, 89)
        hole = shapely.box(west, south, east, north)
        self.assertFalse(shapely.intersects(lines, hole).any())
        self.assertTrue(shapely.intersects(self.lines, hole).any())

    def test_no_data(self):
        for cut in (terrain.contours, terrain.turned_contours):
            lines, levels = cut(np.full((9, 9), np.nan), self.transform, NEW)
            self.assertEqual((len(lines), len(levels)), (0, 0))

    def test_true_lines_are_the_turned_ones(self):
        score = lambda **other: score_contours.score(
            self.lines, self.levels, self.truth, self.transform, NEW, GIVEN, **other)["sum"]
        self.assertAlmostEqual(score(cut=terrain.turned_contours), 0, places=9)
        self.assertGreater(score(), 0.01)


class Rings(unittest.TestCase):
    """A cone: its contours are circles, which turn by the same angle everywhere."""

    def setUp(self):
        self.transform = rasterio.transform.from_origin(0, 1200, CELL, CELL)
        x, y = terrain.to_map(self.transform, *np.indices((120, 120)))
        self.truth = 1 / 3 + SLOPE * np.hypot(x - 600, y - 600)

    def bends(self, corners, ripple=0.0):
        self.levels = np.array([45.0, 65.0, 85.0])
        turn = np.linspace(0, 2 * np.pi, corners + 1)
        radius = ((self.levels - 1 / 3) / SLOPE)[:, None] + ripple * np.sin(60 * turn)
        lines = shapely.linestrings(np.dstack([600 + radius * np.cos(turn), 600 + radius * np.sin(turn)]))
        return score_contours.score(lines, self.levels, self.truth, self.transform, NEW, GIVEN)["bends"]

    def test_a_full_circle(self):
        even = self.bends(6000)["new"]["degrees"]
        round_ = 360 * CELL * 3 / (2 * np.pi * ((self.levels - 1 / 3) / SLOPE).sum())
        self.assertAlmostEqual(even / round_, 1, delta=0.01)
        # As many vertices as the contours of the height map, and far fewer.
        for corners in (200, 60):
            self.assertAlmostEqual(self.bends(corners)["new"]["degrees"] / even, 1, delta=0.02)

    def test_ripples_bend_more(self):
        self.assertGreater(self.bends(6000, ripple=3.0)["new"]["to_true"], 2 * self.bends(6000)["new"]["to_true"])

    def test_ring_smaller_than_a_cell(self):
        ring = shapely.linestrings([[0, 0], [2, 0], [2, 2], [0, 2], [0, 0]])
        _, angle, length = score_contours.turns(ring, CELL)
        self.assertAlmostEqual(angle.sum(), 360)
        self.assertAlmostEqual(length.sum(), 8)


class Commands(unittest.TestCase):
    """The scripts as they are called."""

    def setUp(self):
        held = tempfile.TemporaryDirectory()
        self.addCleanup(held.cleanup)
        self.folder = pathlib.Path(held.name)
        self.transform = rasterio.transform.from_origin(1000, 5000, CELL, CELL)
        x, y = terrain.to_map(self.transform, *np.indices((90, 100)))
        self.truth = 30 * np.sin(x / 54) * np.cos(y / 70)
        self.path = self.write("truth.tif", self.truth)

    def write(self, name, heights):
        path = str(self.folder / name)
        with rasterio.open(path, "w", driver="GTiff", dtype="float64", count=1, height=heights.shape[0],
                           width=heights.shape[1], transform=self.transform, crs="EPSG:32616") as file:
            file.write(heights, 1)
        return path

    def printed(self, script, *arguments):
        out = io.StringIO()
        with mock.patch.object(sys, "argv", ["script", *arguments]), contextlib.redirect_stdout(out):
            try:
                script.main()
            except SystemExit as end:
                self.assertFalse(end.code)
        return json.loads(out.getvalue())

    def test_score_contours(self):
        lines, levels = terrain.turned_contours(self.truth, self.transform, NEW)
        path = str(self.folder / "lines.gpkg")
        pyogrio.raw.write(path, driver="GPKG", geometry_type="LineString", geometry=shapely.to_wkb(lines), crs="EPSG:32616",
                          field_data=[levels], fields=["elev"])
        high = self.write("high.tif", self.truth + 0.5)
        out = self.printed(score_contours, path, self.path, "--given", str(GIVEN), "--interval", str(NEW), "--turned",
                           "--dem", high, "--json")
        self.assertAlmostEqual(out["sum"], 0, places=9)
        self.assertEqual(out["height"]["new"], out["height"]["true"])
        self.assertAlmostEqual(out["height"]["dem"]["rmse"], 0.5, delta=0.05)

    def test_benchmark_accuracy(self):
        def copy(folder, *_):
            output = str(folder / "copy.tif")
            return [tools.Tool("copy", "cp", [], [], ["cp", self.path, output], [], output)]

        with mock.patch.object(tools, "find", return_value=""), mock.patch.object(tools, "tools", copy):
            for option, cut in (([], terrain.contours), (["--turned"], terrain.turned_contours)):
                out = self.printed(benchmark_accuracy, self.path, str(NEW), "--json", "--keep", str(self.folder), *option)
                vertices = shapely.get_num_coordinates(cut(self.truth, self.transform, NEW)[0]).sum()
                kept, _ = terrain.read_lines(str(self.folder / "contours.gpkg"))
                self.assertEqual(shapely.get_num_coordinates(kept).sum(), vertices)
                self.assertEqual((out["vertices"], out["turned"]), (vertices, bool(option)))
                self.assertEqual(out["figures"]["copy"]["rmse"], 0)
                # Only contours that are straight between the cells are met at every vertex.
                self.assertEqual(out["figures"]["copy"]["meets"] == 100, not option)

    def test_turned_contours_are_not_given_ones(self):
        arguments = ["script", "--turned", "--contours", "drawn.gpkg"]
        with mock.patch.object(sys, "argv", arguments), contextlib.redirect_stderr(io.StringIO()) as told:
            self.assertRaises(SystemExit, benchmark_accuracy.main)
        self.assertIn("--contours", told.getvalue())


class Pits(unittest.TestCase):
    def setUp(self):
        self.transform = rasterio.transform.from_origin(0, 100, 10, 10)
        self.heights = np.full((10, 10), 5.0)

    def test_counts(self):
        self.heights[3, 4] = 4
        self.heights[7, 7:9] = 4  # two level cells: neither is lower than the other
        self.heights[0, 0] = 4  # on the edge: what lies beyond is not known
        self.heights[5, 1], self.heights[6, 1] = 4, np.nan
        self.assertEqual([tuple(p) for p in np.argwhere(score_dem.pits(self.heights))], [(3, 4)])

    def test_along_lines(self):
        cells = np.zeros((10, 10), bool)
        cells[3, 4] = cells[3, 7] = True
        line = np.array([shapely.linestrings([[54, 0], [54, 100]])])  # nine metres from the centre of column 4
        near = score_dem.near_lines(cells, line, self.transform)
        self.assertEqual([tuple(p) for p in np.argwhere(near)], [(3, 4)])


if __name__ == "__main__":
    unittest.main()
