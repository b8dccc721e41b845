"""Volumes above and below a level, or between two surfaces."""
from .. import shared
from ..options import distance, field, file_output, map_layer, number, raster, text
from ..verb import CHECKS, Verb


class Volume(Verb):
    command = "volume"
    title = "Volumes: cut and fill, storage of a reservoir"
    place = CHECKS
    keywords = ("volume", "cut", "fill", "earthwork", "reservoir", "storage", "level", "dem", "contour")
    about = """
Measures volumes between two height maps: the cut, where A is higher than B, and the fill, where it is lower. With a level, the cut \
is the ground of A above it, and the fill is the space below it. Each of A and B can be contour lines as well.

The log has the figures and their errors. With many levels, the table and the picture are the storage curve of a reservoir.
"""
    options = [
        map_layer("", "A: height map or contour lines", name="A"),
        map_layer("", "B: what A is compared with", name="B", optional=True),
        field("--elevation-field", "Elevation field of contours", "A"),
        number("--level", "Level [m]"),
        text("--levels", "Many levels: lowest, highest and step", help="For instance 700:760:1, or a list. Not together with one level."),
        shared.CLIP._replace(help="Only the ground inside counts.", advanced=False),
        distance("--cell", "For contours alone: cell size", unless=["LIKE", "CELL_DEGREES"], advanced=True),
        raster("--like", "For contours alone: height map with the same grid", advanced=True),
        shared.CELL_DEGREES,
        shared.HEIGHT_SIGMA,
        *[option._replace(advanced=True) for option in shared.TERRAIN],
        *shared.SHIFT,
        *shared.SURFACE,
        *shared.CLEANING,
        shared.TO_UNIT,
        file_output("--output", "Table", shared.TABLE),
        file_output("--output", "Picture of the storage curve", shared.CHART, name="PICTURE"),
    ]
