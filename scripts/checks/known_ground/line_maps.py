"""Maps with lines beside the contours: streams, break lines, cliffs."""
import numpy as np
import shapely

from . import checks, flow
from . import ground as grounds
from .map import Map, write_area, write_lines
from .plain_maps import whole


def streams(ground, folder, random):
    """Streams along the true valleys. The ground has no pits: its contours would contradict the streams in them. Where pits
    were filled, it has no valleys either."""
    dry = flow.filled(ground.heights, 5e-3 * ground.interval)
    sound = dry == ground.heights
    ground.heights = grounds.off_levels(dry, ground.interval)
    found = whole(ground, folder, random)
    cells = [part for line in flow.valleys(ground.heights) for part in flow.pieces(line, sound)]
    lines = [flow.on_map(line[:: int(random.choice([-1, 1]))], ground.transform) for line in cells]
    if not lines:
        return None
    write_lines(folder / "streams.gpkg", lines, None)
    # From cell to cell, a line is within that of the bends of contours.
    found.options = ["--streams", "streams.gpkg", "--stream-tolerance", 1.5 * ground.cell, "--diagnostics", "diagnostics.gpkg"]
    found.checks = {"rises": checks.rises}
    return found


def ridges(ground, folder, random, with_heights=False):
    """Break lines along the true ridges."""
    found = whole(ground, folder, random)
    cells = flow.valleys(flow.filled(-ground.heights, 1e-6 * ground.interval))
    if not cells:
        return None
    heights = ground.heights if with_heights else None
    lines = [flow.on_map(line, ground.transform, heights) for line in cells]
    if with_heights:
        spots = shapely.get_coordinates(lines, include_z=True)
        share = np.abs(spots[:, 2] / ground.interval % 1.0 - 0.5)
        found.spots = spots[(share < 0.4) & shapely.contains_xy(found.area.buffer(-ground.cell), spots[:, 0], spots[:, 1])]
        lines = [flow.with_contours(line, found.lines, found.levels) for line in lines]
    kinds = {"kind": np.array(["ridge"] * len(lines), object)} if random.random() < 0.5 else {}
    write_lines(folder / "ridges.gpkg", lines, None, **kinds)
    found.options = ["--breaklines", "ridges.gpkg"]
    return found


def ridges_with_heights(ground, folder, random):
    return ridges(ground, folder, random, True)


def cliffs(ground, folder, random, broken=False):
    """A step of the ground along a line. Contours run together in it."""
    west, south, east, north = ground.box.bounds
    size = min(east - west, north - south)
    middle = np.array([west + east, south + north]) / 2.0 + random.uniform(-0.1, 0.1, 2) * size
    turn, length = random.uniform(0.0, 2.0 * np.pi), random.uniform(0.2, 0.35) * size
    along, across = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
    bend = random.uniform(0.0, 0.1) * size

    def bow(u):
        return bend * np.cos(0.5 * np.pi * u / length)

    x, y = ground.centres()
    u, v = ((x - middle[0]) * d[0] + (y - middle[1]) * d[1] for d in (along, across))
    v = v - bow(u)
    # The step ends at the ends of the line, and the ground above it falls away slowly.
    step = random.uniform(2.0, 5.0) * ground.interval * np.clip(1.0 - (u / length) ** 2, 0.0, None)
    ground.heights = grounds.off_levels(ground.heights + np.where(v > 0, step * np.exp(-v / (0.5 * size)), 0.0), ground.interval)
    at = np.linspace(-length, length, 60)
    cliff = shapely.linestrings(middle + at[:, None] * along + bow(at)[:, None] * across)
    lines, levels = ground.contours()
    unknown = None
    if broken:
        # The cliff explains ends of contours that are nearer to it than half of the mean spacing.
        gap = min(1.5 * ground.cell, 0.4 * ground.box.area / shapely.length(lines).sum())
        lines, levels = grounds.cut(lines, levels, ground.box.buffer(ground.cell).difference(cliff.buffer(gap)))
        unknown = cliff.buffer(gap + 1.5 * ground.cell)
    write_lines(folder / "in.gpkg", lines, levels)
    write_lines(folder / "cliffs.gpkg", [cliff], None)
    found = Map(lines, levels, ground, None, ["--cliffs", "cliffs.gpkg"], unknown=unknown)
    found.covers(lines)
    return found


def broken_cliffs(ground, folder, random):
    """A cliff at which contours end."""
    return cliffs(ground, folder, random, True)


def excluded(ground, folder, random):
    """A part of the map is left out."""
    found = whole(ground, folder, random)
    inner = shapely.affinity.scale(ground.box, 0.6, 0.6)
    hole = grounds.star(random, inner)
    write_area(folder / "hole.gpkg", hole)
    whole_lines = found.lines, found.levels
    found.lines, found.levels = grounds.cut(*whole_lines, ground.box.difference(hole))
    found.original = whole_lines
    found.options = ["--exclude", "hole.gpkg"]
    found.unknown = hole.buffer(1e-3)
    return found
