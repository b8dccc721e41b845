"""Contours in GeoJSON that are broken, wild or no GeoJSON at all."""
import json
import math

from hostile_inputs.case import DENSIFY, Case
from hostile_inputs.maps import collection, hill, line, point, ring


def with_value(value):
    """A hill, one of whose lines has this elevation."""
    features = hill()
    features[1]["properties"]["elev"] = value
    return collection(features)


def with_points(points):
    """A hill, one of whose lines has these coordinates."""
    features = hill()
    features[1]["geometry"]["coordinates"] = points
    return collection(features)


def with_geometry(geometry):
    features = hill()
    features[1]["geometry"] = geometry
    return collection(features)


def scaled(factor, offset=0.0):
    features = hill()
    for feature in features:
        points = feature["geometry"]["coordinates"]
        feature["geometry"]["coordinates"] = [[x * factor + offset, y * factor + offset] for x, y in points]
    return collection(features)


def nested(depth):
    return '{"type":"FeatureCollection","features":' + "[" * depth + "]" * depth + "}"


def texts():
    zigzag = [[k * 0.01, 50.0 * (k % 2)] for k in range(20_000)]
    spiral = [[0.02 * k * math.cos(k / 9), 0.02 * k * math.sin(k / 9)] for k in range(4_000)]
    star = [line([[100 * math.cos(k), 100 * math.sin(k)], [-100 * math.cos(k), -100 * math.sin(k)]], elev=k) for k in range(200)]
    comb = [line([[k, 0], [k, 50], [k + 0.5, 50], [k + 0.5, 0]], elev=10 * (k % 5)) for k in range(300)]
    collapsing = {"type": "GeometryCollection", "geometries": []}
    for _ in range(60):
        collapsing = {"type": "GeometryCollection", "geometries": [collapsing]}
    good = collection(hill())
    return {
        "empty": "",
        "spaces": " \n\t ",
        "null": "null",
        "a number": "1e400",
        "an array": "[]",
        "cut off": good[: len(good) // 2],
        "two documents": good + good,
        "byte order mark": "\ufeff" + good,
        "zero bytes": good.replace("elev", "el\0v"),
        "utf-16": good.encode("utf-16"),
        "not utf-8": good.encode().replace(b"elev", b"el\xff\xfev"),
        "deep arrays": nested(200_000),
        "deep geometry": with_geometry(collapsing),
        "features are an object": json.dumps({"type": "FeatureCollection", "features": {"a": 1}}),
        "features are null": json.dumps({"type": "FeatureCollection", "features": None}),
        "no features": collection([]),
        "features without members": collection([{}] * 50 + hill()),
        "properties are null": collection([{**feature, "properties": None} for feature in hill()]),
        "elevation NaN": good.replace('"elev": 10', '"elev": NaN'),
        "elevation 1e308": with_value(1e308),
        "elevation -1e308": with_value(-1e308),
        "elevation 1e400": good.replace('"elev": 10', '"elev": 1e400'),
        "elevation text": with_value("10 m"),
        "elevation decimal comma": with_value("10,5"),
        "elevation bool": with_value(True),
        "elevation list": with_value([10]),
        "elevation empty": with_value(""),
        "elevation tiny steps": collection([line(ring(100 - k), elev=1 + k * 1e-12) for k in range(50)]),
        "elevation noise": collection([line(ring(100 - k), elev=10 * k + 1e-9 * (k % 3)) for k in range(50)]),
        "elevation huge steps": collection([line(ring(100 - 10 * k), elev=10.0 ** (k * 30)) for k in range(9)]),
        "every line another level": collection([line(ring(1000 - k), elev=math.sqrt(k)) for k in range(900)]),
        "line of no point": with_points([]),
        "line of one point": with_points([[1, 1]]),
        "line of equal points": with_points([[1, 1]] * 100),
        "positions of one number": with_points([[1], [2]]),
        "positions of text": with_points([["1", "2"], ["3", "4"]]),
        "positions null": with_points([None, None]),
        "positions of a thousand numbers": with_points([[1.0] * 1000, [2.0] * 1000]),
        "position 1e308": with_points([[1e308, 0], [-1e308, 1]]),
        "position 1e-320": with_points([[1e-320, 0], [2e-320, 1e-310], [1, 1]]),
        "map of 1e-9": scaled(1e-9),
        "map of 1e9": scaled(1e9),
        "map at 1e15": scaled(1.0, 1e15),
        "map at 1e200": scaled(1e200),
        "all on one line": collection([line([[k, k], [k + 0.5, k + 0.5]], elev=k) for k in range(50)]),
        "all at one place": collection([line([[0, 0], [1e-12, 0]], elev=k) for k in range(50)]),
        "the same ring at two levels": collection([line(ring(50), elev=10), line(ring(50), elev=20), line(ring(90), elev=0)]),
        "one ring a thousand times": collection(hill() + [line(ring(50), elev=10)] * 1000),
        "star": collection(star),
        "spiral over rings": collection(hill() + [line(spiral, elev=15)]),
        "zigzag": collection(hill() + [line(zigzag, elev=15)]),
        "comb": collection(comb),
        "rings that touch": collection([line(ring(10, x=20 * k), elev=10 * (k % 2)) for k in range(100)]),
        "ring of two points": collection(hill() + [line([[0, 0], [5, 5], [0, 0]], elev=40)]),
        "ring with a spike": collection(hill() + [line(ring(10)[:20] + [[900, 900]] + ring(10)[20:], elev=40)]),
        "a line far away": collection(hill() + [line([[1e7, 1e7], [1e7 + 5, 1e7]], elev=40)]),
        "polygons": with_geometry({"type": "Polygon", "coordinates": [ring(80)]}),
        "only points": collection([point(k, k * k, elev=k) for k in range(99)]),
        "geometry of no type": with_geometry({"coordinates": [[0, 0], [1, 1]]}),
        "geometry of another type": with_geometry({"type": "Curve", "coordinates": [[0, 0], [1, 1]]}),
        "many empty lines": collection(hill() + [line([], elev=5)] * 20_000),
        "many fields": collection([{**f, "properties": {**f["properties"], **{f"f{k}": k for k in range(2_000)}}} for f in hill()]),
        "a name of a megabyte": collection([{**f, "properties": {**f["properties"], "n" * 1_000_000: 1}} for f in hill()]),
        "crs of a moon": collection(hill(), crs="urn:ogc:def:crs:IAU:2015:30100"),
        "crs of an endless text": collection(hill(), crs="PROJCS[" * 50_000),
        "crs code too large": collection(hill(), crs="EPSG:99999999999999999999"),
        "crs is a number": collection(hill(), crs=None, crs_=7).replace("crs_", "crs"),
        "degrees beyond the poles": collection([line([[x, 95 + y / 100] for x, y in ring(9 - k)], elev=k) for k in range(5)], crs="EPSG:4326"),
        "degrees all round the globe": collection([line([[x * 20, y * 9] for x, y in ring(8 - k)], elev=k) for k in range(5)], crs="EPSG:4326"),
    }


def cases():
    for name, text in texts().items():
        data = text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass")
        yield Case(f"geojson: {name}", lambda folder, data=data: (folder / "a.geojson").write_bytes(data), DENSIFY.format("a.geojson"))
