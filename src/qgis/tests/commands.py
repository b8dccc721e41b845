"""Every tool, run by qgis_process, writes what the command writes. Started by run.py."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

from installed import CONTOURS, HEIGHTS, NESTED, PLUGINS, PROGRAMS, TOKOSEN, command, install, make_zip
from outputs import content, count

PROCESS = os.environ["TEST_QGIS_PROCESS"]


def setUpModule():
    with tempfile.TemporaryDirectory() as folder:
        install(make_zip(pathlib.Path(folder) / "plugin.zip"))
    subprocess.run([PROCESS, "plugins", "enable", "tokosen"], check=True, capture_output=True)


class Case(unittest.TestCase):
    maxDiff = 1000

    def setUp(self):
        held = tempfile.TemporaryDirectory()
        self.addCleanup(held.cleanup)
        self.folder = pathlib.Path(held.name)

    def run_tool(self, tool, path=PROGRAMS, **parameters):
        values = [f"--{name}={value}" for name, value in parameters.items()]
        environment = {**os.environ, "PATH": os.pathsep.join([path, os.environ["PATH"]])}
        return subprocess.run(
            [PROCESS, "--json", "run", f"tokosen:{tool}", *values], env=environment, capture_output=True, text=True
        )

    def results(self, tool, **parameters):
        done = self.run_tool(tool, **parameters)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return json.loads(done.stdout)["results"]

    def error(self, tool, **parameters):
        done = self.run_tool(tool, **parameters)
        self.assertNotEqual(done.returncode, 0)
        return done.stderr

    def assertSameOutput(self, path, *arguments):
        """The output equals that of the command: `arguments`, and the flag of the output at the end."""
        expected = self.folder / f"expected{path.suffix}"
        command(*arguments, expected)
        self.assertEqual(content(path), content(expected))
        expected.unlink()


class Tools(Case):
    def test_all_tools_are_there(self):
        listed = subprocess.run([PROCESS, "list"], capture_output=True, text=True).stdout
        verbs = subprocess.run([TOKOSEN, "--help"], capture_output=True, text=True).stdout
        verbs = set(re.findall(r"^  ([a-z]+) ", verbs.split("Commands:")[1].split("Options:")[0], re.MULTILINE))
        # The steps of a map in tiles are for programs that run them on many machines.
        self.assertEqual(set(re.findall(r"tokosen:(\w+)", listed)), verbs - {"help", "plan", "work", "join"})

    def test_densify(self):
        made, diagnostics = self.folder / "made.gpkg", self.folder / "diagnostics.gpkg"
        box = "746000,749000,4017000,4020000 [EPSG:32616]"
        results = self.results(
            "densify", INPUT=CONTOURS, INTERVAL=7.5, INDEX=4, BASE_LEVEL=2.5, EXTENT=box, LABELS=True, UNCERTAINTY=True,
            OUTPUT=made, DIAGNOSTICS=diagnostics,
        )
        self.assertEqual(results["OUTPUT"], f"{made}|layername=contours_7.5m")
        self.assertEqual(results["DIAGNOSTICS"], f"{diagnostics}|layername=conflicts")
        self.assertGreater(count(made), 100)
        options = [CONTOURS, "-i", "7.5", "--index", "4", "--base-level", "2.5", "--labels", "--uncertainty"]
        options += ["--extent", "746000,4017000,749000,4020000", "--extent-crs", "EPSG:32616"]
        self.assertSameOutput(made, "densify", *options, "-o")
        self.assertSameOutput(diagnostics, "densify", *options, "-o", self.folder / "other.gpkg", "--diagnostics")

    def test_densify_writes_single_levels_in_feet(self):
        made = self.folder / "made.geojson"
        self.results("densify", INPUT=NESTED, LEVELS="331.5,350", TO_UNIT=1, OUTPUT=made)
        self.assertSameOutput(made, "densify", NESTED, "--levels", "331.5,350", "--to-unit", "ft", "-o")

    def test_a_geopackage_keeps_its_layers(self):
        made = self.folder / "made.gpkg"
        self.results("densify", INPUT=NESTED, INTERVAL=5, OUTPUT=made)
        results = self.results("densify", INPUT=NESTED, INTERVAL=2, OUTPUT=made)
        self.assertEqual(results["OUTPUT"], f"{made}|layername=contours_2m")
        self.assertEqual(set(content(made)), {"contours_5m", "contours_2m"})

    def test_files_of_others_are_replaced(self):
        made = self.folder / "made.geojson"
        made.write_text('{"type": "FeatureCollection", "features": []}')
        self.results("densify", INPUT=NESTED, INTERVAL=5, OUTPUT=made)
        self.assertSameOutput(made, "densify", NESTED, "-i", "5", "-o")

    def test_dem(self):
        made, picture = self.folder / "made.tif", self.folder / "picture.png"
        results = self.results("dem", INPUT=CONTOURS, CELL=40, UNCERTAINTY=True, OUTPUT=made, PREVIEW=picture)
        self.assertEqual(results, {"OUTPUT": str(made), "PREVIEW": str(picture)})
        self.assertSameOutput(made, "dem", CONTOURS, "--cell", "40", "--uncertainty", "-o")
        self.assertSameOutput(picture, "dem", CONTOURS, "--cell", "40", "-o", self.folder / "other.tif", "--preview")

    def test_dem_on_the_grid_of_another_one(self):
        made = self.folder / "made.tif"
        self.results("dem", INPUT=CONTOURS, LIKE=HEIGHTS, SURFACE=1, REPAIR=2, OUTPUT=made)
        options = ["--like", HEIGHTS, "--surface", "skeleton", "--repair", "all"]
        self.assertSameOutput(made, "dem", CONTOURS, *options, "-o")

    def test_dem_in_another_system_with_the_ground_around(self):
        made = self.folder / "made.asc"
        self.results("dem", INPUT=CONTOURS, CELL=90, TO_CRS="EPSG:3857", BASE=HEIGHTS, FRAME=2, DRAIN=1, OUTPUT=made)
        options = ["--cell", "90", "--to-crs", "EPSG:3857", "--base", HEIGHTS, "--frame", "bbox", "--drain", "none"]
        self.assertSameOutput(made, "dem", CONTOURS, *options, "-o")

    def test_map_tiles(self):
        lines, terrain, page = (self.folder / name for name in ("lines.pmtiles", "terrain.mbtiles", "index.html"))
        zooms = {"INTERVAL": 10, "ZOOMS": "11:50,13:10", "ATTRIBUTION": "A & B"}
        results = self.results("densify", INPUT=CONTOURS, **zooms, OUTPUT=lines, VIEWER=page)
        self.assertEqual(results, {"OUTPUT": str(lines), "VIEWER": str(page)})
        self.assertIn("lines.pmtiles", page.read_text())
        expected = self.folder / "other" / "lines.pmtiles"
        expected.parent.mkdir()
        command("densify", CONTOURS, "-i", "10", "--zooms", "11:50,13:10", "--attribution", "A & B", "-o", expected)
        self.assertEqual(lines.read_bytes(), expected.read_bytes())
        self.results("dem", INPUT=CONTOURS, MAX_ZOOM=12, TILE_SIZE=1, TILE_IMAGE=1, PNG_ENCODING=2, OUTPUT=terrain)
        expected = self.folder / "other" / "terrain.mbtiles"
        options = ["--max-zoom", "12", "--tile-size", "256", "--tile-image", "webp", "--png-encoding", "mapbox"]
        command("dem", CONTOURS, *options, "-o", expected)
        self.assertEqual(terrain.read_bytes(), expected.read_bytes())

    def test_check(self):
        faulty = self.folder / "faulty.geojson"
        map_ = json.loads(NESTED.read_text())
        map_["features"][3]["properties"]["elev"] += 30
        map_["features"].append(map_["features"][0])
        faulty.write_text(json.dumps(map_))
        findings, repaired = self.folder / "findings.gpkg", self.folder / "repaired.gpkg"
        results = self.results("check", INPUT=faulty, FINDINGS=findings, REPAIRED=repaired, REPAIR=1)
        self.assertEqual(
            results, {"FINDINGS": f"{findings}|layername=findings", "REPAIRED": f"{repaired}|layername=contours"}
        )
        self.assertGreaterEqual(count(findings), 2)
        self.assertSameOutput(findings, "check", faulty, "-o")
        self.assertSameOutput(repaired, "check", faulty, "--repair", "all", "-o")

    def test_compare(self):
        made, report, on_paper = self.folder / "made.tif", self.folder / "report.html", self.folder / "map.pdf"
        self.results("compare", A=CONTOURS, B=HEIGHTS, SIGMA=2, OUTPUT=made, REPORT=report, PREVIEW=on_paper)
        self.assertSameOutput(made, "compare", CONTOURS, HEIGHTS, "--sigma", "2", "-o")
        self.assertIn("<html", report.read_text()[:1000])
        self.assertEqual(on_paper.read_bytes()[:4], b"%PDF")

    def test_profile(self):
        made, picture, line = self.folder / "made.csv", self.folder / "made.svg", self.folder / "line.geojson"
        ends = [[746000, 4018000], [748000, 4019000]]
        system = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32616"}}
        feature = {"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": ends}}
        line.write_text(json.dumps({"type": "FeatureCollection", "crs": system, "features": [feature]}))
        self.results("profile", A=HEIGHTS, B=CONTOURS, LINE=line, STEP=50, OUTPUT=made, PICTURE=picture)
        self.assertSameOutput(made, "profile", HEIGHTS, CONTOURS, "--line", line, "--step", "50", "-o")
        self.assertIn("<svg", picture.read_text()[:1000])

    def test_volume(self):
        made = self.folder / "made.csv"
        self.results("volume", A=HEIGHTS, LEVELS="320:340:5", OUTPUT=made)
        self.assertSameOutput(made, "volume", HEIGHTS, "--levels", "320:340:5", "-o")

    def test_derive_from_a_height_map(self):
        slope, steep = self.folder / "slope.tif", self.folder / "steep.gpkg"
        water, shade = self.folder / "catchments.gpkg", self.folder / "shade.tif"
        self.results(
            "derive", INPUT=HEIGHTS, SLOPE=slope, STEEP=steep, STEEP_ANGLE=25, CATCHMENTS=water, HILLSHADE=shade, AZIMUTH=300
        )
        self.assertSameOutput(slope, "derive", HEIGHTS, "--slope")
        self.assertSameOutput(steep, "derive", HEIGHTS, "--steep-angle", "25", "--steep")
        self.assertSameOutput(water, "derive", HEIGHTS, "--catchments")
        self.assertSameOutput(shade, "derive", HEIGHTS, "--azimuth", "300", "--hillshade")
        self.assertGreater(count(steep), 10)

    def test_flood_in_bands_of_depth(self):
        made = self.folder / "made.gpkg"
        self.results("derive", INPUT=HEIGHTS, FLOOD_LEVEL="350", FLOOD_BANDS="1,5", FLOOD_AREAS=made, SLOPE=self.folder / "slope.tif")
        self.assertSameOutput(made, "derive", HEIGHTS, "--flood-level", "350", "--flood-bands", "1,5", "--flood")
        self.assertGreater(count(made), 2)

    def test_derive_from_contours(self):
        aspect, direction = self.folder / "aspect.tif", self.folder / "direction.tif"
        flow, slope = self.folder / "flow.tif", self.folder / "slope.tif"
        self.results(
            "derive", INPUT=CONTOURS, CELL=50, SLOPE=slope, ASPECT=aspect, FLOW_DIRECTION=direction, FLOW_ACCUMULATION=flow
        )
        for flag, path in (("slope", slope), ("aspect", aspect), ("flow-direction", direction), ("flow-accumulation", flow)):
            self.assertSameOutput(path, "derive", CONTOURS, "--cell", "50", f"--{flag}")

    def test_regions(self):
        made = self.folder / "made.gpkg"
        self.assertEqual(self.results("regions", INPUT=CONTOURS, OUTPUT=made)["OUTPUT"], f"{made}|layername=regions")
        self.assertSameOutput(made, "regions", CONTOURS, "-o")

    def test_skeleton(self):
        made = self.folder / "made.gpkg"
        results = self.results("skeleton", INPUT=CONTOURS, RESOLUTION=2, OUTPUT=made)
        self.assertEqual(results["OUTPUT"], f"{made}|layername=skeleton")
        self.assertSameOutput(made, "skeleton", CONTOURS, "--resolution", "2", "-o")

    def test_mesh(self):
        made = self.folder / "made.ply"
        self.results("mesh", INPUT=NESTED, BASE_HEIGHT=-5.5, OUTPUT=made)
        self.assertSameOutput(made, "mesh", NESTED, "--base-height=-5.5", "-o")
        made = self.folder / "heights.ply"
        self.results("mesh", INPUT=HEIGHTS, TOLERANCE=2, OUTPUT=made)
        self.assertSameOutput(made, "mesh", HEIGHTS, "--tolerance", "2", "-o")

    def test_contour(self):
        made = self.folder / "made.gpkg"
        results = self.results("contour", INPUT=HEIGHTS, INTERVAL=25, SMOOTH=60, OUTPUT=made)
        self.assertEqual(results["OUTPUT"], f"{made}|layername=contours_25m")
        self.assertSameOutput(made, "contour", HEIGHTS, "-i", "25", "--smooth", "60", "-o")

    def test_contour_of_a_part(self):
        made, area = self.folder / "made.gpkg", self.folder / "area.geojson"
        ring = "[[745000,4022000],[746500,4022000],[745000,4023200],[745000,4022000]]"
        crs = '"crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::32616"}}'
        feature = f'{{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":[{ring}]}}}}'
        area.write_text(f'{{"type":"FeatureCollection",{crs},"features":[{feature}]}}')
        self.results("contour", INPUT=HEIGHTS, INTERVAL=25, CLIP=area, FRAME=area, OUTPUT=made)
        self.assertSameOutput(made, "contour", HEIGHTS, "-i", "25", "--clip", area, "--frame", area, "-o")

    def test_other_formats(self):
        for extension in ("fgb", "dxf", "shp"):
            made = self.folder / f"made.{extension}"
            self.assertEqual(self.results("densify", INPUT=NESTED, INTERVAL=5, OUTPUT=made)["OUTPUT"], str(made))
            self.assertSameOutput(made, "densify", NESTED, "-i", "5", "-o")


class Errors(Case):
    """The error is the program's own sentence."""

    def test_interval_of_zero(self):
        made = self.folder / "made.gpkg"
        told = self.error("densify", INPUT=CONTOURS, INTERVAL=0, OUTPUT=made)
        self.assertSaid(told, "densify", CONTOURS, "-i", "0", "-o", made)

    def test_missing_file(self):
        made, missing = self.folder / "made.tif", self.folder / "missing.gpkg"
        told = self.error("dem", INPUT=missing, OUTPUT=made)
        self.assertSaid(told, "dem", missing, "--cell", "10", "-o", made)

    def test_points_instead_of_lines(self):
        points, made = self.folder / "points.geojson", self.folder / "made.gpkg"
        feature = {"type": "Feature", "properties": {"elev": 5}, "geometry": {"type": "Point", "coordinates": [9, 50]}}
        points.write_text(json.dumps({"type": "FeatureCollection", "features": [feature]}))
        told = self.error("skeleton", INPUT=points, OUTPUT=made)
        self.assertSaid(told, "skeleton", points, "-o", made)

    def test_format_that_cannot_be_written(self):
        made = self.folder / "made.shp"
        told = self.error("check", INPUT=NESTED, FINDINGS=made)
        self.assertSaid(told, "check", NESTED, "-o", made)

    def test_missing_program(self):
        told = self.error("regions", path=str(self.folder), INPUT=NESTED, OUTPUT=self.folder / "made.gpkg")
        self.assertIn("The program tokosen was not found. Install it", told)

    def assertSaid(self, told, *arguments):
        failed = subprocess.run([TOKOSEN, *map(str, arguments)], capture_output=True, text=True)
        self.assertNotEqual(failed.returncode, 0)
        sentence = re.search(r"^error: (.*)", failed.stderr, re.MULTILINE).group(1)
        self.assertIn(sentence, told)
        self.assertNotIn("Traceback", told)
        self.assertNotIn("--help", told)
        self.assertFalse(pathlib.Path(arguments[-1]).exists())


class Program(Case):
    """Where the plugin finds the program."""

    def test_program_that_pip_has_installed_for_the_user(self):
        installed = pathlib.Path(os.environ["HOME"], ".local", "bin", "tokosen")
        installed.parent.mkdir(parents=True)
        self.addCleanup(shutil.rmtree, installed.parent)
        installed.symlink_to(TOKOSEN)
        self.assertFound()

    def test_program_in_the_plugin(self):
        install(make_zip(self.folder / "plugin.zip", "--program", TOKOSEN))
        self.addCleanup(shutil.rmtree, PLUGINS / "tokosen" / "bin")
        self.assertFound()

    def assertFound(self):
        made = self.folder / "made.gpkg"
        done = self.run_tool("regions", path=str(self.folder), INPUT=NESTED, OUTPUT=made)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertSameOutput(made, "regions", NESTED, "-o")
