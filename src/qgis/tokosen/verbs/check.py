"""Faults in contour lines, their places and proposed repairs."""
import os

from .. import shared
from ..options import LINES, POINTS, choice, vector_output
from ..verb import CHECKS, Verb

FINDINGS = vector_output(
    "--output",
    "Findings",
    POINTS,
    name="FINDINGS",
    layer="findings",
    style="findings",
    help="A GeoPackage or GeoJSON file.",
)
REPAIRED = vector_output(
    "--output", "Repaired contours", LINES, name="REPAIRED", optional=True, layer="contours", style="repaired"
)
REPAIR = choice(
    "--repair",
    "Repairs in the repaired contours",
    [
        ("safe", "Safe: what cannot change the meaning of the map"),
        ("all", "All: also elevations, gaps and stray vertices, as the findings propose"),
    ],
    always=True,
)
# Options of the repaired contours alone.
OF_REPAIRED = ("--repair", "--to-unit")


class Check(Verb):
    command = "check"
    title = "Check contours"
    place = CHECKS
    keywords = ("validate", "topology", "errors", "repair", "contour", "quality")
    about = """
Finds faults in contour lines: wrong elevations, missing contours, gaps, crossings, duplicates. Streams, lakes, break lines \
and spot heights that contradict the contours are found too.

Each finding is a point with a code, a severity and a message. An error makes the ground near it wrong. A warning may make \
the ground wrong. A note is worth knowing. Where possible, a finding proposes a repair.

The repaired contours are an output of their own.
"""
    options = [
        *shared.CONTOURS,
        *shared.PART,
        shared.FRAME,
        shared.FRAME_LAYER,
        shared.NO_EXTEND,
        shared.STREAMS,
        shared.WATER,
        shared.BREAK_LINES,
        shared.POINTS_WITH_HEIGHT,
        REPAIR,
        shared.SIGMA,
        *shared.OF_CONTOURS,
        shared.STREAM_TOLERANCE,
        shared.UNIT,
        shared.PLANE_UNIT,
        shared.DEPTHS,
        shared.WORK_CRS,
        shared.SNAP,
        shared.TO_CRS,
        shared.TO_UNIT._replace(help="For the repaired contours. Findings are in metres."),
        FINDINGS,
        REPAIRED,
    ]

    def processAlgorithm(self, parameters, context, feedback):
        """Runs the program once for each output: it writes the findings or the repaired contours."""
        outputs = self.paths(parameters, context)
        new = [path for path in outputs.values() if not os.path.exists(path)]
        values = {}
        for wanted in outputs or [None]:
            pairs = [pair for pair in self.pairs if wanted == REPAIRED or pair[0] not in OF_REPAIRED]
            these = {wanted: outputs[wanted]} if wanted else {}
            if not these:
                pairs = [pair for pair in pairs if pair[0] != "--to-crs"]
            summary = self.run_program(pairs, these, feedback)
            if summary is None:
                # The first output may be there already.
                for path in filter(os.path.exists, new):
                    os.remove(path)
                return self.cancelled(outputs, context)
            values.update(self.results(these, summary, context))
        return values
