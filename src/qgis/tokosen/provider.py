"""The provider: the group of tools in the toolbox, and its setting."""
import pathlib

from processing.core.ProcessingConfig import ProcessingConfig, Setting
from qgis.core import QgsProcessingProvider
from qgis.PyQt.QtGui import QIcon

from . import program
from .verb import TILES
from .verbs import VERBS

ICON = str(pathlib.Path(__file__).parent / "icon.svg")
# What the program writes. It says so itself where a tool writes fewer formats.
VECTOR_EXTENSIONS = ["gpkg", "geojson", "fgb", "shp", "dxf", *TILES]
RASTER_EXTENSIONS = ["tif", "asc", "png", "exr", *TILES]


class Provider(QgsProcessingProvider):
    def id(self):
        return "tokosen"

    def name(self):
        return "tokosen"

    def longName(self):
        return "tokosen (terrain from contour lines)"

    def icon(self):
        return QIcon(ICON)

    def svgIconPath(self):
        return ICON

    def load(self):
        ProcessingConfig.settingIcons[self.name()] = self.icon()
        where = "Program tokosen (empty: it is looked for)"
        ProcessingConfig.addSetting(Setting(self.name(), program.SETTING, where, "", valuetype=Setting.FILE))
        ProcessingConfig.readSettings()
        self.refreshAlgorithms()
        return True

    def unload(self):
        ProcessingConfig.removeSetting(program.SETTING)

    def loadAlgorithms(self):
        for verb in VERBS:
            self.addAlgorithm(verb())

    def supportsNonFileBasedOutput(self):
        """The program writes files, not tables of a database."""
        return False

    def supportedOutputVectorLayerExtensions(self):
        return VECTOR_EXTENSIONS

    def defaultVectorFileExtension(self, hasGeometry=True):
        return VECTOR_EXTENSIONS[0]

    def supportedOutputRasterLayerExtensions(self):
        return RASTER_EXTENSIONS

    def defaultRasterFileExtension(self):
        return RASTER_EXTENSIONS[0]
