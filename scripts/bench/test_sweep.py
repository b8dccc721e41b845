#!/usr/bin/env python3
"""Shows that sweep.py tries the values that are named and measures what they do.

    test_sweep.py                     # a made-up program in the place of tokosen
"""
import contextlib
import io
import os
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

import numpy as np
import rasterio

import sweep

CELL = 10.0

# Lists its numbers; makes height maps that are off by the number `a.off`, and standard errors of `errors.b`.
PROGRAM = """#!{python}
import sys
import rasterio
values = {{"a.off": 2.0, "a.rounds": 3, "errors.b": 1.0, "nodes.c": 5.0}}
words = sys.argv[1:]
for word in [words[i + 1] for i, w in enumerate(words) if w == "--tune"]:
    name, _, value = word.partition("=")
    if name not in values:
        sys.exit("tokosen: no tuned number is called so; the tuned numbers are:\\n"
                 + "\\n".join(f"{{n}} = {{v}}" for n, v in values.items()))
    values[name] = float(value)
if values["a.off"] > 100:
    sys.exit("that is too much")
with rasterio.open(words[words.index("--like") + 1]) as truth:
    heights, profile = truth.read(1), truth.profile
bands = [heights + values["a.off"]] + ([0 * heights + values["errors.b"]] if "--uncertainty" in words else [])
with rasterio.open(words[words.index("-o") + 1], "w", **(profile | {{"count": len(bands)}})) as out:
    for number, values in enumerate(bands, 1):
        out.write(values, number)
"""


class Sweep(unittest.TestCase):
    def setUp(self):
        held = tempfile.TemporaryDirectory()
        self.addCleanup(held.cleanup)
        self.folder = pathlib.Path(held.name)
        self.program = self.folder / "tokosen"
        self.program.write_text(PROGRAM.format(python=sys.executable))
        self.program.chmod(0o755)
        self.truth = self.folder / "truth.tif"
        row, column = np.mgrid[:60, :80]
        ground = (100 + 3.0 * np.sin(row / 5) * np.cos(column / 7)).astype("float32")
        transform = rasterio.transform.from_origin(0, 0, CELL, CELL)
        with rasterio.open(self.truth, "w", driver="GTiff", dtype="float32", count=1, height=60, width=80, transform=transform,
                           crs="EPSG:32654") as file:
            file.write(ground, 1)
        self.lines = self.folder / "lines.gpkg"
        patch = mock.patch.object(sweep, "interval", lambda lines: 2.0)
        patch.start()
        self.addCleanup(patch.stop)

    def main(self, *words):
        with mock.patch.object(sys, "argv", ["sweep.py", *words, "--program", str(self.program)]), \
                contextlib.redirect_stdout(io.StringIO()) as said:
            sweep.main()
        return [[cell.strip() for cell in line.strip("|").split("|")] for line in said.getvalue().splitlines() if line]

    def place(self):
        return f"{self.lines}:{self.truth}"

    def test_values_of_counts_are_counts(self):
        self.assertEqual(sweep.halved_and_doubled("0.7"), ["0.35", "1.4"])
        self.assertEqual(sweep.halved_and_doubled("7"), ["3", "14"])
        self.assertEqual(sweep.halved_and_doubled("1"), ["0", "2"])
        self.assertEqual(sweep.halved_and_doubled("0"), ["1"])

    def test_one_number(self):
        _, _, default, double = self.main("a.off=4", self.place())
        self.assertEqual(default[:3], ["default", "lines", "1.0000"])
        self.assertEqual(double[:4], ["a.off=4", "lines", "2.0000", "+100.00 %"])

    def test_two_numbers_with_each_other(self):
        found = self.main("a.off=1,4", "errors.b=0.5,8", self.place())[3:]
        self.assertEqual([row[0] for row in found], [f"a.off={a} errors.b={b}" for a in (1, 4) for b in (0.5, 8)])
        self.assertEqual([row[6] for row in found], ["0.0", "100.0", "0.0", "100.0"])

    def test_mean_over_maps(self):
        other = self.folder / "other.gpkg"
        found = self.main("a.off=1", self.place(), f"{other}:{self.truth}")
        self.assertEqual(found[-1][:4], ["a.off=1", "mean", "", "-50.00 %"])

    def test_all_numbers_by_effect(self):
        found = self.main("--all", self.place())
        self.assertEqual([row[0] for row in found], ["number", "-" * 10, "a.off", "a.rounds", "number", "-" * 10, "errors.b"])
        self.assertEqual(found[2][1:], ["1.0", "-50.00 %", found[2][3], "4.0", "+100.00 %", found[2][6]])

    def test_failures_are_told(self):
        self.assertIn("that is too much", " ".join(self.main("a.off=101", self.place())[-1]))
        with self.assertRaisesRegex(SystemExit, "a.rounds = 3"):
            self.main("a.missing=1", self.place())

    def test_results_are_kept(self):
        kept = self.folder / "kept.json"
        first = self.main("a.off=4", self.place(), "--keep", str(kept))
        with mock.patch.object(sweep, "run", side_effect=sweep.run) as measured:
            self.assertEqual(self.main("a.off=4", self.place(), "--keep", str(kept)), first)
        self.assertEqual(measured.call_count, 1, "only the default values, whose height map the others are compared with")
        os.utime(self.program, (0, 0))
        self.assertEqual(self.main("a.off=4", self.place(), "--keep", str(kept)), first)


if __name__ == "__main__":
    unittest.main()
