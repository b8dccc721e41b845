"""Slope, aspect, hillshade, steep places, flow of water, catchments, streams and floods."""
from .. import shared
from ..options import (
    LINES,
    POINTS,
    POLYGONS,
    choice,
    distance,
    field,
    layer,
    map_layer,
    number,
    raster,
    raster_output,
    text,
    vector_output,
    yes,
)
from ..verb import HEIGHT_MAPS, Verb

FOR_CONTOURS = "Only for contours: a height map has its own cells."


class Derive(Verb):
    command = "derive"
    title = "Slope, hillshade, steep places, flow of water, floods"
    place = HEIGHT_MAPS
    keywords = ("slope", "aspect", "hillshade", "steep", "flow", "accumulation", "watershed", "catchment", "stream", "flood", "dem")
    about = """
Makes maps of slope, aspect, hillshade, steep places, flow of water, catchments, streams and floods. The input is a height map, or contour \
lines with a cell size. Choose the results that you want; by default, only the slope is made.

Slope and aspect are in degrees (Horn's method). Water flows to one of the eight cells around (D8); pits are flooded, so that \
all water reaches an outlet at the border. With outlets, only the catchments above these points are made. Each point moves to \
the largest stream within the distance that you set. A flood is the depth of water below a level, from the edge of the map or \
from points; or, for a level such as +3, within 3 m above the streams.

Steep places are areas with at least the slope and the height that you set. The result is no survey: contours 10 m apart \
cannot show a slope of 5 m height.
"""
    options = [
        map_layer("", "Height map or contour lines", name="INPUT"),
        field("--elevation-field", "For contours: elevation field", "INPUT"),
        distance("--cell", "For contours: cell size", unless=["LIKE", "CELL_DEGREES"], help=FOR_CONTOURS),
        raster("--like", "For contours: height map with the same grid", help=FOR_CONTOURS),
        number("--steep-angle", "Minimum slope of a steep place [degrees]", default=30),
        number("--steep-height", "Minimum height of a steep place [m]", default=5),
        number("--azimuth", "Hillshade: azimuth of the light [degrees]", default=315, advanced=True),
        number("--altitude", "Hillshade: altitude of the light [degrees]", default=45, advanced=True),
        number("--z-factor", "Hillshade: factor on heights", default=1, advanced=True),
        yes("--multidirectional", "Hillshade: light from four directions", advanced=True),
        layer("--outlet", "Catchments: outlets", POINTS),
        number("--outlet-snap", "Catchments: outlets move to a stream within [m]", advanced=True),
        number("--threshold", "Streams begin at this upstream area [m²]"),
        text("--flood-level", "Flood: level of the water [m], or +H above the streams"),
        layer("--flood-from", "Flood: points where the water comes from", POINTS, advanced=True),
        text(
            "--flood-bands",
            "Flood: part the areas at these depths [m]",
            advanced=True,
            help="Separated by commas, for instance 0.5,1,2. The fields depth_from and depth_to tell the parts apart.",
        ),
        choice(
            "--accumulation-unit", "Flow accumulation: unit", [("cells", "cells"), ("m2", "square metres")], advanced=True
        ),
        *[option._replace(advanced=True) for option in shared.TERRAIN],
        *[option._replace(advanced=True) for option in shared.PART],
        shared.BASE,
        shared.BASE_FADE,
        *shared.SHIFT,
        shared.CELL_DEGREES,
        shared.TO_CRS,
        *shared.SURFACE,
        *shared.CLEANING,
        shared.COG,
        raster_output("--slope", "Slope", name="SLOPE", style="slope"),
        raster_output("--aspect", "Aspect", name="ASPECT", optional=True),
        raster_output("--hillshade", "Hillshade", name="HILLSHADE", optional=True),
        raster_output("--flow-direction", "Flow direction", name="FLOW_DIRECTION", optional=True),
        raster_output("--flow-accumulation", "Flow accumulation", name="FLOW_ACCUMULATION", optional=True),
        vector_output("--steep", "Steep places", POLYGONS, name="STEEP", optional=True, layer="steep", style="steep"),
        vector_output(
            "--catchments", "Catchments", POLYGONS, name="CATCHMENTS", optional=True, layer="catchments", style="outlines"
        ),
        vector_output("--stream-lines", "Streams", LINES, name="STREAM_LINES", optional=True, layer="stream_lines"),
        raster_output("--flood", "Flood: depth of water", name="FLOOD", optional=True),
        vector_output(
            "--flood",
            "Flood: areas with their volume",
            POLYGONS,
            name="FLOOD_AREAS",
            optional=True,
            layer="flood",
            help="Instead of the depth of water: a run makes one of them.",
        ),
    ]
