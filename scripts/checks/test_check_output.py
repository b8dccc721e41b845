#!/usr/bin/env python3
"""Shows that check_output.py passes a sound output and catches every kind of broken one.

    .venv/bin/python scripts/checks/test_check_output.py

The sound output is made here, without tokosen: the real sample's own lines and lines between them, cut from its truth.
"""
import contextlib
import io
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

import contourpy
import numpy as np
import pyogrio
import rasterio
import shapely

import check_output

HERE = pathlib.Path(__file__).resolve().parent
SAMPLE = HERE.parents[1] / "samples" / "caryville_20m.gpkg"
TRUTH = HERE.parents[1] / "samples" / "caryville_20m_truth.tif"
FORMATS = {".gpkg": "GPKG", ".geojson": "GeoJSON", ".shp": "ESRI Shapefile"}


def area(p):
    q = p - p[0]
    return float(np.sum(q[:-1, 0] * q[1:, 1] - q[1:, 0] * q[:-1, 1]))


def record(elev, points, source):
    """A line of the output. With y falling from row to row, contourpy has higher ground on the right, as the output."""
    closed = bool((points[0] == points[-1]).all())
    return {"elev": float(elev), "points": points, "source": source, "is_index": elev % 100 == 0, "closed": closed,
            "depression": closed and area(points) > 0, "z": np.full(len(points), float(elev))}


def sound():
    """The lines of a sound output at 10 m and the frame that they end on."""
    with rasterio.open(TRUTH) as f:
        z, t = f.read(1).astype(float), f.transform
    x, y = t.c + t.a * (np.arange(z.shape[1]) + 0.5), t.f + t.e * (np.arange(z.shape[0]) + 0.5)
    frame = shapely.box(x[0], y[-1], x[-1], y[0])
    gen = contourpy.contour_generator(x=x, y=y, z=z)
    _, _, wkb, columns = pyogrio.raw.read(SAMPLE)
    out = [record(e, shapely.get_coordinates(g), "input") for g, e in zip(shapely.from_wkb(wkb), columns[0])]
    for level in np.arange(np.ceil(z.min() / 10) * 10, z.max(), 10):
        for p in gen.lines(level) if level % 20 else []:
            p = p[np.r_[True, (np.diff(p, axis=0) != 0).any(axis=1)]]
            if len(p) > 3 or (len(p) > 1 and (p[0] != p[-1]).any()):
                out.append(record(level, p, "interpolated"))
    return out, frame


def write(path, lines, layer="contours_10m"):
    flat = path.suffix == ".shp"
    geometry = [shapely.linestrings(r["points"] if flat else np.column_stack([r["points"], r["z"]])) for r in lines]
    names = ["elev", "source", "is_index", "depression", "closed"]
    columns = [np.array([r[n] for r in lines], dtype=object if n == "source" else None) for n in names]
    pyogrio.raw.write(path, geometry=shapely.to_wkb(geometry, output_dimension=2 if flat else 3), field_data=columns,
                      fields=names, geometry_type="LineString" if flat else "LineString Z", crs="EPSG:32616",
                      driver=FORMATS[path.suffix], layer=layer if path.suffix == ".gpkg" else None, append=path.exists(),
                      layer_options={"COORDINATE_PRECISION": 15} if path.suffix == ".geojson" else {})


class CheckOutput(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        cls.lines, frame = sound()
        cls.frame = cls.path / "frame.gpkg"
        pyogrio.raw.write(cls.frame, geometry=shapely.to_wkb([frame]), field_data=[], fields=[], geometry_type="Polygon",
                          crs="EPSG:32616", driver="GPKG")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def run_check(self, lines, *options, suffix=".gpkg", source=SAMPLE):
        path = self.path / f"{self.id().split('.')[-1]}{suffix}"
        path.unlink(missing_ok=True)
        write(path, lines)
        return self.run_on(path, *options, source=source)

    def run_on(self, path, *options, source=SAMPLE):
        # In this process: starting Python and its libraries anew takes longer than the check itself.
        arguments = ["check_output.py", source, path, "--frame", self.frame, *options]
        said = io.StringIO()
        with mock.patch.object(sys, "argv", [str(a) for a in arguments]), contextlib.redirect_stdout(said):
            status = check_output.main()
        self.said = said.getvalue()
        failed = [re.match(r"(attributes|input kept|crossings|simple|same level|z|ends|closed|turning|right side|dem range|dem side)",
                           line[23:]).group(1) for line in self.said.splitlines() if line.startswith("FAIL")]
        self.assertEqual(status, 1 if failed else 0, self.said)
        return failed

    def copy(self):
        return [dict(r, points=r["points"].copy(), z=r["z"].copy()) for r in self.lines]

    def pick(self, lines, source, closed=None, least=40):
        """A long line of the source, away from the others' reach of the edits below."""
        return next(r for r in lines if r["source"] == source and len(r["points"]) > least
                    and (closed is None or r["closed"] == closed))

    # Sound outputs.

    def test_sound_in_every_format(self):
        for suffix in FORMATS:
            self.assertEqual(self.run_check(self.lines, "--dem", TRUTH, suffix=suffix), [], self.said)

    def test_rotated_and_joined_lines_are_kept(self):
        lines = self.copy()
        ring = self.pick(lines, "input", closed=True)
        ring["points"] = np.vstack([ring["points"][7:-1], ring["points"][:8]])
        self.assertEqual(self.run_check(lines), [], self.said)

    def test_line_there_and_back(self):
        source = self.path / "there_and_back.gpkg"
        way = self.pick(self.lines, "input")["points"][:4] + [3.0, 4.0]
        inputs = [r for r in self.lines if r["source"] == "input"]
        both = [record(300, np.vstack([way, way[-2::-1]]), "input")]
        write(source, [{**r, "source": "interpolated"} for r in inputs + both])
        self.assertIn("input kept", self.run_check(self.lines, source=source))
        self.assertNotIn("input kept", self.run_check(self.lines + [record(300, way, "input")], source=source), self.said)

    def sampled(self, beside=0.0):
        lines = self.copy()
        for r in (r for r in lines if r["source"] == "input"):
            p = r["points"]
            middle = (p[:-1] + p[1:]) / 2 + [beside, 0]
            both = np.empty((2 * len(p) - 1, 2))
            both[::2], both[1::2] = p, middle
            r["points"], r["z"] = both, np.full(len(both), r["elev"])
        return lines

    def test_added_vertices(self):
        self.assertEqual(self.run_check(self.sampled(), "--sampled"), [], self.said)
        self.assertIn("input kept", self.run_check(self.sampled()))
        self.assertIn("input kept", self.run_check(self.sampled(beside=0.01), "--sampled"))
        lines = self.sampled()
        r = self.pick(lines, "input")
        r["points"], r["z"] = np.delete(r["points"], 12, axis=0), np.delete(r["z"], 12)
        self.assertIn("input kept", self.run_check(lines, "--sampled"))

    def test_layers_are_checked_one_by_one(self):
        path = self.path / "layers.gpkg"
        write(path, self.lines, "contours_10m")
        write(path, [r for r in self.lines if r["source"] == "input" and r["elev"] != 400], "contours_20m")
        self.assertEqual(self.run_on(path), ["input kept"])
        self.assertRegex(self.said, r"FAIL  contours_20m +input kept")

    def clipped(self):
        """The sound lines cut to a polygon with a bay and a hole, and the file of the polygon."""
        x0, y0, x1, y1 = shapely.total_bounds([shapely.linestrings(r["points"]) for r in self.lines])
        at = lambda *uv: [(x0 + u * (x1 - x0), y0 + v * (y1 - y0)) for u, v in uv]
        polygon = shapely.Polygon(at((0.1, 0.1), (0.9, 0.2), (0.8, 0.9), (0.5, 0.6), (0.2, 0.8)),
                                  [at((0.4, 0.3), (0.4, 0.4), (0.6, 0.4), (0.6, 0.3))])
        file = self.path / "polygon.gpkg"
        if not file.exists():
            pyogrio.raw.write(file, geometry=shapely.to_wkb([polygon]), field_data=[], fields=[], geometry_type="Polygon",
                              crs="EPSG:32616", driver="GPKG")
        lines = []
        for r in self.lines:
            cut = shapely.intersection(shapely.linestrings(r["points"]), polygon)
            for part in shapely.get_parts(shapely.line_merge(cut)):
                points = shapely.get_coordinates(part)
                # Merging may turn a line round: the old direction is that of any two successive old vertices.
                place = {tuple(p): i for i, p in enumerate(r["points"][:-1])}
                old = [place[tuple(p)] for p in points if tuple(p) in place]
                steps = np.diff(old)
                if len(steps) and np.sum(steps == -1) > np.sum(steps == 1):
                    points = points[::-1]
                if len(points) > 1 and (r["source"] == "input" or len(old) > 2):
                    lines.append(record(r["elev"], points, r["source"]))
        return lines, ["--clip", "--frame", file]

    def test_output_cut_to_a_polygon(self):
        lines, options = self.clipped()
        self.assertEqual([f for f in self.run_check(lines, *options) if f != "right side"], [], self.said)

    # Broken outputs.

    def test_cut_line_that_lost_its_end(self):
        lines, options = self.clipped()
        r = next(r for r in lines if r["source"] == "input" and not r["closed"] and len(r["points"]) > 40)
        r["points"], r["z"] = r["points"][:-3], r["z"][:-3]
        self.assertIn("input kept", self.run_check(lines, *options))

    def test_line_beyond_the_polygon(self):
        lines, options = self.clipped()
        lines.append(next(r for r in self.lines if r["source"] == "input" and not r["closed"]))
        self.assertIn("input kept", self.run_check(lines, *options))

    def test_cut_line_that_ends_beside_its_segment(self):
        lines, options = self.clipped()
        r = next(r for r in lines if r["source"] == "input" and not r["closed"] and len(r["points"]) > 40)
        r["points"] = r["points"].copy()
        r["points"][0] += 0.5 * (r["points"][1] - r["points"][0])[::-1] * [1, -1]
        self.assertIn("input kept", self.run_check(lines, *options))

    def test_lost_vertex(self):
        lines = self.copy()
        r = self.pick(lines, "input")
        r["points"], r["z"] = np.delete(r["points"], 11, axis=0), np.delete(r["z"], 11)
        self.assertIn("input kept", self.run_check(lines))
        self.assertIn("2 missing, 1 vertices missing, 1 segments new", self.said)

    def test_vertex_moved_by_one_bit(self):
        lines = self.copy()
        r = self.pick(lines, "input")
        r["points"][11, 0] = np.nextafter(r["points"][11, 0], np.inf)
        self.assertEqual(self.run_check(lines), ["input kept"])

    def test_lost_input_line(self):
        lines = self.copy()
        lines.remove(self.pick(lines, "input"))
        self.assertIn("input kept", self.run_check(lines))

    def test_input_line_at_another_level(self):
        lines = self.copy()
        r = self.pick(lines, "input")
        r["elev"] += 1
        r["z"] += 1
        self.assertIn("input kept", self.run_check(lines))

    def test_input_line_in_pieces(self):
        lines = self.copy()
        r = self.pick(lines, "input", closed=False)
        rest = dict(r, points=r["points"][20:], z=r["z"][20:])
        r["points"], r["z"] = r["points"][:21], r["z"][:21]
        self.assertEqual(self.run_check(lines + [rest]), ["input kept"])
        self.assertEqual(self.run_check(lines + [rest], "--cut", "1"), [])

    def test_input_line_called_interpolated(self):
        lines = self.copy()
        self.pick(lines, "input", closed=True)["source"] = "interpolated"
        self.assertEqual(self.run_check(lines), ["input kept"])

    def test_crossing(self):
        lines = self.copy()
        r = self.pick(lines, "interpolated")
        r["points"][20] += (400.0, 300.0)
        self.assertIn("crossings", self.run_check(lines))

    def test_touch_in_a_vertex(self):
        lines = self.copy()
        r = self.pick(lines, "interpolated")
        near = min((q for q in lines if q["elev"] != r["elev"]),
                   key=lambda q: np.hypot(*(q["points"] - r["points"][20]).T).min())
        r["points"][20] = near["points"][np.hypot(*(near["points"] - r["points"][20]).T).argmin()]
        self.assertIn("crossings", self.run_check(lines))

    def test_line_through_itself(self):
        lines = self.copy()
        r = self.pick(lines, "interpolated")
        r["points"][[20, 21]] = r["points"][[21, 20]]
        self.assertIn("simple", self.run_check(lines))

    def test_lines_of_one_level_cross(self):
        lines = self.copy()
        r = self.pick(lines, "interpolated", closed=True)
        lines.append(dict(r, points=r["points"] + (1.0, 1.0)))
        self.assertIn("same level", self.run_check(lines))
        lines[-1] = dict(r)
        self.assertIn("same level", self.run_check(lines))

    def test_wrong_z(self):
        lines = self.copy()
        self.pick(lines, "interpolated")["z"][5] += 1e-9
        self.assertEqual(self.run_check(lines), ["z"])

    def test_end_in_the_open(self):
        lines = self.copy()
        r = self.pick(lines, "interpolated", closed=False)
        r["points"], r["z"] = r["points"][:-1], r["z"][:-1]
        self.assertEqual(self.run_check(lines), ["ends"])

    def test_end_beside_the_frame(self):
        lines = self.copy()
        r = self.pick(lines, "interpolated", closed=False)
        r["points"][-1] += (r["points"][-2] - r["points"][-1]) * 1e-5
        self.assertEqual(self.run_check(lines), ["ends"])

    def test_flags(self):
        lines = self.copy()
        self.pick(lines, "interpolated", closed=True)["closed"] = False
        self.assertEqual(self.run_check(lines), ["closed"])
        lines = self.copy()
        self.pick(lines, "interpolated", closed=True)["depression"] ^= True
        self.assertEqual(self.run_check(lines), ["turning"])
        lines = self.copy()
        self.pick(lines, "interpolated", closed=False)["depression"] = True
        self.assertEqual(self.run_check(lines), ["turning"])
        lines = self.copy()
        self.pick(lines, "input")["is_index"] ^= True
        self.assertEqual(self.run_check(lines), ["attributes"])
        lines = self.copy()
        self.pick(lines, "input")["source"] = "guess"
        self.assertIn("attributes", self.run_check(lines))

    def test_repeated_point(self):
        lines = self.copy()
        r = self.pick(lines, "interpolated")
        r["points"], r["z"] = np.insert(r["points"], 5, r["points"][5], axis=0), np.insert(r["z"], 5, r["z"][5])
        self.assertEqual(self.run_check(lines), ["attributes"])

    def test_reversed_line(self):
        lines = self.copy()
        r = self.pick(lines, "interpolated", closed=False)
        r["points"] = r["points"][::-1]
        self.assertEqual(self.run_check(lines), ["right side"])

    def test_all_lines_reversed(self):
        lines = self.copy()
        for r in lines:
            r["points"] = r["points"][::-1]
        self.assertEqual(self.run_check(lines, "--dem", TRUTH), ["turning", "right side", "dem side"])

    def test_dem_out_of_range(self):
        path = self.path / "spike.tif"
        with rasterio.open(TRUTH) as f:
            z, profile = f.read(1), f.profile
        z[50, 60] = 5000
        with rasterio.open(path, "w", **profile) as f:
            f.write(z, 1)
        self.assertEqual(self.run_check(self.lines, "--dem", path), ["dem range"])
        self.assertIn("row 50, column 60", self.said)


class Unusable(unittest.TestCase):
    def test_no_file(self):
        done = subprocess.run([sys.executable, HERE / "check_output.py", SAMPLE, "nowhere.gpkg"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("nowhere.gpkg", done.stderr)

    def test_not_an_output(self):
        done = subprocess.run([sys.executable, HERE / "check_output.py", SAMPLE, SAMPLE], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)


if __name__ == "__main__":
    unittest.main()
