"""Contour lines of a height map."""
from .. import shared
from ..options import LINES, POLYGONS, distance, extent, layer, raster, vector_output
from ..verb import CONTOURS, Verb


class Contour(Verb):
    command = "contour"
    title = "Contours of a height map"
    place = CONTOURS
    keywords = ("contour", "isolines", "dem", "dtm", "raster", "elevation")
    about = """
Makes contour lines of a height map (DEM). The lines are smooth, have few vertices, and never cross or touch each other.

A line is nowhere farther from the exact contour than the tolerance. Each line has its elevation (elev), and whether it is an \
index contour (is_index), a depression contour (depression) and closed (closed).
"""
    options = [
        raster("", "Height map", name="INPUT", optional=False),
        shared.INTERVAL,
        shared.LEVELS,
        shared.LEVEL_BASE,
        shared.INDEX,
        shared.LABELS,
        *shared.FOR_MAP,
        distance(
            "--tolerance",
            "Largest distance from the exact contour",
            parent="INPUT",
            advanced=True,
            help="If it is empty, half a cell. Beyond about one cell it has no more effect.",
        ),
        distance(
            "--smooth",
            "Smooth the heights first: standard deviation of the Gaussian",
            parent="INPUT",
            advanced=True,
            help="For noisy height maps. Two or three times the cell size is a good start.",
        ),
        extent("--extent", "Extent", help="Only this part of the map is written. The heights around it still count."),
        layer(
            "--clip",
            "Clip to polygons",
            POLYGONS,
            advanced=True,
            help="Only the part inside is written. The heights around it still count.",
        ),
        layer(
            "--frame",
            "Polygon as outer border",
            POLYGONS,
            advanced=True,
            help="Cells whose centres lie outside of it are no ground.",
        ),
        *shared.SHIFT,
        shared.TO_CRS,
        shared.TO_UNIT,
        shared.TO_DEPTHS,
        vector_output("--output", "Contours", LINES, style="contours"),
        shared.BANDS,
        shared.PREVIEW,
        shared.ZOOMS,
        shared.ATTRIBUTION,
        shared.VIEWER,
    ]
