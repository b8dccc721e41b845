"""The areas between contour lines."""
from .. import shared
from ..options import POLYGONS, vector_output
from ..verb import STRUCTURE, Verb


class Regions(Verb):
    command = "regions"
    title = "Areas between contours, with landforms"
    place = STRUCTURE
    keywords = ("landform", "contour", "peak", "basin", "valley", "polygon", "depression")
    about = """
Makes polygons of the areas between contour lines. They cover the map without gaps.

Each area has its landform (class: peak, bottom of a basin, tableland, basin, ridge-peak, valley, slope, water or branching), \
the levels below and above it (band_lo, band_hi), the area around it (parent) and the number of areas around it (depth).
"""
    options = [
        *shared.CONTOURS,
        shared.WATER,
        *[option._replace(advanced=True) for option in shared.TERRAIN if option.name in ("POINTS", "POINTS_SIGMA")],
        *shared.OF_CONTOURS,
        *shared.PART,
        shared.FRAME,
        shared.FRAME_LAYER,
        shared.NO_EXTEND,
        shared.TO_CRS,
        shared.TO_UNIT,
        *shared.CLEANING,
        vector_output("--output", "Areas", POLYGONS, layer="regions", style="regions"),
        shared.PREVIEW,
    ]
