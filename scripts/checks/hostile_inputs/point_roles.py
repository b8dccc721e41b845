"""Points beside contours: spot heights with standard errors, sinks, check points."""
import math

from hostile_inputs.case import DEM, DENSIFY, Case
from hostile_inputs.maps import collection, hill, point, putter, ring

GRID = [(x, y) for x in range(-90, 91, 6) for y in range(-90, 91, 6)]
POINTS = {
    "none": [],
    "one at 0, 0, 0": [point(0, 0, elev=0)],
    "without heights": [point(1, 2), point(3, 4)],
    "heights of NaN and text": [point(1, 2, elev="NaN"), point(3, 4, elev="high"), point(5, 6, elev=None)],
    "heights of 1e308": [point(1, 2, elev=1e308), point(3, 4, elev=-1e308)],
    "heights of 1e-320": [point(1, 2, elev=1e-320)],
    "a thousand at one place": [point(3, 4, elev=20 + k / 1000) for k in range(1000)],
    "a thousand within a billionth": [point(3 + k * 1e-12, 4, elev=20 + k) for k in range(1000)],
    "on every contour": [point(*p, elev=5) for k in range(4) for p in ring(100 - 20 * k)],
    "near every contour": [point(x * (1 - 1e-12), y, elev=10 * k + 5) for k in range(4) for x, y in ring(100 - 20 * k)],
    "all outside": [point(1000 + k, 1000, elev=5) for k in range(50)],
    "one very far away": [point(1e300, -1e300, elev=5)],
    "a grid of noise": [point(x, y, elev=15 + 30 * math.sin(x * y)) for x, y in GRID],
    "sigma 0": [point(x, y, elev=15, sigma=0) for x, y in GRID],
    "sigma negative": [point(x, y, elev=15, sigma=-1) for x, y in GRID],
    "sigma NaN and text": [point(x, y, elev=15, sigma="NaN" if x > 0 else "wide") for x, y in GRID],
    "sigma 1e300": [point(x, y, elev=15, sigma=1e300) for x, y in GRID],
    "sigma 1e-300": [point(x, y, elev=15 + x / 1000, sigma=1e-300) for x, y in GRID],
    "sigma of every size": [point(x, y, elev=15, sigma=10.0 ** (k % 40 - 20)) for k, (x, y) in enumerate(GRID)],
    "multipoints": [{"type": "Feature", "properties": {"elev": 15}, "geometry": {"type": "MultiPoint", "coordinates": [list(p) for p in GRID]}}],
    "of one coordinate": [{"type": "Feature", "properties": {"elev": 15}, "geometry": {"type": "Point", "coordinates": [1]}}],
    "empty": [{"type": "Feature", "properties": {"elev": 15}, "geometry": {"type": "Point", "coordinates": []}}],
}
COMMANDS = {
    "points": DENSIFY.format("hill.geojson --points points.geojson"),
    "points with sigma": DEM.format("hill.geojson --points points.geojson --points-sigma 0.5"),
    "sinks of points": DEM.format("hill.geojson --drain all --sinks points.geojson"),
    "check points": "compare hill.geojson truth.asc --points points.geojson -o out.tif",
}
TRUTH = "ncols 40\nnrows 40\nxllcorner -100\nyllcorner -100\ncellsize 5\n" + "15 " * 1600


def cases():
    for name, points in POINTS.items():

        def write(folder, points=points):
            putter(hill=collection(hill()), points=collection(points))(folder)
            (folder / "truth.asc").write_text(TRUTH)

        for kind, command in COMMANDS.items():
            yield Case(f"{kind}: {name}", write, command)
