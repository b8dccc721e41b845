#!/usr/bin/env python3
"""Shows that the checks of random_maps.py pass a sound map and find each fault that is planted in it.

    .venv/bin/python scripts/checks/test_random_maps.py

The sound map is made here, without tokosen: the heights of the ground itself, and its contours.
"""
import dataclasses
import pathlib
import sys
import tempfile
import unittest

import numpy as np
import pyogrio
import rasterio
import shapely

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))  # the modules that scripts share
import terrain
from known_ground import checks, coast_maps, counts, flow, ground, kinds, line_maps, map as maps, plain_maps

CELL, INTERVAL = 10.0, 4.0


def hilly(seed=3, rows=50, cols=60):
    heights = 100.0 + 9.0 * ground.noise(np.random.default_rng(seed), 2 * rows, 2 * cols, 2.2)[:rows, :cols]
    transform = rasterio.transform.from_origin(1000.0, 5000.0, CELL, CELL)
    return ground.Ground(ground.off_levels(heights, INTERVAL), transform, INTERVAL)


class Checks(unittest.TestCase):
    def setUp(self):
        made = tempfile.TemporaryDirectory()
        self.addCleanup(made.cleanup)
        self.folder = pathlib.Path(made.name)
        self.random = np.random.default_rng(1)
        self.found = plain_maps.whole_with_spots(hilly(), self.folder, self.random)
        self.ground = self.found.ground
        self.lines, self.levels = terrain.contours(self.ground.heights, self.ground.transform, INTERVAL / 2)
        self.heights = self.ground.heights.copy()

    def inner(self, where=True):
        """A cell well inside the map."""
        cells = np.zeros(self.heights.shape, bool)
        cells[15:-15, 15:-15] = True
        return tuple(np.argwhere(cells & where)[0])

    def counted(self):
        out = dict.fromkeys(counts.COLUMNS, 0)
        (self.folder / "threads2").mkdir(exist_ok=True)
        self.write("threads2/out", self.heights)
        counts.count_heights(out, self.folder, self.found)
        return {column: count for column, count in out.items() if count}

    def write(self, name, heights):
        heights = np.where(np.isfinite(heights), heights, -9999.0)
        dataclasses.replace(self.found.ground, heights=heights).write(self.folder / f"{name}.tif")

    def moved(self, lines):
        return checks.moved(self.found.lines, self.found.levels, lines, self.levels, self.found.original)

    def test_sound_map(self):
        self.assertEqual(self.counted(), {})
        self.assertEqual(self.moved(self.lines), 0)
        self.assertEqual(checks.crossings(self.lines, self.levels), 0)
        self.assertEqual(checks.loops(self.lines), 0)

    def test_moved_vertex(self):
        given = np.flatnonzero(self.levels % INTERVAL == 0)[0]
        points = shapely.get_coordinates(self.lines[given])
        points[1, 0] = np.nextafter(points[1, 0], np.inf)
        self.lines[given] = shapely.linestrings(points)
        self.assertEqual(self.moved(self.lines), 1)

    def test_vertex_at_another_level(self):
        given = np.flatnonzero(self.levels % INTERVAL == 0)[0]
        self.levels[given] += INTERVAL
        self.assertEqual(self.moved(self.lines), len(np.unique(shapely.get_coordinates(self.lines[given]), axis=0)))

    def test_vertices_of_the_cut_alone_need_not_stay(self):
        area = self.found.area.buffer(-150)
        cut = ground.cut(self.found.lines, self.found.levels, area)
        original = self.found.lines, self.found.levels
        inside = shapely.covers(area, shapely.points(shapely.get_coordinates(self.found.lines)))
        self.assertGreater(np.count_nonzero(~inside), 0)
        self.assertEqual(checks.moved(*cut, self.lines, self.levels, original), 0)
        self.assertGreater(checks.moved(*cut, self.lines, self.levels), 0)

    def test_crossing(self):
        a = self.lines[0]
        b = shapely.get_coordinates(a)[1]
        lines = np.append(self.lines, shapely.linestrings([b, b + [0.001, 0.0]]))
        self.assertEqual(checks.crossings(lines, np.append(self.levels, 1e6)), 1)

    def test_line_that_crosses_itself(self):
        lines = np.append(self.lines, shapely.linestrings([[0, 0], [2, 2], [2, 0], [0, 2]]))
        self.assertEqual(checks.loops(lines), 1)

    def test_cell_out_of_band(self):
        for sign in (-1, 1):
            self.heights = self.ground.heights.copy()
            self.heights[self.inner()] += sign * 1.01 * INTERVAL
            self.assertEqual(self.counted().get("band"), 1)

    def test_band_that_is_not_known(self):
        cell = self.inner()
        self.heights[cell] += 9 * INTERVAL
        x, y = self.ground.centres()
        self.found.unknown = shapely.Point(x[cell], y[cell]).buffer(CELL / 2)
        self.found.spots = None
        self.assertEqual(self.counted(), {})

    def test_hole(self):
        self.heights[self.inner()] = np.nan
        self.assertEqual(self.counted().get("holes"), 1)

    def test_missed_spot(self):
        x, y = self.ground.centres()
        spot = self.found.spots[0]
        self.heights[(x == spot[0]) & (y == spot[1])] += 2e-3 * INTERVAL
        self.assertEqual(self.counted(), {"spots": 1})

    def test_feet(self):
        self.found.unit = 0.3048
        levels = counts.in_unit(self.found, self.levels * 0.3048)
        given = self.levels % INTERVAL == 0
        self.assertTrue((levels[given] == self.levels[given]).all())
        np.testing.assert_allclose(levels, self.levels)
        self.assertNotEqual(self.counted(), {})
        self.heights *= 0.3048
        self.assertEqual(self.counted(), {})

    def test_below_a_lake(self):
        self.found = plain_maps.lake(hilly(), self.folder, self.random)
        outline, level = self.found.lake
        self.ground = self.found.ground
        self.heights = self.ground.heights.copy()
        self.assertEqual(self.counted(), {})
        x, y = self.ground.centres()
        beside = shapely.contains_xy(outline.buffer(CELL), x, y) & checks.certain(self.found) & (self.ground.heights > level)
        self.heights[tuple(np.argwhere(beside)[0])] = level - 0.01 * INTERVAL
        self.assertEqual(self.counted(), {"lake": 1})

    def test_sheets_unlike_the_whole(self):
        self.found = plain_maps.sheets(hilly(), self.folder, self.random)
        self.found.ground.write(self.folder / "whole.tif")
        self.assertEqual(self.counted(), {})
        self.heights[self.inner(self.ground.heights % INTERVAL < INTERVAL / 2)] += 0.06 * INTERVAL
        self.assertEqual(self.counted(), {"sheets": 1})

    def test_coast(self):
        self.found = coast_maps.coast(hilly(), self.folder, self.random)
        truth = self.found.ground.heights
        self.heights = truth.copy()
        self.assertEqual(self.counted(), {})
        self.heights[tuple(np.argwhere(truth == 0)[0])] = 0.4 * INTERVAL
        self.assertEqual(self.counted().get("coast"), 1)
        land = tuple(np.argwhere((truth > 0) & (truth < INTERVAL / 2))[0])
        self.heights[land] = 0.0
        self.assertEqual(self.counted().get("coast"), 2)

    def streams(self):
        """A map with streams, and those of its ground as they would be used."""
        self.found = line_maps.streams(hilly(), self.folder, self.random)
        self.heights = self.found.ground.heights.copy()
        cells = flow.valleys(self.heights)
        self.write_streams([flow.on_map(line, self.found.ground.transform, self.heights) for line in cells])
        return max(cells, key=len)

    def write_streams(self, lines):
        (self.folder / "threads2").mkdir(exist_ok=True)
        path = self.folder / "threads2" / "diagnostics.gpkg"
        pyogrio.raw.write(path, shapely.to_wkb(np.array(lines, object)), [np.arange(len(lines))], ["number"], layer="streams",
                          geometry_type="LineString Z", crs=ground.CRS, driver="GPKG")  # fmt: skip

    def test_stream_whose_cells_rise(self):
        cells = self.streams()
        self.assertEqual(self.counted(), {})
        self.heights[tuple(cells[2])] = self.heights[tuple(cells[1])] + 0.01 * INTERVAL
        self.assertEqual(self.counted().get("rises"), 1)

    def test_stream_that_rises(self):
        cells = self.streams()
        heights = self.heights.copy()
        heights[tuple(cells[2])] = heights[tuple(cells[1])] + 0.01 * INTERVAL
        self.write_streams([flow.on_map(cells, self.found.ground.transform, heights)])
        self.assertEqual(self.counted(), {"rises": 1})

    def test_base(self):
        self.found = plain_maps.district(hilly(), self.folder, self.random)
        self.found.runs = [["dem", "--base-fade", 5 * CELL]]
        self.found.checks = {"base": checks.wrong_on_base}
        truth = self.found.ground
        cells = np.zeros(truth.heights.shape, bool)
        cells[:, :20] = True
        self.found.area = shapely.box(*(truth.box.bounds[:2]), truth.box.bounds[0] + 19 * CELL, truth.box.bounds[3])
        self.heights = np.where(cells, truth.heights, np.nan)
        # Beside a straight border, the difference fades by one factor from cell to cell.
        lift = 2.0 * INTERVAL * np.exp(-3.0 / 5.0 * np.maximum(np.arange(truth.heights.shape[1]) - 19, 0))
        self.write("base", truth.heights - 2.0 * INTERVAL)
        self.write("based", truth.heights - 2.0 * INTERVAL + lift)
        self.assertEqual(self.counted(), {})
        for cell, off in (((20, 5), 0.01), ((20, 22), 0.2), ((20, 50), 0.2), ((20, 51), np.nan)):
            changed = truth.heights - 2.0 * INTERVAL + lift
            changed[cell] += off * INTERVAL
            self.write("based", changed)
            self.assertEqual(self.counted(), {"base": 1}, (cell, off))

    def test_files_that_depend_on_threads(self):
        for threads, text in ((1, "a"), (2, "b")):
            (self.folder / f"threads{threads}").mkdir(exist_ok=True)
            (self.folder / f"threads{threads}" / "out.gpkg").write_text(text)
            (self.folder / f"threads{threads}" / "same.gpkg").write_text("a")
        self.assertEqual(counts.unlike_files(self.folder), 1)


class Maps(unittest.TestCase):
    def test_every_kind_is_made(self):
        for number, kind in enumerate(kinds.KINDS):
            with tempfile.TemporaryDirectory() as folder, self.subTest(kind.__name__):
                random = np.random.default_rng(number)
                found = kind(hilly(number), pathlib.Path(folder), random)
                self.assertIsInstance(found, maps.Map)
                for name in found.inputs:
                    self.assertGreater(len(checks.read_lines(pathlib.Path(folder) / name)[0]), 0)

    def test_ground_without_pits(self):
        heights = flow.filled(hilly().heights, 0.01)
        direction = flow.directions(heights)
        self.assertTrue((direction[1:-1, 1:-1] > 0).all())
        drained = flow.accumulation(heights, direction)
        self.assertEqual(drained[direction == 0].sum(), heights.size)


if __name__ == "__main__":
    unittest.main()
