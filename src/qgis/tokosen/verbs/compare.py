"""Differences between two height maps or surfaces of contours."""
from .. import shared
from ..options import distance, field, file_output, map_layer, number, raster, raster_output
from ..verb import CHECKS, Verb


class Compare(Verb):
    command = "compare"
    title = "Compare height maps or contours"
    place = CHECKS
    keywords = ("accuracy", "difference", "error", "rmse", "dem", "contour", "validation")
    about = """
Measures the differences A - B of two height maps, in metres. Each of them can be contour lines as well: the surface of the \
contours is then compared.

The report has maps, charts and tables. The log has the figures: bias, RMSE, MAE, median, NMAD, LE90, LE95, by slope, by \
elevation and by the distance to the nearest contour.

Two height maps may have different grids: A is interpolated at the cell centres of B. If both A and B are contours, set the \
cell size or a height map with the same grid.
"""
    options = [
        map_layer("", "A: height map or contour lines to measure", name="A"),
        map_layer("", "B: reference height map or contour lines", name="B"),
        field("--elevation-field", "Elevation field of contours", "A"),
        distance("--cell", "For contours alone: cell size", unless=["LIKE", "CELL_DEGREES"], advanced=True),
        raster("--like", "For contours alone: height map with the same grid", advanced=True),
        shared.CELL_DEGREES,
        number(
            "--sigma",
            "Stated accuracy of B, as a standard deviation [m]",
            help="It decides which differences are significant.",
        ),
        number(
            "--interval",
            "Interval at whose levels height maps are searched for terraces [m]",
            advanced=True,
            help="If it is empty, that of the contours, otherwise usual intervals.",
        ),
        *[option._replace(advanced=True) for option in shared.TERRAIN if option.name != "POINTS"],
        shared.POINTS_WITH_HEIGHT._replace(help="Check points: A and B are compared with them too.", advanced=True),
        *shared.SHIFT,
        *shared.SURFACE,
        *shared.CLEANING,
        raster_output("--output", "Differences A - B", style="difference"),
        file_output("--report", "Report", shared.PAGE, optional=False),
        file_output("--page", "Page in 3-D", shared.PAGE),
        file_output("--preview", "Map of the differences on paper", shared.PAPER, advanced=True),
    ]
