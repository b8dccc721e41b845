"""Contour lines at a finer interval."""
from .. import shared
from ..options import LINES, distance, vector_output, yes
from ..verb import CONTOURS, Verb


class Densify(Verb):
    command = "densify"
    title = "Densify contours"
    place = CONTOURS
    keywords = ("contour", "interval", "interpolate", "isolines", "elevation", "terrain")
    about = """
Makes contour lines at a finer interval. The contours of the input stay as they are, vertex for vertex. No lines cross.

Each line has its elevation (elev), its source (input or interpolated), and whether it is an index contour (is_index), a \
depression contour (depression) and closed (closed).

Streams, lakes, break lines and spot heights shape the ground between the contours. If the interval is coarser than that of \
the input, only the lines at its levels are written.
"""
    options = [
        *shared.CONTOURS,
        shared.INTERVAL,
        *shared.TERRAIN,
        *shared.PART,
        shared.UNCERTAINTY,
        shared.LEVELS,
        shared.LEVEL_BASE,
        shared.INDEX,
        shared.LABELS,
        *shared.FOR_MAP,
        yes("--keep-input", "Keep all contours of the input where the interval is coarser", advanced=True),
        distance(
            "--simplify",
            "Leave out vertices of new contours within this distance of the line",
            advanced=True,
            help="0 keeps all vertices. If it is empty, 1 % of the mean spacing of the contours. No lines cross by it.",
        ),
        shared.TO_CRS,
        shared.TO_UNIT,
        shared.TO_DEPTHS,
        *shared.SURFACE,
        *shared.CLEANING,
        vector_output("--output", "Contours", LINES, style="contours"),
        shared.BANDS,
        shared.PREVIEW,
        shared.ZOOMS,
        shared.ATTRIBUTION,
        shared.VIEWER,
        shared.DIAGNOSTICS,
    ]
