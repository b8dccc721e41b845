"""What all tools have in common: a tool is a command of the program, its parameters are options of the command."""
import re
import tempfile

from processing.gui.RenderingStyles import RenderingStyles
from qgis.core import (
    QgsProcessingAlgorithm,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingUtils,
    QgsVectorLayer,
)
from qgis.PyQt.QtGui import QIcon

from . import program, styles
from .options import Asked, Output

CONTOURS = "Contours"
HEIGHT_MAPS = "Height maps"
CHECKS = "Checks"
STRUCTURE = "Terrain structure"
# Map tiles, which are for web maps: QGIS does not load them as results.
TILES = ["pmtiles", "mbtiles"]


class Verb(QgsProcessingAlgorithm):
    """One command of the program. The classes of the tools set these attributes."""

    command = ""
    title = ""
    place = ""  # the group in the toolbox
    keywords = ()
    about = ""  # plain text; an empty line separates paragraphs
    options = ()  # parameters and outputs, in the order of the dialog

    def name(self):
        return self.command

    def displayName(self):
        return self.title

    def group(self):
        return self.place

    def groupId(self):
        return self.place.lower().replace(" ", "")

    def tags(self):
        return list(self.keywords)

    def icon(self):
        return self.provider().icon() if self.provider() else QIcon()

    def svgIconPath(self):
        return self.provider().svgIconPath() if self.provider() else ""

    def shortHelpString(self):
        return self.about.strip()

    def createInstance(self):
        return type(self)()

    def canExecute(self):
        try:
            program.find()
        except QgsProcessingException as missing:
            return False, str(missing)
        return True, ""

    def initAlgorithm(self, configuration=None):
        for option in self.options:
            self.addParameter(option.parameter())

    def checkParameterValues(self, parameters, context):
        """Leaves it to the program to say what is wrong with a file: it also reads files that QGIS does not."""
        for definition in self.parameterDefinitions():
            value = parameters.get(definition.name())
            is_path = isinstance(value, str) and value and definition.type() in ("source", "raster", "layer")
            if not is_path and not definition.checkValueIsAcceptable(value, context):
                return False, f"Incorrect parameter value for {definition.name()}"
        return True, ""

    def prepareAlgorithm(self, parameters, context, feedback):
        """Looks at the layers, in the thread that owns them."""
        asked = Asked(self, parameters, context)
        inputs = [option for option in self.options if not isinstance(option, Output)]
        self.pairs = [pair for option in inputs for pair in option.pairs(asked)]
        return True

    def processAlgorithm(self, parameters, context, feedback):
        outputs = self.paths(parameters, context)
        summary = self.run_program(self.pairs, outputs, feedback)
        if summary is None:
            return self.cancelled(outputs, context)
        return self.results(outputs, summary, context)

    def paths(self, parameters, context):
        """The files to write, by their Output."""
        found = {}
        for output in self.options:
            if isinstance(output, Output):
                read = self.parameterAsOutputLayer if output.is_layer else self.parameterAsFileOutput
                path = read(parameters, output.name, context)
                if path:
                    found[output] = path
        return found

    def run_program(self, pairs, outputs, feedback):
        """Returns the summary of the program; None if the user cancelled."""
        executable = program.find()
        with tempfile.TemporaryDirectory(prefix="tokosen_", dir=QgsProcessingUtils.tempFolder()) as folder:
            arguments = [self.command]
            for flag, value in pairs:
                if callable(value):
                    value = value(folder, feedback)
                    if feedback.isCanceled():
                        return None
                arguments.append(argument(flag, value))
            arguments += [argument(output.flag, path) for output, path in outputs.items()]
            # The user has agreed to replace files when choosing them.
            arguments.append("--overwrite")
            feedback.pushCommandInfo(program.command_line(arguments))
            summary = program.run(executable, arguments, feedback)
        if summary is not None:
            feedback.pushConsoleInfo(aligned(summary))
        return summary

    def cancelled(self, outputs, context):
        """Nothing was written, so nothing is loaded."""
        for path in outputs.values():
            leave(path, context)
        return {}

    def results(self, outputs, summary, context):
        """The values of the outputs. Layers that QGIS will load get their style."""
        values = {}
        for output, path in outputs.items():
            value = path
            if path.lower().endswith(tuple(TILES)):
                leave(path, context)
            elif output.is_layer:
                if path.lower().endswith(".gpkg"):
                    value = f"{path}|layername={output.layer or layer_in(summary)}"
                dress(output, path, value, self.id(), context)
            values[output.name] = value
        return values


def leave(path, context):
    """Does not load a file."""
    waiting = context.layersToLoadOnCompletion()
    context.setLayersToLoadOnCompletion({kept: details for kept, details in waiting.items() if kept != path})


def argument(flag, value):
    """One argument. Values follow '=', so that a negative number is no flag."""
    if value is None or not flag:
        return value if value is not None else flag
    return f"{flag}={value}"


def aligned(summary):
    """Keeps the columns of a table where runs of spaces would become one."""
    return re.sub(" {2,}", lambda run: "\u00a0" * len(run.group()), summary)


def layer_in(summary):
    """Name of the layer of contours in a GeoPackage: the program makes it of the interval."""
    return re.search(r"^written .*, layer (\S+)", summary, re.MULTILINE).group(1)


def dress(output, path, value, algorithm, context):
    """Names the layers to load, and gives the result its style if the user has set none for it in Processing."""
    waiting = context.layersToLoadOnCompletion()
    if path not in waiting:
        return
    details = waiting.pop(path)
    for other in output.others:
        source = f"{path}|layername={other}"
        if QgsVectorLayer(source, other, "ogr").featureCount() > 0:
            waiting[source] = QgsProcessingContext.LayerDetails(other, details.project, f"{output.name}_{other}")
    if output.style and not RenderingStyles.getStyle(algorithm, output.name):
        details.setPostProcessor(styles.processor(output.style))
    waiting[value] = details
    context.setLayersToLoadOnCompletion(waiting)
