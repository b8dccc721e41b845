"""One line for each option of the program: the parameter of the dialog, and the argument that it becomes.

The name of a parameter is that of the flag: --stream-tolerance is STREAM_TOLERANCE. What the user leaves empty or at its default
is not passed, so that the program decides.
"""
from typing import Any, Callable, NamedTuple

from qgis.core import (
    NULL,
    QgsProcessing,
    QgsProcessingFeatureSourceDefinition,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterCrs,
    QgsProcessingParameterDefinition,
    QgsProcessingParameterDistance,
    QgsProcessingParameterEnum,
    QgsProcessingParameterExtent,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterMapLayer,
    QgsProcessingParameterMultipleLayers,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
    QgsProcessingParameterRasterLayer,
    QgsProcessingParameterString,
    QgsProcessingParameterVectorDestination,
    QgsUnitTypes,
)

from . import inputs

LINES = QgsProcessing.TypeVectorLine
POLYGONS = QgsProcessing.TypeVectorPolygon
POINTS = QgsProcessing.TypeVectorPoint
ANY = QgsProcessing.TypeVectorAnyGeometry
RASTER = QgsProcessing.TypeRaster


class Asked(NamedTuple):
    """What the user asked for: the values of all parameters of an algorithm."""

    algorithm: Any
    parameters: dict
    context: Any

    def has(self, name):
        value = self.parameters.get(name)
        return not (value is None or value == "" or value == NULL)

    def text(self, name):
        return self.algorithm.parameterAsString(self.parameters, name, self.context)

    def number(self, name):
        return self.algorithm.parameterAsDouble(self.parameters, name, self.context)


class Option(NamedTuple):
    """A parameter, and how it becomes arguments: pairs of a flag and a value.

    The flag of an input file is empty. A value is text, None for a flag alone, or a function (folder, feedback) that writes a
    layer to a file and returns its path.
    """

    name: str
    flag: str
    define: Callable[[], QgsProcessingParameterDefinition]
    pairs: Callable[[Asked], list]
    help: str = ""
    advanced: bool = False

    def parameter(self):
        definition = self.define()
        if self.help:
            definition.setHelp(self.help)
        if self.advanced:
            definition.setFlags(definition.flags() | QgsProcessingParameterDefinition.FlagAdvanced)
        return definition


class Output(NamedTuple):
    """A file that the program writes.

    `style` names its look in QGIS. `layer` is its layer in a GeoPackage, if this is known. `others` are further layers there,
    which QGIS loads too, unless they are empty.
    """

    name: str
    flag: str
    define: Callable[[], QgsProcessingParameterDefinition]
    help: str = ""
    style: str = ""
    layer: str = ""
    others: tuple = ()
    is_layer: bool = True
    advanced: bool = False

    parameter = Option.parameter


def name_of(flag):
    return flag.strip("-").replace("-", "_").upper()


def number_text(value):
    """The shortest text that reads as the same number."""
    shown = repr(float(value))
    return shown[:-2] if shown.endswith(".0") else shown


# Values.


def number(flag, label, default=None, proposed=None, name=None, whole=False, unless=(), **more):
    """A number. `default` is that of the program; `proposed` stands in the dialog where the program has none.

    It is not passed if one of the parameters `unless` is given.
    """
    name = name or name_of(flag)
    shown = default if proposed is None else proposed
    kind = QgsProcessingParameterNumber.Integer if whole else QgsProcessingParameterNumber.Double
    define = lambda: QgsProcessingParameterNumber(name, label, kind, shown, optional=shown is None)
    return Option(name, flag, define, lambda asked: number_pairs(asked, flag, name, default, shown, unless), **more)


def distance(flag, label, default=None, proposed=None, unless=(), parent="", **more):
    """A distance in metres of the working plane, or in the units of the layer of the parameter `parent`."""
    name = name_of(flag)
    shown = default if proposed is None else proposed

    def define():
        definition = QgsProcessingParameterDistance(name, label, shown, parent, optional=shown is None)
        if not parent:
            definition.setDefaultUnit(QgsUnitTypes.DistanceMeters)
        return definition

    return Option(name, flag, define, lambda asked: number_pairs(asked, flag, name, default, shown, unless), **more)


def number_pairs(asked, flag, name, default, shown, unless):
    if any(asked.has(other) for other in unless):
        return []
    value = asked.number(name) if asked.has(name) else shown
    return [] if value is None or value == default else [(flag, number_text(value))]


def text(flag, label, **more):
    name = name_of(flag)
    define = lambda: QgsProcessingParameterString(name, label, optional=True)
    return Option(name, flag, define, lambda asked: [(flag, asked.text(name))] if asked.has(name) else [], **more)


def yes(flag, label, **more):
    name = name_of(flag)

    def pairs(asked):
        return [(flag, None)] if asked.algorithm.parameterAsBool(asked.parameters, name, asked.context) else []

    return Option(name, flag, lambda: QgsProcessingParameterBoolean(name, label, False), pairs, **more)


def choice(flag, label, values, unless=(), always=False, **more):
    """One of several: `values` holds pairs of the program's word and the text in the dialog; the first is the default."""
    name = name_of(flag)

    def pairs(asked):
        chosen = asked.algorithm.parameterAsEnum(asked.parameters, name, asked.context)
        if chosen == 0 and not always or any(asked.has(other) for other in unless):
            return []
        return [(flag, values[chosen][0])]

    define = lambda: QgsProcessingParameterEnum(name, label, [shown for _, shown in values], defaultValue=0)
    return Option(name, flag, define, pairs, **more)


def crs(flag, label, **more):
    name = name_of(flag)

    def pairs(asked):
        if not asked.has(name):
            return []
        return [(flag, crs_text(asked.algorithm.parameterAsCrs(asked.parameters, name, asked.context)))]

    return Option(name, flag, lambda: QgsProcessingParameterCrs(name, label, optional=True), pairs, **more)


def crs_text(system):
    """How the program is told a coordinate reference system."""
    return system.authid() if system.authid().startswith("EPSG:") else system.toWkt()


def extent(flag, label, **more):
    name = name_of(flag)

    def pairs(asked):
        box = asked.algorithm.parameterAsExtent(asked.parameters, name, asked.context)
        if not asked.has(name) or box.isNull():
            return []
        corners = (box.xMinimum(), box.yMinimum(), box.xMaximum(), box.yMaximum())
        system = asked.algorithm.parameterAsExtentCrs(asked.parameters, name, asked.context)
        found = [(flag, ",".join(map(number_text, corners)))]
        return found + ([(f"{flag}-crs", crs_text(system))] if system.isValid() else [])

    return Option(name, flag, lambda: QgsProcessingParameterExtent(name, label, optional=True), pairs, **more)


def field(flag, label, parent, **more):
    name = name_of(flag)
    define = lambda: QgsProcessingParameterField(name, label, parentLayerParameterName=parent, optional=True)
    return Option(name, flag, define, lambda asked: [(flag, asked.text(name))] if asked.has(name) else [], **more)


# Layers that the program reads.


def layer(flag, label, kind, name=None, optional=True, **more):
    """A vector layer; the user can take its selected features alone."""
    name = name or name_of(flag)
    define = lambda: QgsProcessingParameterFeatureSource(name, label, [kind], optional=optional)
    return Option(name, flag, define, lambda asked: layer_pairs(asked, flag, name), **more)


def raster(flag, label, name=None, optional=True, **more):
    name = name or name_of(flag)
    define = lambda: QgsProcessingParameterRasterLayer(name, label, optional=optional)
    return Option(name, flag, define, lambda asked: layer_pairs(asked, flag, name), **more)


def map_layer(flag, label, name, optional=False, **more):
    """A height map or contour lines."""
    define = lambda: QgsProcessingParameterMapLayer(name, label, optional=optional, types=[RASTER, LINES])
    return Option(name, flag, define, lambda asked: layer_pairs(asked, flag, name), **more)


def layers(flag, label, kind, **more):
    """Vector layers: the flag is given once for each."""
    name = name_of(flag)

    def pairs(asked):
        if not asked.has(name):
            return []
        wanted = asked.parameters[name]
        named = wanted if isinstance(wanted, (list, tuple)) else [wanted]
        found = []
        for each in named:
            read = asked.algorithm.parameterAsLayerList({name: [each]}, name, asked.context)
            # The program says what is wrong with a file that QGIS cannot read.
            found += [(flag, inputs.path_or_copy(layer)) for layer in read] or [(flag, str(each))]
        return found

    return Option(name, flag, lambda: QgsProcessingParameterMultipleLayers(name, label, kind, optional=True), pairs, **more)


def layer_pairs(asked, flag, name):
    if not asked.has(name):
        return []
    value = asked.parameters[name]
    selection = inputs.Selection(value)
    if isinstance(value, QgsProcessingFeatureSourceDefinition):
        value = value.source
    found = asked.algorithm.parameterAsLayer({**asked.parameters, name: value}, name, asked.context)
    if found is not None:
        return [(flag, inputs.path_or_copy(found, selection))]
    # QGIS cannot read it. The program may, as the files of the base map of Japan; otherwise it says what is wrong.
    path = asked.algorithm.parameterAsString({**asked.parameters, name: value}, name, asked.context)
    return [(flag, path)]


# Files that the program writes.


def vector_output(flag, label, kind, name="OUTPUT", optional=False, **more):
    define = lambda: QgsProcessingParameterVectorDestination(
        name, label, kind, optional=optional, createByDefault=not optional
    )
    return Output(name, flag, define, **more)


def raster_output(flag, label, name="OUTPUT", optional=False, **more):
    define = lambda: QgsProcessingParameterRasterDestination(
        name, label, optional=optional, createByDefault=not optional
    )
    return Output(name, flag, define, **more)


def file_output(flag, label, files, name=None, optional=True, **more):
    """A file that is no layer. `files` is the filter of the file dialog."""
    name = name or name_of(flag)
    define = lambda: QgsProcessingParameterFileDestination(
        name, label, files, optional=optional, createByDefault=not optional
    )
    return Output(name, flag, define, is_layer=False, **more)
