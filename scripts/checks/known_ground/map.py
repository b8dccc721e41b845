"""A map of known ground, and the files that it is given in."""
from dataclasses import dataclass, field

import numpy as np
import pyogrio
import shapely

from . import ground as grounds


@dataclass
class Map:
    """Input files, the options that name them, and what is known of the ground."""

    lines: np.ndarray
    levels: np.ndarray
    ground: grounds.Ground
    area: object  # where there must be heights
    options: list = field(default_factory=list)
    inputs: list = field(default_factory=lambda: ["in.gpkg"])
    spots: np.ndarray = None  # x, y, z
    lake: tuple = None  # outline and level
    steps: int = 1  # how often the lines are densified
    original: tuple = None  # lines and levels whose vertices must stay, if not all of its lines
    unknown: object = None  # where the contours do not tell the band of the ground
    unit: float = 1.0  # of the heights that are written, in that of the ground
    runs: list = field(default_factory=list)  # further commands
    checks: dict = field(default_factory=dict)  # columns, and functions that count faults for them

    def covers(self, lines):
        self.area = shapely.convex_hull(shapely.multilinestrings(list(lines)))


def write_lines(path, lines, levels, crs=grounds.CRS, **fields):
    columns = {"elev": levels, **fields} if levels is not None else fields
    columns = columns or {"number": np.arange(len(lines))}
    pyogrio.raw.write(
        path, shapely.to_wkb(lines), [np.asarray(c) for c in columns.values()], list(columns), crs=crs, driver="GPKG", layer="lines",
        geometry_type="LineString Z" if shapely.has_z(lines).any() else "LineString",
    )  # fmt: skip


def write_area(path, area, level=None, crs=grounds.CRS):
    values, names = ([np.array([level])], ["elev"]) if level is not None else ([], [])
    pyogrio.raw.write(path, np.array([shapely.to_wkb(area)], object), values, names, geometry_type="Polygon", crs=crs, driver="GPKG")
