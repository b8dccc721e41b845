"""The look of results in QGIS, in the colours of the program's own pictures."""
from qgis.core import (
    Qgis,
    QgsCategorizedSymbolRenderer,
    QgsColorRampShader,
    QgsFillSymbol,
    QgsHillshadeRenderer,
    QgsLabeling,
    QgsLineSymbol,
    QgsMarkerSymbol,
    QgsPalLayerSettings,
    QgsProcessingLayerPostProcessorInterface,
    QgsProperty,
    QgsRasterBandStats,
    QgsRasterDataProvider,
    QgsRasterShader,
    QgsRendererCategory,
    QgsRuleBasedLabeling,
    QgsRuleBasedRenderer,
    QgsSingleBandPseudoColorRenderer,
    QgsSingleSymbolRenderer,
    QgsSymbolLayer,
    QgsTextBufferSettings,
    QgsTextFormat,
    QgsUnitTypes,
)
from qgis.PyQt import sip
from qgis.PyQt.QtGui import QColor

INPUT = "84,48,22"
INTERPOLATED = "186,90,12"
RIDGE = "140,20,120"
CANYON = "0,100,200"
# From the lowest to the highest ground.
TINT = (
    "158,192,158", "182,206,162", "208,219,172", "229,225,184", "237,224,194", "244,232,214", "252,249,243",
)
SEVERITIES = {"error": "215,25,28", "warning": "253,141,60", "note": "44,123,182"}
LANDFORMS = {
    "peak": "166,86,40",
    "ridge-peak": "205,133,80",
    "tableland": "238,207,161",
    "branching": "222,222,190",
    "slope": "182,206,162",
    "valley": "127,188,165",
    "basin": "128,177,211",
    "bottom of a basin": "67,128,178",
    "water": "166,206,227",
}


def line(color, width, style="solid"):
    return QgsLineSymbol.createSimple(
        {"line_color": color, "line_width": str(width), "line_style": style, "capstyle": "round"}
    )


def area(color, border="90,90,90", style="solid"):
    return QgsFillSymbol.createSimple(
        {"color": color, "style": style, "outline_color": border, "outline_width": "0.15"}
    )


def contours(layer):
    """Index contours are thicker and have labels; contours of the input are darker than new ones. Those of a map are drawn by
    their kind."""
    root = QgsRuleBasedRenderer.Rule(None)
    given = "\"source\" = 'input'"
    rules = [
        ("index contour, input", f'"is_index" AND {given}', INPUT, 0.5, "solid"),
        ("index contour", f'"is_index" AND NOT {given}', INTERPOLATED, 0.45, "solid"),
        ("contour, input", f'NOT "is_index" AND {given}', INPUT, 0.25, "solid"),
        ("contour", f'NOT "is_index" AND NOT {given}', INTERPOLATED, 0.15, "solid"),
    ]
    if layer.fields().indexOf("kind") >= 0:
        rules = [
            ("index contour", "\"kind\" = 'index'", INPUT, 0.4, "solid"),
            ("intermediate contour", "\"kind\" = 'intermediate'", INPUT, 0.15, "solid"),
            ("supplementary contour", "\"kind\" = 'supplementary'", INPUT, 0.12, "dash"),
            ("supplementary contour, quarter", "\"kind\" = 'supplementary_quarter'", INPUT, 0.12, "dot"),
        ]
    for label, rule, color, width, style in rules:
        root.appendChild(QgsRuleBasedRenderer.Rule(line(color, width, style), filterExp=rule, label=label))
    layer.setRenderer(QgsRuleBasedRenderer(root))

    labels = QgsRuleBasedLabeling.Rule(None)
    labels.appendChild(QgsRuleBasedLabeling.Rule(elevation_label(), filterExp='"is_index"', description="index contours"))
    layer.setLabeling(QgsRuleBasedLabeling(labels))
    layer.setLabelsEnabled(True)


def elevation_label():
    """The elevation, on the line."""
    text = QgsTextFormat()
    text.setSize(7)
    text.setColor(color_of(INPUT))
    halo = QgsTextBufferSettings()
    halo.setEnabled(True)
    halo.setSize(0.7)
    halo.setColor(QColor(255, 255, 255, 220))
    text.setBuffer(halo)
    settings = QgsPalLayerSettings()
    settings.fieldName = "elev"
    settings.placement = QgsPalLayerSettings.Line
    settings.lineSettings().setPlacementFlags(QgsLabeling.LinePlacementFlag.OnLine)
    settings.repeatDistance = 80
    settings.repeatDistanceUnit = QgsUnitTypes.RenderMillimeters
    settings.setFormat(text)
    return settings


def repaired(layer):
    layer.setRenderer(QgsSingleSymbolRenderer(line(INPUT, 0.25)))


def findings(layer):
    """A colour for each severity; the map tip is the message."""
    symbols = {
        severity: QgsMarkerSymbol.createSimple(
            {"name": "circle", "color": color, "outline_color": "255,255,255", "size": "2.8"}
        )
        for severity, color in SEVERITIES.items()
    }
    layer.setRenderer(categories("severity", symbols))
    layer.setMapTipTemplate("<b>[% \"code\" %]</b><br>[% \"message\" %]")


def regions(layer):
    layer.setRenderer(categories("class", {name: area(color) for name, color in LANDFORMS.items()}))


def bands(layer):
    """The tint by height; water is blue."""
    height, low, high = (f"{of}(coalesce(elev_mid, elev_from, elev_to))" for of in ("", "minimum", "maximum"))
    stops = ", ".join(f"{k / (len(TINT) - 1)}, '{color}'" for k, color in enumerate(TINT))
    share = f"if({high} > {low}, ({height} - {low}) / ({high} - {low}), 0)"
    tint = f"if(\"kind\" = 'ground', ramp_color(create_ramp(map({stops})), {share}), '{LANDFORMS['water']}')"
    symbol = area(LANDFORMS["slope"], border=INPUT)
    symbol.symbolLayer(0).setDataDefinedProperty(QgsSymbolLayer.PropertyFillColor, QgsProperty.fromExpression(tint))
    layer.setRenderer(QgsSingleSymbolRenderer(symbol))


def skeleton(layer):
    layer.setRenderer(categories("kind", {"ridge": line(RIDGE, 0.4), "canyon": line(CANYON, 0.4)}))


def steep(layer):
    layer.setRenderer(QgsSingleSymbolRenderer(area("215,25,28,110", border="165,0,0")))


def outlines(layer):
    layer.setRenderer(QgsSingleSymbolRenderer(area("0,0,0,0", border=CANYON, style="no")))


def categories(field, symbols):
    return QgsCategorizedSymbolRenderer(
        field, [QgsRendererCategory(value, symbol, value) for value, symbol in symbols.items()]
    )


def hillshade(layer):
    """Light from the north-west. Heights are taken as metres, and converted to the unit of the map, for instance degrees."""
    renderer = QgsHillshadeRenderer(layer.dataProvider(), 1, 315, 45)
    if layer.crs().isValid():
        renderer.setZFactor(QgsUnitTypes.fromUnitToUnitFactor(QgsUnitTypes.DistanceMeters, layer.crs().mapUnits()))
    layer.setRenderer(renderer)
    # Resampled before it is shaded. Shades that are resampled later show the edges of the blocks in which QGIS works.
    layer.setResamplingStage(Qgis.RasterResamplingStage.Provider)
    layer.dataProvider().setZoomedInResamplingMethod(QgsRasterDataProvider.ResamplingMethod.Bilinear)
    layer.dataProvider().enableProviderResampling(True)


def slope(layer):
    """Degrees."""
    colors = {0: "255,255,245", 10: "254,227,145", 20: "254,153,41", 30: "204,76,2", 45: "120,20,60", 90: "40,0,40"}
    ramp(layer, list(colors.items()))


def difference(layer):
    """Blue where A is lower, red where A is higher; white is no difference."""
    stats = layer.dataProvider().bandStatistics(1, QgsRasterBandStats.Mean | QgsRasterBandStats.StdDev)
    limit = abs(stats.mean) + 2 * stats.stdDev or 1.0
    colors = {-1: "33,102,172", -1 / 3: "146,197,222", 0: "247,247,247", 1 / 3: "244,165,130", 1: "178,24,43"}
    ramp(layer, [(share * limit, color) for share, color in colors.items()])


def ramp(layer, stops):
    shader = QgsColorRampShader(stops[0][0], stops[-1][0])
    shader.setColorRampType(QgsColorRampShader.Interpolated)
    shader.setColorRampItemList(
        [QgsColorRampShader.ColorRampItem(value, color_of(color), f"{value:.3g}") for value, color in stops]
    )
    function = QgsRasterShader()
    function.setRasterShaderFunction(shader)
    layer.setRenderer(QgsSingleBandPseudoColorRenderer(layer.dataProvider(), 1, function))


def color_of(text):
    return QColor(*map(int, text.split(",")))


STYLES = {
    paint.__name__: paint
    for paint in (contours, repaired, findings, regions, bands, skeleton, steep, outlines, hillshade, slope, difference)
}
# The field that a style needs. A DXF has no fields; then the look stays that of QGIS.
FIELDS = {"contours": "is_index", "findings": "severity", "regions": "class", "bands": "elev_mid", "skeleton": "kind"}


class Processor(QgsProcessingLayerPostProcessorInterface):
    """Gives a layer its look after it is loaded."""

    def __init__(self, style):
        super().__init__()
        self.style = style

    def postProcessLayer(self, layer, context, feedback):
        if self.style not in FIELDS or layer.fields().indexOf(FIELDS[self.style]) >= 0:
            STYLES[self.style](layer)
            layer.triggerRepaint()


# QGIS deletes a processor with the context of its run. Until then Python must hold it, too.
HELD = []


def processor(style):
    """What gives a layer a style after it is loaded."""
    made = Processor(style)
    HELD[:] = [made, *(held for held in HELD if not sip.isdeleted(held))]
    return made
