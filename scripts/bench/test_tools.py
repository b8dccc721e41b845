#!/usr/bin/env python3
"""Shows that tools.py measures what it says and stops what takes too long, and that no tool's height map is shifted.

    test_tools.py                     # with the program, if it is built, and the other tools that are installed
"""
import pathlib
import sys
import tempfile
import time
import unittest

import numpy as np
import rasterio
import shapely

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))  # the modules that scripts share
import benchmark_speed
import terrain
import tools


class Run(unittest.TestCase):
    def setUp(self):
        held = tempfile.TemporaryDirectory()
        self.addCleanup(held.cleanup)
        self.folder = pathlib.Path(held.name)

    def run_python(self, code, limit=60):
        return tools.run([sys.executable, "-c", code], self.folder, limit)

    def test_memory_and_time(self):
        told = self.run_python("import time; held = bytes(200_000_000); held = bytearray(held); time.sleep(0.5)")
        self.assertGreater(told["peak_bytes"], 190e6)
        self.assertGreater(told["seconds"], 0.5)
        self.assertLess(told["cpu_seconds"], told["seconds"])
        small = self.run_python("pass")
        self.assertLess(small["peak_bytes"], 100e6)

    def test_memory_of_a_child(self):
        told = tools.run(tools.shell(f"{sys.executable} -c 'bytearray(b\"1\" * 200_000_000)' | cat"), self.folder, 60)
        self.assertGreater(told["peak_bytes"], 190e6)

    def test_limit_stops_all_processes(self):
        start = time.monotonic()
        told = tools.run(tools.shell("sleep 60 & echo $! > child", "wait"), self.folder, 0.5)
        self.assertEqual(told, {"over": 0.5})
        self.assertLess(time.monotonic() - start, 10)
        child = int((self.folder / "child").read_text())
        for _ in range(50):
            if not alive(child):
                return
            time.sleep(0.1)
        self.fail("a process of the program goes on")

    def test_failures(self):
        self.assertEqual(self.run_python("import sys; sys.exit('no luck')"), {"failed": "exit status 1: no luck"})
        self.assertIn("failed", tools.run(["/no/such/program"], self.folder, 60))
        self.assertEqual(tools.run(tools.shell("false | true"), self.folder, 60), {"failed": "exit status 1: it said nothing"})


def alive(pid):
    """Whether a process runs; one that ended and that nobody has waited for does not."""
    try:
        return "\nState:\tZ" not in pathlib.Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return False


class Grid(unittest.TestCase):
    def test_covers_the_lines(self):
        transform, shape = benchmark_speed.grid_over(np.array([shapely.linestrings([[-3, 1], [17, 29]])]), 10)
        self.assertEqual((shape, tuple(transform)[:6]), ((3, 3), (10, 0, -10, 0, -10, 30)))


class Places(unittest.TestCase):
    """Contours of a slope: what a tool makes of them is that slope, unless it is shifted."""

    CELL, EAST, SOUTH, INTERVAL = 10.0, 0.3, 0.2, 5.0

    def test_no_tool_is_shifted(self):
        # An even and an odd number of cells; neither suits GMT's multigrid, which then works on a larger grid.
        shape, transform = (51, 58), rasterio.transform.from_origin(1000, 5000, self.CELL, self.CELL)
        row, column = np.mgrid[0 : shape[0], 0 : shape[1]]
        truth = 100 + self.CELL * (self.EAST * column + self.SOUTH * row)
        lines, levels = terrain.contours(truth, transform, self.INTERVAL)
        # A contour of a slope has two vertices; the tools that see vertices alone need more.
        lines = shapely.force_3d(shapely.segmentize(lines, self.CELL / 2), levels)
        with tempfile.TemporaryDirectory() as held:
            folder = pathlib.Path(held)
            inputs = tools.write_inputs(folder, lines, "EPSG:32616", transform, shape)
            binary = tools.BINARY if tools.BINARY.exists() else tools.QUICK_BINARY
            present, _ = tools.chosen(tools.tools(folder, inputs, str(binary)), None)
            if not present:
                self.skipTest("no tool is installed")
            for tool in present:
                with self.subTest(tool.name):
                    self.assertIn("seconds", tools.prepare(tool, folder, 120))
                    self.assertIn("seconds", tools.interpolate(tool, folder, 120))
                    self.assertIn("seconds", tools.interpolate(tool, folder, 120))  # a second run replaces the first
                    self.assertIn("seconds", tools.finish(tool, folder, 120))
                    heights, placed = terrain.read_dem(tool.output)
                    self.assertEqual(heights.shape, shape)
                    np.testing.assert_allclose(placed[:6], transform[:6])
                    off = (heights - truth)[10:-10, 10:-10]
                    # Half a cell to the east alone is 1.5 m, to the south 1 m.
                    self.assertLess(abs(np.mean(off)), 0.3)


class Table(unittest.TestCase):
    def test_columns_line_up(self):
        self.assertEqual(tools.table(["", "wall"], [["a", "1 s"], ["longer", "12.5 s"]]).splitlines(), [
            "|        |   wall |", "|--------|-------:|", "| a      |    1 s |", "| longer | 12.5 s |"])


if __name__ == "__main__":
    unittest.main()
