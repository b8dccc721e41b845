"""QGIS inside Python, with the plugin loaded, for the tests that look into it."""
import os
import pathlib
import sys
import tempfile
import unittest

from qgis.core import QgsApplication, QgsProcessingContext, QgsProcessingFeedback, QgsProcessingUtils, QgsProject

from installed import PLUGINS, PROGRAMS, command
from outputs import content

APPLICATION = QgsApplication([], True)
APPLICATION.initQgis()
sys.path += [os.path.join(QgsApplication.pkgDataPath(), "python", "plugins"), str(PLUGINS)]
os.environ["PATH"] = os.pathsep.join([PROGRAMS, os.environ["PATH"]])

from processing.core.Processing import Processing  # noqa: E402

Processing.initialize()

import tokosen  # noqa: E402

PLUGIN = tokosen.classFactory(None)
PLUGIN.initGui()


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
