#!/usr/bin/env python3
"""Shows that check_formats.py notices each kind of difference.

    .venv/bin/python scripts/checks/test_check_formats.py
"""
import unittest

import numpy
import rasterio
import shapely

import check_formats


def features(system="EPSG:6677", moved=0.0, elev=10.0, count=2, kind="line", source="input", layer="CONTOUR-INPUT"):
    """What Features would read, without a file."""
    made = check_formats.Features.__new__(check_formats.Features)
    made.system = system
    shapes = []
    for i in range(count):
        ring = [(i, 0, elev), (i + 0.5, numpy.nextafter(0.0, 1) if moved else 0.0, elev), (i, 1, elev), (i, 0, elev)]
        shapes.append(shapely.LineString(ring) if kind == "line" else shapely.force_2d(shapely.Polygon(ring)))
    made.shapes = numpy.array(shapes)
    made.attributes = [{"elev": elev, "source": source, "is_index": 0.0, "Layer": layer} for _ in shapes]
    made.in_window = lambda window: count
    return made


class Vectors(unittest.TestCase):
    def differences(self, found, has_attributes=True, reference=None):
        return check_formats.compare_vectors(reference or features(), found, has_attributes, has_attributes)

    def test_the_same(self):
        self.assertEqual(self.differences(features()), [])
        self.assertEqual(self.differences(features(), has_attributes=False), [])

    def test_system(self):
        self.assertIn("system", self.differences(features(system="EPSG:6678"))[0])
        self.assertIn("system", self.differences(features(system=None))[0])

    def test_last_bit_of_a_coordinate(self):
        self.assertIn("2 features with other coordinates", self.differences(features(moved=1))[0])
        self.assertIn("2 with other coordinates", self.differences(features(moved=1), has_attributes=False)[0])

    def test_attribute(self):
        other = features()
        other.attributes[1]["elev"] = numpy.nextafter(10.0, 11.0)
        self.assertIn("0 features with other coordinates, 1 with other attributes", self.differences(other)[0])

    def test_height(self):
        other = features()
        other.shapes = shapely.force_3d(shapely.force_2d(other.shapes), 11.0)
        self.assertTrue(self.differences(other))
        self.assertTrue(self.differences(other, has_attributes=False))

    def test_count(self):
        self.assertIn("1 features", self.differences(features(count=1)))
        self.assertIn("3 lines, 0 with other coordinates", self.differences(features(count=3), has_attributes=False))

    def test_layer_of_a_drawing(self):
        self.assertIn("other layers", self.differences(features(layer="CONTOUR"), has_attributes=False))

    def test_rings_may_turn(self):
        polygons, lines = features(kind="area"), features()
        del polygons.attributes[0]["source"]
        lines.shapes = shapely.force_3d(shapely.reverse(shapely.force_2d(lines.shapes)), 0.0)
        self.assertEqual(self.differences(lines, has_attributes=False, reference=polygons), [])
        lines.shapes = lines.shapes[:1]
        self.assertTrue(self.differences(lines, has_attributes=False, reference=polygons))


class Rasters(unittest.TestCase):
    def setUp(self):
        self.values = numpy.arange(12.0).reshape(3, 4)
        self.values[1, 1] = numpy.nan
        self.placement = rasterio.Affine(20, 0, 1000, 0, -20, 2000)

    def differences(self, values, placement=None, system="EPSG:6677", tolerance=0.0, step=1.0):
        reference = (self.values, self.placement, "EPSG:6677", 1.0)
        found = (values, placement or self.placement, system, step)
        return check_formats.compare_rasters(reference, found, True, tolerance)

    def test_heights(self):
        self.assertEqual(self.differences(self.values), [])
        self.assertIn("off by", self.differences(self.values + 1e-6)[0])
        self.assertEqual(self.differences(self.values + 0.04, tolerance="step", step=0.1), [])
        self.assertTrue(self.differences(self.values + 0.06, tolerance="step", step=0.1))

    def test_cells_without_data(self):
        self.assertTrue(self.differences(numpy.nan_to_num(self.values)))
        self.assertTrue(self.differences(self.values[:2]))

    def test_placement_and_system(self):
        self.assertTrue(self.differences(self.values, placement=self.placement @ rasterio.Affine.translation(1e-6, 0)))
        self.assertTrue(self.differences(self.values, system="EPSG:6678"))
        self.assertTrue(self.differences(self.values, system=None))

    def test_lists_of_cells(self):
        self.values[0], self.values[:, 0] = numpy.nan, numpy.nan
        reference = (self.values, self.placement, None, 1.0)
        for columns, rows, same in [(1, 1, True), (2, 1, False), (1, 0, False), (1.1, 1, False)]:
            moved = self.placement @ rasterio.Affine.translation(columns, rows)
            listed = (self.values[1:, 1:], moved, None, 1.0)
            laid = check_formats.laid_out(listed, reference)
            self.assertEqual(check_formats.compare_rasters(reference, laid, False, 0.0) == [], same)


if __name__ == "__main__":
    unittest.main()
