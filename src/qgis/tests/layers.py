"""Layers of all kinds, cancelling, and the styles, inside Python of QGIS. Started by run.py."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from xml.etree import ElementTree

from qgis.core import (
    QgsApplication,
    QgsCategorizedSymbolRenderer,
    QgsCoordinateReferenceSystem,
    QgsFeature,
    QgsFeatureRequest,
    QgsGeometry,
    QgsHillshadeRenderer,
    QgsProcessingAlgRunnerTask,
    QgsProcessingContext,
    QgsProcessingFeatureSourceDefinition,
    QgsProcessingFeedback,
    QgsProcessingModelAlgorithm,
    QgsProcessingModelChildAlgorithm,
    QgsProcessingModelChildParameterSource,
    QgsProcessingModelOutput,
    QgsProcessingModelParameter,
    QgsProcessingOutputLayerDefinition,
    QgsProcessingParameterVectorLayer,
    QgsProcessingUtils,
    QgsProject,
    QgsRasterLayer,
    QgsVectorFileWriter,
    QgsVectorLayer,
)
from qgis.PyQt.QtXml import QDomDocument

from installed import CONTOURS, HEIGHTS, NESTED, PLUGINS, PROGRAMS, TOKOSEN, command
from outputs import content, count, rows

APPLICATION = QgsApplication([], True)
APPLICATION.initQgis()
sys.path += [os.path.join(QgsApplication.pkgDataPath(), "python", "plugins"), str(PLUGINS)]
os.environ["PATH"] = os.pathsep.join([PROGRAMS, os.environ["PATH"]])

from processing.core.Processing import Processing  # noqa: E402
from processing.core.ProcessingConfig import ProcessingConfig  # noqa: E402

Processing.initialize()

import tokosen  # noqa: E402
from tokosen import inputs, program, styles  # noqa: E402
from tokosen.verbs import VERBS  # noqa: E402

PLUGIN = tokosen.classFactory(None)
PLUGIN.initGui()

# Options that are no parameters. The plugin sets some of them itself; the guide names the others.
LEFT_OUT = {
    "crs", "layer", "extent-crs", "help", "quiet", "verbose", "overwrite", "progress", "json", "threads", "save-run",
    "png-encoding",
}
LEFT_OUT_OF = {
    "densify": {"dem", "cell", "cell-degrees", "like", "cog", "compare", "report"},
    "check": {"strict"},
    "skeleton": {"triangles", "curve-mesh"},
}


class Log(QgsProcessingFeedback):
    """Remembers what a run says."""

    def __init__(self):
        super().__init__(False)
        self.is_cancelled_by_summary = False
        self.said = {"summary": [], "warning": [], "error": [], "command": [], "step": []}

    def pushConsoleInfo(self, text):
        self.said["summary"].append(text)
        if self.is_cancelled_by_summary:
            self.cancel()

    def pushWarning(self, text):
        self.said["warning"].append(text)

    def reportError(self, text, fatalError=False):
        self.said["error"].append(text)

    def pushCommandInfo(self, text):
        self.said["command"].append(text)

    def setProgressText(self, text):
        self.said["step"].append(text)


class Case(unittest.TestCase):
    maxDiff = 1000

    def setUp(self):
        held = tempfile.TemporaryDirectory()
        self.addCleanup(held.cleanup)
        self.folder = pathlib.Path(held.name)
        self.addCleanup(QgsProject.instance().clear)
        self.log = Log()

    def run_tool(self, tool, **parameters):
        """The results of a run; None if it failed."""
        context = QgsProcessingContext()
        context.setProject(QgsProject.instance())
        algorithm = QgsApplication.processingRegistry().createAlgorithmById(f"tokosen:{tool}")
        values = {name: str(value) if isinstance(value, pathlib.Path) else value for name, value in parameters.items()}
        results, is_done = algorithm.run(values, context, self.log)
        self.context = context
        return results if is_done else None

    def densify(self, layer, interval=5, **more):
        made = self.folder / "made.gpkg"
        made.unlink(missing_ok=True)
        QgsProject.instance().addMapLayer(layer)
        self.assertIsNotNone(self.run_tool("densify", INPUT=layer, INTERVAL=interval, OUTPUT=made, **more), self.log.said)
        return made

    def assertSameAs(self, made, source, *options):
        expected = self.folder / "expected.gpkg"
        expected.unlink(missing_ok=True)
        command("densify", source, "-i", "5", *options, "-o", expected)
        self.assertEqual(content(made), content(expected))

    def assertNothingLeft(self):
        left = [name for name in os.listdir(QgsProcessingUtils.tempFolder()) if name.startswith("tokosen_")]
        self.assertEqual(left, [])


class Layers(Case):
    def test_file_is_passed_by_its_path(self):
        made = self.densify(QgsVectorLayer(str(NESTED), "nested"))
        self.assertIn(f"densify {NESTED} ", self.log.said["command"][0])
        self.assertSameAs(made, NESTED)

    def test_memory_layer(self):
        layer = QgsVectorLayer(str(NESTED), "nested").materialize(QgsFeatureRequest())
        self.assertEqual(layer.providerType(), "memory")
        made = self.densify(layer)
        self.assertIn("tokosen_", self.log.said["command"][0])
        self.assertSameAs(made, NESTED)
        self.assertNothingLeft()

    def test_filtered_layer(self):
        layer = QgsVectorLayer(str(NESTED), "nested")
        layer.setSubsetString('"elev" >= 110')
        self.assertLess(layer.featureCount(), 8)
        self.assertSameAs(self.densify(layer), self.part_of_nested(lambda elev: elev >= 110))

    def test_selected_features_only(self):
        layer = QgsVectorLayer(str(NESTED), "nested")
        layer.selectByExpression('"elev" >= 110')
        QgsProject.instance().addMapLayer(layer)
        made = self.folder / "made.gpkg"
        chosen = QgsProcessingFeatureSourceDefinition(layer.id(), selectedFeaturesOnly=True)
        self.assertIsNotNone(self.run_tool("densify", INPUT=chosen, INTERVAL=5, OUTPUT=made))
        self.assertSameAs(made, self.part_of_nested(lambda elev: elev >= 110))
        # The selection does not count unless the user says so.
        self.assertSameAs(self.densify(layer), NESTED)

    def test_selected_features_that_fulfil_an_expression(self):
        layer = QgsVectorLayer(str(NESTED), "nested")
        layer.selectByExpression('"elev" >= 110')
        selection = inputs.Selection()
        selection.selected_only, selection.expression = True, '"elev" < 120'
        found = [feature["elev"] for feature in layer.getFeatures(selection.request(layer))]
        self.assertTrue(found)
        self.assertEqual(set(found), {110})
        selection.limit = 1
        self.assertEqual(len(list(layer.getFeatures(selection.request(layer)))), 1)

    def test_curves_become_lines(self):
        layer = QgsVectorLayer("CompoundCurve?crs=EPSG:6678&field=elev:double", "curves", "memory")
        for elev, radius in ((10, 90), (20, 60), (30, 30)):
            feature = QgsFeature(layer.fields())
            feature["elev"] = elev
            arcs = f"(0 -{radius}, {radius} 0, 0 {radius}, -{radius} 0, 0 -{radius})"
            feature.setGeometry(QgsGeometry.fromWkt(f"CompoundCurve(CircularString{arcs})"))
            self.assertTrue(layer.dataProvider().addFeature(feature))
        made = self.densify(layer)
        self.assertEqual({row[2] for row in rows(made)["contours_5m"][2]} & {10, 15, 20, 25, 30}, {10, 15, 20, 25, 30})

    def test_cancelled_copy(self):
        layer = QgsVectorLayer(str(NESTED), "nested").materialize(QgsFeatureRequest())
        QgsProject.instance().addMapLayer(layer)
        self.log.cancel()
        self.assertEqual(self.run_tool("densify", INPUT=layer, INTERVAL=5, OUTPUT=self.folder / "made.gpkg"), {})
        self.assertEqual(os.listdir(self.folder), [])
        self.assertNothingLeft()

    def test_unsaved_edits(self):
        layer = QgsVectorLayer(str(CONTOURS), "contours")
        field = layer.fields().indexOf("elev")
        layer.startEditing()
        for feature in layer.getFeatures():
            layer.changeAttributeValue(feature.id(), field, feature["elev"] + 1)
        made = self.densify(layer, interval=20, BASE=1, ELEVATION_FIELD="elev")
        self.assertEqual({row[2] % 20 for row in rows(made)["contours_20m"][2]}, {1})
        layer.rollBack()

    def test_geopackage_with_several_layers(self):
        several = self.several_layers()
        for name in ("first", "second"):
            made = self.densify(QgsVectorLayer(f"{several}|layername={name}", name, "ogr"))
            self.assertSameAs(made, f"{several}|layername={name}")
        # Without a name, QGIS takes the first layer.
        self.assertSameAs(self.densify(QgsVectorLayer(str(several), "unnamed")), f"{several}|layername=first")

    def test_path_with_spaces_and_other_letters(self):
        source = self.folder / "等高線 Höhen" / "my map.geojson"
        source.parent.mkdir()
        source.write_bytes(NESTED.read_bytes())
        QgsProject.instance().addMapLayer(QgsVectorLayer(str(source), "nested"))
        made = source.parent / "neue Linien 線.gpkg"
        self.assertIsNotNone(self.run_tool("densify", INPUT=source, INTERVAL=5, OUTPUT=made))
        self.assertSameAs(made, NESTED)

    def test_system_of_the_layer_wins(self):
        layer = QgsVectorLayer(str(NESTED), "nested")
        layer.setCrs(QgsCoordinateReferenceSystem("EPSG:6677"))
        made = self.densify(layer)
        self.assertSameAs(made, NESTED, "--crs", "EPSG:6677")

    def test_raster_in_another_system_than_its_file(self):
        layer = QgsRasterLayer(str(HEIGHTS), "heights")
        layer.setCrs(QgsCoordinateReferenceSystem("EPSG:32617"))
        QgsProject.instance().addMapLayer(layer)
        made, expected = self.folder / "made.gpkg", self.folder / "expected.gpkg"
        self.assertIsNotNone(self.run_tool("contour", INPUT=layer, INTERVAL=50, OUTPUT=made), self.log.said)
        command("contour", HEIGHTS, "--crs", "EPSG:32617", "-i", "50", "-o", expected)
        self.assertEqual(content(made), content(expected))
        self.assertNothingLeft()

    def test_raster_format_that_the_program_does_not_read(self):
        from osgeo import gdal

        virtual = self.folder / "heights.vrt"
        gdal.Translate(str(virtual), str(HEIGHTS))
        made, expected = self.folder / "made.tif", self.folder / "expected.tif"
        self.assertIsNotNone(self.run_tool("derive", INPUT=virtual, SLOPE=made), self.log.said)
        command("derive", HEIGHTS, "--slope", expected)
        self.assertEqual(made.read_bytes(), expected.read_bytes())

    def test_several_layers_of_streams(self):
        lines = self.folder / "lines.gpkg"
        command("skeleton", CONTOURS, "-o", lines)
        layers = []
        for kind, part in (("canyon", "%2=0"), ("canyon", "%2=1")):
            layer = QgsVectorLayer(f"{lines}|layername=skeleton", kind, "ogr")
            layer.setSubsetString(f"kind = '{kind}' AND fid{part}")
            self.assertGreater(layer.featureCount(), 20)
            layers.append(layer)
        QgsProject.instance().addMapLayers(layers)
        made, expected = self.folder / "made.tif", self.folder / "expected.tif"
        self.assertIsNotNone(self.run_tool("dem", INPUT=CONTOURS, CELL=40, STREAMS=layers, OUTPUT=made), self.log.said)
        options = QgsVectorFileWriter.SaveVectorOptions()
        options.fileName, streams = "x", []
        for number, layer in enumerate(layers):
            path = str(self.folder / f"streams{number}.gpkg")
            QgsVectorFileWriter.writeAsVectorFormatV3(layer, path, QgsProject.instance().transformContext(), options)
            streams += ["--streams", path]
        command("dem", CONTOURS, "--cell", "40", *streams, "-o", expected)
        self.assertEqual(made.read_bytes(), expected.read_bytes())
        plain = self.folder / "plain.tif"
        command("dem", CONTOURS, "--cell", "40", "-o", plain)
        self.assertNotEqual(made.read_bytes(), plain.read_bytes())

    def test_layer_that_cannot_be_passed(self):
        table = QgsVectorLayer("NoGeometry?field=elev:double", "table", "memory")
        QgsProject.instance().addMapLayer(table)
        self.assertIsNone(self.run_tool("densify", INPUT=table, INTERVAL=5, OUTPUT=self.folder / "made.gpkg"))
        self.assertIn("The layer table is no vector layer with geometry", self.log.said["error"][-1])

    def test_drawing(self):
        drawing = self.folder / "drawing.dxf"
        command("densify", NESTED, "-i", "10", "-o", drawing)
        layer = QgsVectorLayer(f"{drawing}|layername=entities|geometrytype=LineString", "drawing", "ogr")
        layer.setCrs(QgsCoordinateReferenceSystem("EPSG:6678"))
        self.assertGreater(layer.featureCount(), 0)
        made = self.densify(layer)
        ((_, _, found),) = rows(made).values()
        self.assertSameAs(made, NESTED)
        self.assertTrue(found)

    def test_table_of_points(self):
        table = self.folder / "points.csv"
        table.write_text("x,y,elev\n13700,-16500,112.5\n")
        uri = f"file://{table}?delimiter=,&xField=x&yField=y&crs=EPSG:6678&detectTypes=yes"
        layer = QgsVectorLayer(uri, "points", "delimitedtext")
        self.assertEqual(layer.featureCount(), 1)
        QgsProject.instance().addMapLayer(layer)
        made = self.folder / "made.gpkg"
        self.assertIsNotNone(self.run_tool("densify", INPUT=NESTED, INTERVAL=5, POINTS=layer, OUTPUT=made), self.log.said)
        self.assertSameAs(made, NESTED, "--points", table)

    def test_layer_of_several_that_is_missing(self):
        missing = [str(NESTED), str(self.folder / "missing.gpkg")]
        made = self.folder / "made.tif"
        self.assertIsNone(self.run_tool("dem", INPUT=CONTOURS, STREAMS=missing, OUTPUT=made))
        self.assertIn("missing.gpkg", " ".join(self.log.said["error"]))

    def part_of_nested(self, is_wanted):
        map_ = json.loads(NESTED.read_text())
        map_["features"] = [feature for feature in map_["features"] if is_wanted(feature["properties"]["elev"])]
        part = self.folder / "part.geojson"
        part.write_text(json.dumps(map_))
        return part

    def several_layers(self):
        several = self.folder / "several.gpkg"
        for name, source in (("first", NESTED), ("second", NESTED.parent / "fig3b_three_arms.geojson")):
            options = QgsVectorFileWriter.SaveVectorOptions()
            options.layerName = name
            if several.exists():
                options.actionOnExistingFile = QgsVectorFileWriter.CreateOrOverwriteLayer
            context = QgsProject.instance().transformContext()
            QgsVectorFileWriter.writeAsVectorFormatV3(QgsVectorLayer(str(source), name), str(several), context, options)
        return several


class Options(unittest.TestCase):
    """The parameters are options of the program that is tested, and none of its options is forgotten."""

    def test_flags(self):
        for verb in VERBS:
            with self.subTest(verb.command):
                help_ = subprocess.run([TOKOSEN, verb.command, "--help"], capture_output=True, text=True).stdout
                known = set(re.findall(r"^ +(?:-\w, )?--([\w-]+)", help_, re.MULTILINE))
                flags = {option.flag[2:] for option in verb.options if option.flag}
                self.assertEqual(flags - known, set())
                self.assertEqual(known - flags - LEFT_OUT, LEFT_OUT_OF.get(verb.command, set()))
                names = [option.name for option in verb.options]
                self.assertEqual(len(names), len(set(names)))

    def test_help(self):
        for verb in VERBS:
            algorithm = verb()
            self.assertGreater(len(algorithm.shortHelpString()), 100)
            self.assertTrue(algorithm.tags())


class Running(Case):
    def test_progress_and_summary(self):
        steps = []
        self.log.progressChanged.connect(steps.append)
        made = self.folder / "made.tif"
        self.assertIsNotNone(self.run_tool("dem", INPUT=CONTOURS, CELL=20, OUTPUT=made))
        self.assertGreater(len(steps), 4)
        self.assertEqual(steps, sorted(steps))
        self.assertEqual(steps[-1], 100)
        self.assertIn("Smooth surface", self.log.said["step"])
        self.assertIn("220 lines", self.log.said["summary"][0])
        self.assertEqual(self.log.said["warning"], [])

    def test_diagnostics_are_loaded_unless_they_are_empty(self):
        lines = self.folder / "lines.gpkg"
        command("skeleton", CONTOURS, "-o", lines)
        path = str(self.folder / "diagnostics.gpkg")
        wanted = QgsProcessingOutputLayerDefinition(path, QgsProject.instance())
        made = self.folder / "made.tif"
        results = self.run_tool("dem", INPUT=CONTOURS, CELL=40, STREAMS=[str(lines)], OUTPUT=made, DIAGNOSTICS=wanted)
        self.assertEqual(results["DIAGNOSTICS"], f"{path}|layername=conflicts")
        with_features = {name for name, (_, _, features) in rows(path).items() if features}
        self.assertIn("streams", with_features)
        self.assertNotIn("breaklines", with_features)
        loaded = {source.split("=")[1] for source in self.context.layersToLoadOnCompletion()}
        self.assertEqual(loaded, with_features | {"conflicts"})

    def test_in_the_background(self):
        """As QGIS runs tools from its toolbox: the work is done in another thread."""
        memory = QgsVectorLayer(str(NESTED), "nested").materialize(QgsFeatureRequest())
        QgsProject.instance().addMapLayer(memory)
        made = self.folder / "made.gpkg"
        algorithm = QgsApplication.processingRegistry().createAlgorithmById("tokosen:densify")
        context, done = QgsProcessingContext(), []
        context.setProject(QgsProject.instance())
        wanted = QgsProcessingOutputLayerDefinition(str(made), QgsProject.instance())
        parameters = {"INPUT": memory.id(), "INTERVAL": 5, "OUTPUT": wanted}
        task = QgsProcessingAlgRunnerTask(algorithm, parameters, context, self.log)
        task.executed.connect(lambda *results: done.append(results))
        QgsApplication.taskManager().addTask(task)
        limit = time.monotonic() + 30
        while not done and time.monotonic() < limit:
            APPLICATION.processEvents()
        ((is_done, results),) = done
        self.assertTrue(is_done, self.log.said)
        command("densify", NESTED, "-i", "5", "-o", self.folder / "expected.gpkg")
        self.assertEqual(content(made), content(self.folder / "expected.gpkg"))
        ((source, details),) = context.layersToLoadOnCompletion().items()
        self.assertEqual(source, results["OUTPUT"])
        layer = QgsVectorLayer(source, "made", "ogr")
        details.postProcessor().postProcessLayer(layer, context, self.log)
        self.assertTrue(layer.labelsEnabled())
        # The task belongs to QGIS, and is over before its context.
        APPLICATION.processEvents()

    def test_in_a_model(self):
        model = QgsProcessingModelAlgorithm("chain", "tests")
        model.addModelParameter(QgsProcessingParameterVectorLayer("lines"), QgsProcessingModelParameter("lines"))
        first, second = QgsProcessingModelChildAlgorithm("tokosen:densify"), QgsProcessingModelChildAlgorithm("tokosen:dem")
        static, source = QgsProcessingModelChildParameterSource.fromStaticValue, QgsProcessingModelChildParameterSource
        first.setChildId("first")
        first.addParameterSources("INPUT", [source.fromModelParameter("lines")])
        first.addParameterSources("INTERVAL", [static(5)])
        second.setChildId("second")
        second.addParameterSources("INPUT", [source.fromChildOutput("first", "OUTPUT")])
        second.addParameterSources("CELL", [static(20)])
        output = QgsProcessingModelOutput("heights")
        output.setChildId("second")
        output.setChildOutputName("OUTPUT")
        second.setModelOutputs({"heights": output})
        for child in (first, second):
            model.addChildAlgorithm(child)
        model.updateDestinationParameters()
        context = QgsProcessingContext()
        made = self.folder / "made.tif"
        ((destination,),) = [[p.name() for p in model.destinationParameterDefinitions()]]
        wanted = QgsProcessingOutputLayerDefinition(str(made), QgsProject.instance())
        results, is_done = model.run({"lines": str(NESTED), destination: wanted}, context, self.log)
        self.assertTrue(is_done, self.log.said)
        self.assertEqual(list(context.layersToLoadOnCompletion()), [str(made)])
        lines, expected = self.folder / "lines.gpkg", self.folder / "expected.tif"
        command("densify", NESTED, "-i", "5", "-o", lines)
        command("dem", lines, "--cell", "20", "-o", expected)
        self.assertEqual(made.read_bytes(), expected.read_bytes())

    def test_findings_are_warnings(self):
        map_ = json.loads(NESTED.read_text())
        map_["features"].append(map_["features"][0])
        faulty = self.folder / "faulty.geojson"
        faulty.write_text(json.dumps(map_))
        self.assertIsNotNone(self.run_tool("densify", INPUT=faulty, INTERVAL=5, OUTPUT=self.folder / "made.gpkg"))
        self.assertEqual(len(self.log.said["warning"]), 1)
        self.assertRegex(self.log.said["warning"][0], "^duplicate lines: 1\n    the contour 100 m")

    def test_cancelling_leaves_nothing(self):
        folder = self.folder / "results"
        folder.mkdir()
        memory = QgsVectorLayer(str(CONTOURS), "contours").materialize(QgsFeatureRequest())
        QgsProject.instance().addMapLayer(memory)
        for delay in (0.2, 1, 2.5):
            with self.subTest(delay):
                self.log = Log()
                threading.Timer(delay, self.log.cancel).start()
                started = time.monotonic()
                made = QgsProcessingOutputLayerDefinition(str(folder / "made.tif"), QgsProject.instance())
                results = self.run_tool("dem", INPUT=memory, CELL=1.5, OUTPUT=made)
                taken = time.monotonic() - started
                self.assertEqual(results, {})
                self.assertGreaterEqual(taken, delay)
                self.assertLess(taken, delay + 1)
                self.assertEqual(os.listdir(folder), [])
                self.assertEqual(self.context.layersToLoadOnCompletion(), {})
                self.assertNothingLeft()
                self.assertEqual(children(), [])

    def test_cancelling_keeps_what_was_there(self):
        made = self.folder / "made.tif"
        made.write_bytes(HEIGHTS.read_bytes())
        threading.Timer(1, self.log.cancel).start()
        self.assertEqual(self.run_tool("dem", INPUT=CONTOURS, CELL=1.5, OUTPUT=made), {})
        self.assertEqual(made.read_bytes(), HEIGHTS.read_bytes())
        self.assertEqual(os.listdir(self.folder), ["made.tif"])

    def test_cancelling_between_two_outputs_leaves_nothing(self):
        self.log.is_cancelled_by_summary = True
        findings, repaired = self.folder / "findings.gpkg", self.folder / "repaired.gpkg"
        self.assertEqual(self.run_tool("check", INPUT=NESTED, FINDINGS=findings, REPAIRED=repaired), {})
        self.assertEqual(os.listdir(self.folder), [])

    def test_program_that_is_set(self):
        self.addCleanup(ProcessingConfig.setSettingValue, program.SETTING, "")
        ProcessingConfig.setSettingValue(program.SETTING, TOKOSEN)
        self.assertEqual(program.find(), TOKOSEN)
        ProcessingConfig.setSettingValue(program.SETTING, str(NESTED))
        self.assertIsNone(self.run_tool("regions", INPUT=NESTED, OUTPUT=self.folder / "made.gpkg"))
        self.assertIn(f"The program {NESTED} cannot be started", self.log.said["error"][-1])
        gone = self.folder / "gone"
        gone.touch()
        ProcessingConfig.setSettingValue(program.SETTING, str(gone))
        gone.unlink()
        self.assertIsNone(self.run_tool("regions", INPUT=NESTED, OUTPUT=self.folder / "made.gpkg"))
        self.assertIn(f"names the program {gone}, which is not there", self.log.said["error"][-1])


def children():
    """Processes that this one has started and that still are there."""
    listed = pathlib.Path(f"/proc/self/task/{os.getpid()}/children")
    return listed.read_text().split() if listed.exists() else []


class Styles(Case):
    def loaded(self, tool, output, **parameters):
        """The layer of an output as QGIS loads it, with its style."""
        path = self.folder / f"{output}.{'tif' if tool in ('dem', 'compare') else 'gpkg'}"
        parameters[output] = QgsProcessingOutputLayerDefinition(str(path), QgsProject.instance())
        results = self.run_tool(tool, **parameters)
        self.assertIsNotNone(results, self.log.said)
        ((source, details),) = self.context.layersToLoadOnCompletion().items()
        self.assertEqual(source, results[output])
        layer = QgsProcessingUtils.mapLayerFromString(source, self.context)
        self.assertIsNotNone(layer, source)
        details.postProcessor().postProcessLayer(layer, self.context, self.log)
        return layer

    def test_contours(self):
        # Twice: a processor belongs to one run.
        for interval in (5, 2):
            layer = self.loaded("densify", "OUTPUT", INPUT=NESTED, INTERVAL=interval)
            rules = style_of(layer).findall(".//renderer-v2/rules/rule")
            found = [number_of_features(layer, rule.get("filter")) for rule in rules]
            self.assertEqual(sum(found), layer.featureCount())
            self.assertGreater(found[0], 0)
            widths = [width_of(layer, rule) for rule in rules]
            self.assertGreater(min(widths[:2]), max(widths[2:]))
            self.assertTrue(layer.labelsEnabled())

    def test_drawing_without_fields_stays_visible(self):
        layer = QgsVectorLayer("LineString?field=Layer:string", "drawing", "memory")
        before = layer.renderer().type()
        for style in styles.FIELDS:
            styles.processor(style).postProcessLayer(layer, QgsProcessingContext(), self.log)
        self.assertEqual(layer.renderer().type(), before)

    def test_height_map(self):
        self.assertIsInstance(self.loaded("dem", "OUTPUT", INPUT=NESTED, CELL=10).renderer(), QgsHillshadeRenderer)

    def test_categories_are_those_of_the_results(self):
        faulty = self.folder / "faulty.geojson"
        map_ = json.loads(NESTED.read_text())
        map_["features"][3]["properties"]["elev"] += 30
        map_["features"].append(map_["features"][0])
        faulty.write_text(json.dumps(map_))
        for tool, output, source, field in [
            ("check", "FINDINGS", faulty, "severity"),
            ("regions", "OUTPUT", CONTOURS, "class"),
            ("skeleton", "OUTPUT", CONTOURS, "kind"),
        ]:
            with self.subTest(tool):
                layer = self.loaded(tool, output, INPUT=source)
                self.assertIsInstance(layer.renderer(), QgsCategorizedSymbolRenderer)
                known = {category.value() for category in layer.renderer().categories()}
                found = {feature[field] for feature in layer.getFeatures()}
                self.assertGreater(len(found), 1)
                self.assertEqual(found - known, set())


def style_of(layer):
    """The style as QGIS saves it. Rules that Python holds longer than their layer would end it."""
    document = QDomDocument()
    layer.exportNamedStyle(document)
    return ElementTree.fromstring(document.toString())


def width_of(layer, rule):
    symbol = style_of(layer).find(f".//renderer-v2/symbols/symbol[@name='{rule.get('symbol')}']")
    return float(symbol.find(".//Option[@name='line_width']").get("value"))


def number_of_features(layer, expression):
    return sum(1 for _ in layer.getFeatures(QgsFeatureRequest().setFilterExpression(expression)))
