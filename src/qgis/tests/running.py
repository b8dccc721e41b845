"""Progress, findings, cancelling, threads and models. Started by run.py."""
import json
import os
import pathlib
import threading
import time

from qgis.core import (
    QgsApplication,
    QgsFeatureRequest,
    QgsProcessingAlgRunnerTask,
    QgsProcessingContext,
    QgsProcessingModelAlgorithm,
    QgsProcessingModelChildAlgorithm,
    QgsProcessingModelChildParameterSource,
    QgsProcessingModelOutput,
    QgsProcessingModelParameter,
    QgsProcessingOutputLayerDefinition,
    QgsProcessingParameterVectorLayer,
    QgsProject,
    QgsVectorLayer,
)

from inside import APPLICATION, Case, Log
from installed import CONTOURS, HEIGHTS, NESTED, TOKOSEN, command
from outputs import content, rows

# Importable after the module inside.
from processing.core.ProcessingConfig import ProcessingConfig  # noqa: E402
from tokosen import program  # noqa: E402


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

    def test_map_tiles_are_not_loaded(self):
        wanted = QgsProcessingOutputLayerDefinition(str(self.folder / "lines.pmtiles"), QgsProject.instance())
        results = self.run_tool("densify", INPUT=NESTED, INTERVAL=5, OUTPUT=wanted)
        self.assertTrue(results["OUTPUT"].endswith("lines.pmtiles") and pathlib.Path(results["OUTPUT"]).is_file())
        self.assertEqual(self.context.layersToLoadOnCompletion(), {})

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
