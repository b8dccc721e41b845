"""Ridge and canyon lines with heights."""
from .. import shared
from ..options import LINES, vector_output
from ..verb import STRUCTURE, Verb


class Skeleton(Verb):
    command = "skeleton"
    title = "Ridge and canyon lines"
    place = STRUCTURE
    keywords = ("ridge", "canyon", "valley", "thalweg", "drainage", "contour", "skeleton")
    about = """
Makes the lines along spurs, crests, gullies and valley floors from contour lines. The lines have heights.

Each line runs downhill between two neighbouring contours. Its field kind is ridge or canyon. Its heights at both ends are \
upper_z and lower_z. Lines that meet have the same number in network.
"""
    options = [
        *shared.CONTOURS,
        shared.RESOLUTION._replace(advanced=False),
        shared.STREAMS,
        shared.WATER,
        shared.POINTS_WITH_HEIGHT._replace(advanced=True),
        shared.SIGMA,
        *shared.OF_CONTOURS,
        shared.STREAM_TOLERANCE,
        *shared.PART,
        shared.FRAME,
        shared.FRAME_LAYER,
        shared.NO_EXTEND,
        shared.TO_CRS,
        shared.TO_UNIT,
        *shared.CLEANING,
        vector_output("--output", "Ridge and canyon lines", LINES, layer="skeleton", style="skeleton"),
        shared.PREVIEW,
    ]
