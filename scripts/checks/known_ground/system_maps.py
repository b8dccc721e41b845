"""Maps in other units and coordinates, and on another height map."""
import dataclasses

import pyproj
import shapely

from . import checks
from . import ground as grounds
from .map import write_area, write_lines
from .plain_maps import district, whole

FEET = {"ft": 0.3048, "us-ft": 1200 / 3937}
DEGREES = ("EPSG:6668", "EPSG:4326")
FADE = 15  # cells


def feet(ground, folder, random):
    """Heights in feet come back in feet."""
    found = whole(ground, folder, random)
    unit = str(random.choice(list(FEET)))
    found.options = ["--unit", unit, "--to-unit", unit]
    return found


def feet_in_metres(ground, folder, random):
    """Heights in feet, of which metres are made."""
    found = whole(ground, folder, random)
    unit = str(random.choice(list(FEET)))
    found.options = ["--unit", unit]
    found.unit = FEET[unit]
    return found


def in_degrees(shapes, crs, back=False):
    to = pyproj.Transformer.from_crs(grounds.CRS, crs, always_xy=True)
    direction = "INVERSE" if back else "FORWARD"
    return shapely.transform(shapes, lambda x, y: to.transform(x, y, direction=direction), interleaved=False)


def degrees(ground, folder, random, crs=None):
    found = whole(ground, folder, random)
    crs = crs or str(random.choice(DEGREES))
    found.lines = in_degrees(found.lines, crs)
    write_lines(folder / "in.gpkg", found.lines, found.levels, crs)
    return found


def district_in_degrees(ground, folder, random):
    """A district that is cut in degrees, where its border is straight; its frame is in degrees too."""
    crs = str(random.choice(DEGREES))
    found = degrees(ground, folder, random, crs)
    frame = in_degrees(grounds.star(random, ground.box), crs)
    found.lines, found.levels = grounds.cut(found.lines, found.levels, frame)
    write_lines(folder / "in.gpkg", found.lines, found.levels, crs)
    write_area(folder / "area.gpkg", frame, crs=crs)
    # The area on the plane has as many vertices as its bent edges need.
    found.area = in_degrees(shapely.segmentize(frame, 1e-5), crs, back=True)
    found.options = ["--frame", "area.gpkg"]
    return found


def base(ground, folder, random):
    """A district, around which the heights come from another height map that lies higher or lower."""
    found = district(ground, folder, random)
    lift = float(random.uniform(-3.0, 3.0) * ground.interval)
    dataclasses.replace(ground, heights=ground.heights + lift).write(folder / "base.tif")
    found.runs = [[
        "dem", "in.gpkg", *found.options, "--base", "base.tif", "--base-fade", FADE * ground.cell, "--like", "ground.tif", "-o",
        "based.tif",
    ]]  # fmt: skip
    found.checks = {"base": checks.wrong_on_base}
    return found
