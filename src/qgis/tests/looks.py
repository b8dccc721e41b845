"""The styles of results. Started by run.py."""
import json
from xml.etree import ElementTree

from qgis.core import (
    QgsCategorizedSymbolRenderer,
    QgsFeatureRequest,
    QgsHillshadeRenderer,
    QgsMapRendererSequentialJob,
    QgsMapSettings,
    QgsProcessingContext,
    QgsProcessingOutputLayerDefinition,
    QgsProcessingUtils,
    QgsProject,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QSize
from qgis.PyQt.QtXml import QDomDocument

from inside import Case
from installed import CONTOURS, HEIGHTS, NESTED, command

# Importable after the module inside.
from tokosen import styles  # noqa: E402


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

    def test_a_geopackage_has_its_own_looks(self):
        lines, bands, flood = (self.folder / f"{name}.gpkg" for name in ("lines", "bands", "flood"))
        kinds = ["-i", "20", "--supplementary", "10,5", "--supplementary-spacing", "300"]
        command("densify", CONTOURS, *kinds, "--bands", bands, "-o", lines)
        command("derive", HEIGHTS, "--flood-level", "330", "--flood-bands", "1,5", "--flood", flood)
        for path, looks in ((bands, {"#9ec09e", "#fcf9f3"}), (flood, {"#deebf7", "#6baed6", "#08519c"})):
            with self.subTest(path.name):
                self.assertEqual(looks - colors_of(QgsVectorLayer(str(path), "layer", "ogr")), set())
        layer = QgsVectorLayer(str(lines), "lines", "ogr")
        self.assertIn("#543016", colors_of(layer))
        found = [number_of_features(layer, rule.get("filter")) for rule in style_of(layer).findall(".//renderer-v2/rules/rule")]
        self.assertEqual(len(found), 4)
        self.assertEqual(sum(found), layer.featureCount())
        self.assertGreater(min(found), 0)

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


def colors_of(layer):
    """The colours of the layer on a map."""
    settings = QgsMapSettings()
    settings.setLayers([layer])
    settings.setExtent(layer.extent())
    settings.setDestinationCrs(layer.crs())
    settings.setOutputSize(QSize(900, 900))
    job = QgsMapRendererSequentialJob(settings)
    job.start()
    job.waitForFinished()
    drawn = job.renderedImage()
    return {drawn.pixelColor(x, y).name() for x in range(drawn.width()) for y in range(drawn.height())}


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
