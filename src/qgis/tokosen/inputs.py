"""Gives the program the layers of QGIS as files.

A layer that is a file which the program reads is passed by its path. Every other one is written to a temporary file first: one
with a filter, a selection, unsaved edits, joined fields, or another coordinate reference system than its file, and layers of
memory and of databases.
"""
import os

from osgeo import gdal
from qgis.core import (
    QgsCoordinateTransformContext,
    QgsFeatureRequest,
    QgsFeatureSink,
    QgsFields,
    QgsGeometry,
    QgsProcessingException,
    QgsProcessingFeatureSourceDefinition,
    QgsProviderRegistry,
    QgsRasterLayer,
    QgsVectorFileWriter,
    QgsVectorLayer,
    QgsVectorLayerFeatureSource,
    QgsWkbTypes,
)

VECTOR_FILES = (".gpkg", ".shp", ".geojson", ".json", ".fgb")
RASTER_FILES = (".tif", ".tiff", ".asc", ".exr", ".png")
# Name of the column of feature ids in temporary files. A layer may have a usual field with the default name, fid.
ID_COLUMN = "tokosen_id"


class Selection:
    """The part of a layer that the user asked for."""

    def __init__(self, value=None):
        asked = isinstance(value, QgsProcessingFeatureSourceDefinition)
        self.selected_only = asked and value.selectedFeaturesOnly
        self.limit = value.featureLimit if asked else -1
        # QGIS 3.32 and later.
        self.expression = getattr(value, "filterExpression", "") if asked else ""

    def is_all(self):
        return not (self.selected_only or self.expression or self.limit >= 0)

    def request(self, layer):
        request = QgsFeatureRequest()
        if self.expression:
            request.setFilterExpression(self.expression)
        if self.selected_only:
            # A request has one filter: an expression becomes the features that fulfil it.
            chosen = set(layer.selectedFeatureIds())
            if self.expression:
                chosen &= {feature.id() for feature in layer.getFeatures(request)}
            request.setFilterFids(sorted(chosen))
        if self.limit >= 0:
            request.setLimit(self.limit)
        return request


def path_or_copy(layer, selection=Selection()):
    """Path of the file of a layer, or a function (folder, feedback) that writes one and returns its path.

    Called in the thread that owns the layer; the function may be called in another one.
    """
    if isinstance(layer, QgsRasterLayer):
        return raster(layer)
    if isinstance(layer, QgsVectorLayer) and layer.isSpatial():
        return vector(layer, selection)
    raise QgsProcessingException(f"The layer {layer.name()} is no vector layer with geometry and no raster layer.")


def vector(layer, selection):
    if selection.is_all():
        path = vector_path(layer)
        if path:
            return path
    name, fields, crs, wkb_type = layer.name(), layer.fields(), layer.crs(), type_with_z(layer)
    source, request = QgsVectorLayerFeatureSource(layer), selection.request(layer)

    def copy(folder, feedback):
        path = free_path(folder, "gpkg")
        write_features(path, name, fields, crs, wkb_type, source.getFeatures(request), feedback)
        return path

    return copy


def vector_path(layer):
    """FILE, or FILE|layername=NAME, if the program reads there what QGIS shows; otherwise None."""
    if layer.providerType() != "ogr" or layer.subsetString() or layer.isModified() or not has_own_crs(layer):
        return None
    fields = layer.fields()
    if any(fields.fieldOrigin(i) != QgsFields.OriginProvider for i in range(fields.count())):
        return None
    parts = QgsProviderRegistry.instance().decodeUri("ogr", layer.source())
    path = parts.get("path") or ""
    if not os.path.isfile(path) or not path.lower().endswith(VECTOR_FILES):
        return None
    # One kind of geometry out of a file with several; curves.
    if "geometrytype=" in layer.source() or QgsWkbTypes.isCurvedType(layer.wkbType()):
        return None
    if not path.lower().endswith(".gpkg"):
        return path
    if parts.get("layerId") is not None:
        return None
    # Without a name, QGIS shows the first layer.
    name = parts.get("layerName") or layer.dataProvider().subLayers()[0].split("!!::!!")[1]
    return f"{path}|layername={name}"


def type_with_z(layer):
    """The type of the geometries. Lines of a drawing have heights even where the layer states none."""
    for feature in layer.getFeatures(QgsFeatureRequest().setLimit(1)):
        if QgsWkbTypes.hasZ(feature.geometry().wkbType()):
            return QgsWkbTypes.addZ(layer.wkbType())
    return layer.wkbType()


def write_features(path, name, fields, crs, wkb_type, features, feedback):
    """Writes features to a GeoPackage with all fields and exact coordinates; curves become lines."""
    options = QgsVectorFileWriter.SaveVectorOptions()
    options.driverName = "GPKG"
    options.layerOptions = [f"FID={ID_COLUMN}"]
    has_curves = QgsWkbTypes.isCurvedType(wkb_type)
    if has_curves:
        wkb_type = QgsWkbTypes.linearType(wkb_type)
    writer = QgsVectorFileWriter.create(path, fields, wkb_type, crs, QgsCoordinateTransformContext(), options)
    try:
        is_whole = writer.hasError() == QgsVectorFileWriter.NoError
        for feature in features if is_whole else ():
            if feedback.isCanceled():
                return
            if has_curves and feature.hasGeometry():
                feature.setGeometry(QgsGeometry(feature.geometry().constGet().segmentize()))
            is_whole = is_whole and writer.addFeature(feature, QgsFeatureSink.FastInsert)
        if not (is_whole and writer.flushBuffer()):
            raise QgsProcessingException(f"The layer {name} cannot be passed: {writer.errorMessage()}")
    finally:
        # The file is closed when its writer is gone.
        del writer


def raster(layer):
    if layer.providerType() != "gdal":
        raise QgsProcessingException(f"The layer {layer.name()} is no file. Save it as a GeoTIFF first.")
    name, source, wkt = layer.name(), layer.source(), layer.crs().toWkt()
    own_crs = has_own_crs(layer)
    if own_crs and os.path.isfile(source) and source.lower().endswith(RASTER_FILES):
        return source

    def copy(folder, feedback):
        path = free_path(folder, "tif")
        options = {} if own_crs else {"outputSRS": wkt}
        try:
            copied = gdal.Translate(path, source, callback=lambda *progress: not feedback.isCanceled(), **options)
        except RuntimeError:
            # GDAL raises errors only if it was told to.
            copied = None
        if copied is None and not feedback.isCanceled():
            raise QgsProcessingException(f"The layer {name} cannot be passed: {gdal.GetLastErrorMsg()}")
        return path

    return copy


def has_own_crs(layer):
    """Whether the coordinate reference system of the layer is that of its file, not another one set in QGIS."""
    return layer.crs() == layer.dataProvider().crs()


def free_path(folder, extension):
    return os.path.join(folder, f"{len(os.listdir(folder)) + 1}.{extension}")
