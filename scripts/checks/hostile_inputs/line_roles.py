"""Lines in every role beside contours: streams, break lines, cliffs, coasts, sinks."""
import math

from hostile_inputs.case import DENSIFY, Case
from hostile_inputs.maps import collection, hill, line, point, polygon, putter, ring

LINES = {
    "none": [],
    "a point": [line([[1, 1]])],
    "the same point": [line([[1, 1]] * 50)],
    "not numbers": [line([[1, 1], [None, 3], ["x", "y"]])],
    "far away": [line([[-1e300, 0], [1e300, 1]])],
    "across everything and back": [line([[-300 + 600 * (k % 2), -60 + 0.01 * k] for k in range(10_000)])],
    "up and down across one contour": [line([[-99 + 0.01 * k, 0.1 * k % 2 + 40 * (k % 2)] for k in range(10_000)])],
    "a spiral": [line([[0.01 * k * math.cos(0.1 * k), 0.01 * k * math.sin(0.1 * k)] for k in range(10_000)])],
    "ten thousand at one place": [line([[0, 0], end]) for end in ring(90, 10_000)[1:]],
    "the same line a thousand times": [line([[0, 0], [50, 50], [90, 0]])] * 1000,
    "loops": [line(ring(10 + k)) for k in range(100)],
    "along contours": [line(ring(100 - 20 * k)[:30]) for k in range(4)],
    "points": [point(1, 2)],
    "polygons": [polygon(ring(30 + k)) for k in range(50)],
    "a polygon of zeros": [polygon([[0, 0]] * 5)],
    "wild heights": [line([[-90, 0, 1e300], [0, 5, -1e300], [90, 0, 15]]), line([[0, -90, 25], [5, 0, 1e-300], [0, 90, 35]])],
    "half of the map twice": [line(ring(90)[:21]), line(ring(90)[20:]), line(ring(90)[:21])],
    "a line through the middle of everything": [line([[-100, 0, 0], [100, 0, 40]])],
    "empty geometries": [{"type": "Feature", "properties": {}, "geometry": None}, line([])],
    "lines in lines": [{"type": "Feature", "properties": {}, "geometry": {"type": "GeometryCollection", "geometries": [line(ring(30))["geometry"]] * 3}}],
    "degrees": [line([[139.1, 35.2], [139.2, 35.3]])],
    "heights that contradict each other": [line([[k - 50, -90, 15], [50 - k, 90, 38]]) for k in range(100)],
}

ROLES = ("streams", "breaklines", "cliffs", "coast", "sinks")


def cases():
    for name, lines in LINES.items():
        write = putter(hill=collection(hill()), lines=collection(lines))
        for option in ROLES:
            yield Case(f"{option}: {name}", write, DENSIFY.format(f"hill.geojson --{option} lines.geojson"))
        yield Case(f"check: {name}", write, "check hill.geojson --streams lines.geojson --breaklines lines.geojson --cliffs lines.geojson -o out.gpkg")
