"""Layers of all kinds reach the program as files, with the same coordinates. Started by run.py."""
import json
import os

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsFeature,
    QgsFeatureRequest,
    QgsGeometry,
    QgsProcessingFeatureSourceDefinition,
    QgsProject,
    QgsRasterLayer,
    QgsVectorFileWriter,
    QgsVectorLayer,
)

from inside import Case
from installed import CONTOURS, HEIGHTS, NESTED, command
from outputs import content, rows

# Importable after the module inside.
from tokosen import inputs  # noqa: E402


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
        made = self.densify(layer, interval=20, BASE_LEVEL=1, ELEVATION_FIELD="elev")
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
