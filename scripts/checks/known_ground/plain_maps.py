"""Maps of contours, lakes and spot heights."""
import numpy as np
import shapely

from . import checks
from . import ground as grounds
from .map import Map, write_area, write_lines


def whole(ground, folder, random):
    lines, levels = ground.contours()
    write_lines(folder / "in.gpkg", lines, levels)
    return Map(lines, levels, ground, shapely.convex_hull(shapely.multilinestrings(list(lines))))


def rectangle(ground, folder, random):
    """The box around the contours as frame."""
    found = whole(ground, folder, random)
    box = shapely.box(*shapely.total_bounds(found.lines))
    return Map(found.lines, found.levels, ground, box, ["--frame", "bbox"])


def rectangle_as_polygon(ground, folder, random):
    """The rectangle of the ground as a polygon."""
    found = whole(ground, folder, random)
    write_area(folder / "area.gpkg", ground.box)
    return Map(found.lines, found.levels, ground, ground.box, ["--frame", "area.gpkg"])


def district(ground, folder, random, option="--frame"):
    area = grounds.star(random, ground.box)
    lines, levels = grounds.cut(*ground.contours(), area)
    write_lines(folder / "in.gpkg", lines, levels)
    write_area(folder / "area.gpkg", area)
    return Map(lines, levels, ground, area, [option, "area.gpkg"])


def clipped_district(ground, folder, random):
    """The whole map, of which the district is wanted."""
    found = whole(ground, folder, random)
    area = grounds.star(random, ground.box)
    write_area(folder / "area.gpkg", area)
    hull = shapely.convex_hull(shapely.multilinestrings(list(found.lines)))
    lines, levels = grounds.cut(found.lines, found.levels, area)
    return Map(
        lines, levels, ground, shapely.intersection(area, hull), ["--clip", "area.gpkg"], original=(found.lines, found.levels)
    )


def district_with_spots(ground, folder, random):
    found = district(ground, folder, random)
    return with_spots(found, folder, random)


def whole_with_spots(ground, folder, random):
    return with_spots(whole(ground, folder, random), folder, random)


def with_spots(found, folder, random):
    """Heights of the ground at some of its cells, not too near to a contour."""
    x, y = found.ground.centres()
    share = np.abs(found.ground.heights / found.ground.interval % 1.0 - 0.5)
    inside = shapely.contains_xy(shapely.buffer(found.area, -found.ground.cell), x, y) & (share < 0.4)
    cells = np.flatnonzero(inside)
    cells = random.choice(cells, min(len(cells), 30), replace=False)
    found.spots = np.column_stack([a.ravel()[cells] for a in (x, y, found.ground.heights)])
    np.savetxt(folder / "spots.csv", found.spots, "%.17g", ",", header="x,y,z", comments="")
    found.options = [*found.options, "--points", "spots.csv"]
    return found


def sheets(ground, folder, random, digits=None):
    """Four sheets whose lines end on their common edges."""
    found = whole(ground, folder, random)
    west, south, east, north = ground.box.bounds
    x, y = west + random.uniform(0.3, 0.7) * (east - west), south + random.uniform(0.3, 0.7) * (north - south)
    corners = [(west, south, x, y), (x, south, east, y), (west, y, x, north), (x, y, east, north)]
    inputs, all_lines, all_levels = [], [], []
    for number, box in enumerate(corners):
        lines, levels = grounds.cut(found.lines, found.levels, shapely.box(*box))
        if digits is not None:
            lines = shapely.transform(lines, lambda points: np.round(points, digits))
        if len(lines):
            inputs.append(f"sheet{number}.gpkg")
            write_lines(folder / inputs[-1], lines, levels)
            all_lines.append(lines)
            all_levels.append(levels)
    sheet = Map(np.concatenate(all_lines), np.concatenate(all_levels), ground, found.area.buffer(-0.01), inputs=inputs)
    sheet.runs = [["dem", "in.gpkg", "--like", "ground.tif", "-o", "whole.tif"]]
    sheet.checks = {"sheets": checks.unlike_whole}
    return sheet


def sheets_in_millimetres(ground, folder, random):
    return sheets(ground, folder, random, 3)


def lake(ground, folder, random):
    """A lake between two levels, whose contours are cut out."""
    water = grounds.lake(ground, random)
    if water is None:
        return None
    outline, level = water
    x, y = ground.centres()
    ground.heights = np.where(shapely.contains_xy(outline, x, y), np.minimum(ground.heights, level), ground.heights)
    lines, levels = ground.contours()
    kept = shapely.difference(lines, outline)
    parts, owners = shapely.get_parts(kept, return_index=True)
    good = (shapely.get_type_id(parts) == 1) & (shapely.length(parts) > 0)
    lines, levels = parts[good], levels[owners[good]]
    write_lines(folder / "in.gpkg", lines, levels)
    write_area(folder / "lake.gpkg", outline, level)
    hull = shapely.convex_hull(shapely.multilinestrings(list(lines)))
    return Map(lines, levels, ground, hull, ["--water", "lake.gpkg"], lake=water)


def two_steps(ground, folder, random):
    """A district whose lines are made denser twice."""
    found = district(ground, folder, random)
    found.steps = 2
    return found


def two_clipped_steps(ground, folder, random):
    found = clipped_district(ground, folder, random)
    found.steps = 2
    return found
