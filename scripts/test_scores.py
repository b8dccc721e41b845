#!/usr/bin/env python3
"""Shows that score_contours.py and score_dem.py measure what they say, on ground whose figures are known beforehand.

    .venv/bin/python scripts/test_scores.py
"""
import unittest

import numpy as np
import rasterio
import shapely

import score_contours
import score_dem
import terrain

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
