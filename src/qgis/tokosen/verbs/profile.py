"""Heights along lines, and on sections across them."""
from .. import shared
from ..options import LINES, distance, field, file_output, layer, map_layer, number
from ..verb import CHECKS, Verb


class Profile(Verb):
    command = "profile"
    title = "Profile along lines"
    place = CHECKS
    keywords = ("profile", "section", "cross section", "heights", "line", "road", "dem", "contour")
    about = """
Takes the heights of one or two height maps along lines, or on sections across them. Each of them can be contour lines as well: \
the surface between contours is then taken at each place itself.

The table has a row for each place: number of the line, section, distance, x, y, height and standard error. The picture shows \
both surfaces.
"""
    options = [
        map_layer("", "A: height map or contour lines", name="A"),
        map_layer("", "B: another height map or contour lines, in the same picture", name="B", optional=True),
        field("--elevation-field", "Elevation field of contours", "A"),
        layer("--line", "Lines", LINES, optional=False),
        distance("--step", "Greatest distance between places"),
        distance("--sections", "Sections across the lines, this far apart"),
        distance("--width", "Width of the sections"),
        number("--exaggeration", "Picture: factor on heights", advanced=True),
        shared.HEIGHT_SIGMA,
        *[option._replace(advanced=True) for option in shared.TERRAIN],
        *shared.SHIFT,
        *shared.SURFACE,
        *shared.CLEANING,
        shared.TO_UNIT,
        file_output("--output", "Table", shared.TABLE, optional=False),
        file_output("--output", "Picture", shared.CHART, name="PICTURE"),
    ]
