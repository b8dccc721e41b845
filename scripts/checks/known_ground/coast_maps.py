"""Maps of coasts: ground below 0 is sea."""
import numpy as np
import shapely
from scipy.ndimage import label

from . import checks
from . import ground as grounds
from .map import Map, write_area, write_lines


def coast(ground, folder, random, way="level"):
    """Contours from 0 up, of which those at 0 are the coast, in a frame that shows sea too."""
    heights = ground.heights - np.quantile(ground.heights, random.uniform(0.1, 0.5))
    ground.heights = grounds.off_levels(heights, ground.interval)
    lines, levels = ground.contours()
    lines, levels = lines[levels >= 0], levels[levels >= 0]
    if len(np.unique(levels)) < 3:
        return None
    ground.heights = np.maximum(ground.heights, 0.0)
    write_area(folder / "area.gpkg", ground.box)
    options = {"level": ["--coast", "0"], "file": ["--coast", "coast.gpkg"], "sea": ["--sea", "0"]}[way]
    at_coast = levels == 0
    if way == "file":
        write_lines(folder / "coast.gpkg", lines[at_coast], None)
        write_lines(folder / "in.gpkg", lines[~at_coast], levels[~at_coast])
    else:
        write_lines(folder / "in.gpkg", lines, levels)
    found = Map(lines, levels, ground, ground.box, [*options, "--frame", "area.gpkg"])
    found.checks = {"coast": checks.wrong_side_of_coast}
    if way == "sea":
        found.unknown = without_contours(ground)
    return found


def without_contours(ground):
    """Land on which no contour but the coast lies. --sea takes it for sea, because it reaches down to the coast only."""
    land, _ = label(ground.heights > 0, np.ones((3, 3)))
    low = np.setdiff1d(np.unique(land), np.unique(land[ground.heights > ground.interval]))
    rows, cols = np.nonzero(np.isin(land, low[low > 0]))
    x, y = ground.centres()
    half = 1.5 * ground.cell
    x, y = x[rows, cols], y[rows, cols]
    return shapely.union_all(shapely.box(x - half, y - half, x + half, y + half)) if len(x) else None


def coast_of_file(ground, folder, random):
    return coast(ground, folder, random, "file")


def sea(ground, folder, random):
    return coast(ground, folder, random, "sea")
