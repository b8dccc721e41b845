"""A height map from contour lines."""
from .. import shared
from ..options import distance, raster_output
from ..verb import HEIGHT_MAPS, Verb


class Dem(Verb):
    command = "dem"
    title = "Height map from contours"
    place = HEIGHT_MAPS
    keywords = ("dem", "dtm", "contour", "interpolate", "raster", "elevation", "terrain", "surface")
    about = """
Makes a height map (DEM) from contour lines. A height is that of the surface at the centre of the cell. Each height lies \
between the contours around it. There are no terraces.

Streams, lakes, break lines and spot heights shape the ground between the contours. Another height map can give the ground \
around them.

The height map is in the coordinate reference system of the contours. If they are in degrees or feet, it is in a projected \
system in metres, or in the one that you choose.
"""
    options = [
        *shared.CONTOURS,
        distance(
            "--cell",
            "Cell size",
            proposed=10,
            unless=["LIKE", "CELL_DEGREES", "MAX_ZOOM"],
            help="In metres. If you choose the coordinate reference system of the result, the number is in its units. For contours "
            "without a coordinate reference system that are in feet, it is in feet.",
        ),
        shared.LIKE,
        *shared.TERRAIN,
        *shared.PART,
        shared.UNCERTAINTY,
        shared.BASE,
        shared.BASE_FADE,
        shared.CELL_DEGREES,
        *shared.SHIFT,
        shared.TO_CRS,
        shared.TO_UNIT,
        *shared.SURFACE,
        *shared.CLEANING,
        shared.COG,
        raster_output("--output", "Height map", style="hillshade"),
        shared.PREVIEW,
        *shared.TERRAIN_TILES,
        shared.ATTRIBUTION,
        shared.VIEWER,
        shared.DIAGNOSTICS,
    ]
