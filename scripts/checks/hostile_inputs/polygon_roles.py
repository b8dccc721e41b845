"""Polygons beside contours: parts to leave out, lakes, frames, parts of the map, coasts."""
import math

from hostile_inputs.case import DEM, DENSIFY, Case
from hostile_inputs.maps import collection, hill, point, polygon, putter, ring

STAR = [[(90 if k % 2 else 5) * math.cos(k), (90 if k % 2 else 5) * math.sin(k)] for k in range(60)]
COMB = [[x, y] for k in range(200) for x, y in ((k - 100, -90), (k - 100, 90), (k - 99.5, 90), (k - 99.5, -90))]
POLYGONS = {
    "none": [],
    "a polygon of zeros": [polygon([[0, 0]] * 5)],
    "three points in a row": [polygon([[0, 0], [5, 5], [9, 9], [0, 0]])],
    "that is open": [polygon(ring(50)[:-1])],
    "a bow tie": [polygon([[-50, -50], [50, 50], [50, -50], [-50, 50], [-50, -50]])],
    "a star that crosses itself": [polygon(STAR + STAR[:1])],
    "a comb": [polygon(COMB + [[100, -95], [-100, -95], COMB[0]])],
    "along the contours": [polygon(ring(100 - 20 * k)) for k in range(4)],
    "around everything": [polygon(ring(1e6))],
    "around nothing": [polygon(ring(5, x=1e6))],
    "with itself as a hole": [polygon(ring(60), ring(60))],
    "with holes outside": [polygon(ring(30), ring(10, x=80), ring(90))],
    "with a thousand holes": [polygon(ring(95), *[ring(0.5, 6, x=-60 + 4 * (k % 30), y=-60 + 4 * (k // 30)) for k in range(900)])],
    "two hundred on each other": [polygon(ring(50, x=k / 1000), elev=k) for k in range(200)],
    "of a billionth": [polygon(ring(1e-9))],
    "of 1e300": [polygon([[-1e300, -1e300], [1e300, -1e300], [1e300, 1e300], [-1e300, -1e300]])],
    "not numbers": [polygon([[0, 0], [None, 5], ["x", 9], [0, 0]])],
    "wild heights": [polygon(ring(20), elev=1e300), polygon(ring(20, x=50), elev=-1e300), polygon(ring(9, y=60), elev="deep")],
    "points and polygons": [point(1, 2), polygon(ring(40))],
    "of no rings": [polygon()],
    "in degrees": [polygon([[139, 35], [140, 35], [140, 36], [139, 35]])],
}
COMMANDS = {
    "exclude": DENSIFY.format("hill.geojson --exclude areas.geojson"),
    "water": DENSIFY.format("hill.geojson --water areas.geojson"),
    "frame": DENSIFY.format("hill.geojson --frame areas.geojson"),
    "clip": DENSIFY.format("hill.geojson --clip areas.geojson"),
    "coast of areas": DEM.format("hill.geojson --coast areas.geojson --frame bbox"),
    "sinks of areas": DEM.format("hill.geojson --drain all --sinks areas.geojson"),
    "river areas": DEM.format("hill.geojson --streams areas.geojson"),
}


def cases():
    for name, areas in POLYGONS.items():
        write = putter(hill=collection(hill()), areas=collection(areas))
        for kind, command in COMMANDS.items():
            yield Case(f"{kind}: {name}", write, command)
