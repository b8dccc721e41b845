"""The kinds of maps."""
from .coast_maps import coast, coast_of_file, sea
from .line_maps import broken_cliffs, cliffs, excluded, ridges, ridges_with_heights, streams
from .plain_maps import (
    clipped_district, district, district_with_spots, lake, rectangle, rectangle_as_polygon, sheets, sheets_in_millimetres,
    two_clipped_steps, two_steps, whole, whole_with_spots,
)  # fmt: skip
from .system_maps import base, degrees, district_in_degrees, feet, feet_in_metres

KINDS = [
    whole, whole_with_spots, rectangle, rectangle_as_polygon, district, district_with_spots, clipped_district, sheets,
    sheets_in_millimetres, lake, two_steps, two_clipped_steps, streams, ridges, ridges_with_heights, cliffs, broken_cliffs, coast,
    coast_of_file, sea, excluded, base, feet, feet_in_metres, degrees, district_in_degrees,
]  # fmt: skip

# Kinds in which some maps have faults still. --quick leaves them out.
FAULTY = [
    sheets_in_millimetres, streams, ridges_with_heights, broken_cliffs, coast, coast_of_file, sea, excluded,
]  # fmt: skip

QUICK = [kind for kind in KINDS if kind not in FAULTY]
