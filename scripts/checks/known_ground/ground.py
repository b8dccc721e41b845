"""Random ground on a grid, and its contours."""
import math
from dataclasses import dataclass

import numpy as np
import rasterio
import shapely
from rasterio.transform import from_origin

import terrain

CRS = "EPSG:6677"
INTERVALS = (1.0, 2.0, 2.5, 5.0, 7.0, 10.0, 20.0, 25.0)


@dataclass
class Ground:
    heights: np.ndarray
    transform: rasterio.Affine
    interval: float

    @property
    def cell(self):
        return self.transform.a

    @property
    def box(self):
        """The rectangle between the centres of the outermost cells."""
        rows, cols = self.heights.shape
        x, y = terrain.to_map(self.transform, np.array([rows - 1, 0]), np.array([0, cols - 1]))
        return shapely.box(x[0], y[0], x[1], y[1])

    def centres(self):
        rows, cols = np.indices(self.heights.shape)
        return terrain.to_map(self.transform, rows, cols)

    def contours(self):
        return terrain.contours(self.heights, self.transform, self.interval)

    def write(self, path):
        rows, cols = self.heights.shape
        profile = dict(driver="GTiff", width=cols, height=rows, count=1, dtype="float32", crs=CRS, transform=self.transform)
        with rasterio.open(path, "w", **profile, nodata=-9999.0) as out:
            out.write(self.heights.astype("float32"), 1)


def noise(random, rows, cols, roughness):
    """Heights with a spectrum that falls with a power of the frequency, of variance 1."""
    frequency = np.hypot(np.fft.fftfreq(rows)[:, None], np.fft.rfftfreq(cols)[None, :])
    frequency[0, 0] = np.inf
    spectrum = np.fft.rfft2(random.standard_normal((rows, cols))) * frequency**-roughness
    heights = np.fft.irfft2(spectrum, (rows, cols))
    return (heights - heights.mean()) / heights.std()


def off_levels(heights, interval):
    """Heights as 32-bit numbers, which files hold. None is at a level: contours would meet there."""
    heights = heights.astype(np.float32).astype(float)
    at_level = np.abs(heights / interval - np.round(heights / interval)) < 1e-3
    return np.where(at_level, heights + 2e-3 * interval, heights).astype(np.float32).astype(float)


def ground(random, cells=(60, 300)):
    """Ground with some number of rows and columns, of some roughness, with 6 to 25 levels."""
    rows, cols = random.integers(cells[0], cells[1] + 1, 2)
    roughness = random.uniform(1.6, 2.6)
    # Noise repeats, so only a part of it is taken.
    heights = noise(random, 2 * rows, 2 * cols, roughness)[:rows, :cols]
    interval = float(random.choice(INTERVALS))
    levels = random.uniform(6.0, 25.0)
    heights = (heights - heights.min()) / np.ptp(heights) * levels * interval + random.uniform(0.0, 800.0)
    heights = off_levels(heights, interval)
    cell = float(random.choice([2.0, 5.0, 10.0, 12.5, 25.0]))
    west, north = random.uniform(-80_000, 80_000), random.uniform(-200_000, 60_000)
    west, north = math.floor(west / cell) * cell, math.floor(north / cell) * cell
    return Ground(heights, from_origin(west, north, cell, cell), interval)


def star(random, box):
    """A district: a polygon with some corners at random distances around a point."""
    west, south, east, north = box.bounds
    corners = int(random.integers(9, 40))
    angles = np.sort(random.uniform(0.0, 2.0 * np.pi, corners))
    middle = np.array([west + east, south + north]) / 2.0 + random.uniform(-0.1, 0.1, 2) * [east - west, north - south]
    reach = random.uniform(0.18, 0.45, corners) * min(east - west, north - south)
    area = shapely.Polygon(middle + reach[:, None] * np.column_stack([np.cos(angles), np.sin(angles)]))
    return area if area.is_valid and box.contains(area) else star(random, box)


def cut(lines, levels, area):
    """The parts of lines inside an area, as any GIS cuts them: ends are off its border by a rounding error."""
    parts, owners = shapely.get_parts(shapely.intersection(lines, area), return_index=True)
    are_lines = (shapely.get_type_id(parts) == 1) & (shapely.length(parts) > 0)
    # A GIS keeps a line whole that the border touches; the intersection returns its pieces.
    merged, of = [], []
    for owner in np.unique(owners[are_lines]):
        pieces = parts[are_lines & (owners == owner)]
        joined = shapely.get_parts(shapely.line_merge(shapely.multilinestrings(list(pieces))))
        merged.extend(joined)
        of.extend([levels[owner]] * len(joined))
    return np.array(merged, object), np.array(of)


def lake(ground, random):
    """Floods the ground around its deepest inner place. The lake's outline is the contour at its level."""
    rows, cols = ground.heights.shape
    inner = ground.heights[rows // 5 : -rows // 5, cols // 5 : -cols // 5]
    row, col = np.unravel_index(inner.argmin(), inner.shape)
    bottom = inner[row, col]
    row, col = row + rows // 5, col + cols // 5
    for above in np.linspace(2.3, 0.3, 9):
        level = bottom + above * ground.interval
        if abs(level / ground.interval - round(level / ground.interval)) < 0.05:
            level += 0.1 * ground.interval
        rings, _ = terrain.contours(ground.heights - level, ground.transform, 1e9)
        x, y = terrain.to_map(ground.transform, row, col)
        areas = [shapely.Polygon(r.coords) for r in rings if shapely.is_closed(r) and len(r.coords) > 6]
        around = [a for a in areas if a.is_valid and a.contains(shapely.Point(x, y))]
        if around and ground.box.buffer(-3 * ground.cell).contains(around[0]):
            area = max(around, key=lambda a: a.area)
            islands = [a.exterior for a in areas if a.is_valid and a is not area and area.contains(a)]
            return shapely.Polygon(area.exterior, islands), float(level)
    return None
