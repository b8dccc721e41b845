#!/usr/bin/env python3
"""Runs tokosen on more than a hundred hostile inputs, and prints a row for each.

    hostile.py [--program TOKOSEN] [--only NAME] [--seconds 60] [--gigabytes 3]

A run is bad if it panics, ends by a signal, needs more time or address space than allowed, ends with another status than 0,
1 or 2, fails without a message, succeeds without its output, or leaves anything else in its folder. Exit status 1 if any
run is bad.
"""
import argparse
import json
import math
import os
import pathlib
import resource
import sqlite3
import struct
import subprocess
import tempfile
import time
import zipfile

import tools


# ---- maps in GeoJSON


def line(points, **properties):
    return {"type": "Feature", "properties": properties, "geometry": {"type": "LineString", "coordinates": points}}


def ring(radius, count=40, x=0.0, y=0.0):
    angles = [2 * math.pi * (k % count) / count for k in range(count + 1)]
    return [[x + radius * math.cos(a), y + radius * math.sin(a)] for a in angles]


def hill():
    return [line(ring(100 - 20 * k), elev=10 * k) for k in range(4)]


def collection(features, crs="urn:ogc:def:crs:EPSG::6677", **members):
    crs = {"crs": {"type": "name", "properties": {"name": crs}}} if crs else {}
    return json.dumps({"type": "FeatureCollection", **crs, "features": features, **members})


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


def geojson_texts():
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
        "only points": collection([{"type": "Feature", "properties": {"elev": k}, "geometry": {"type": "Point", "coordinates": [k, k * k]}} for k in range(99)]),
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


# ---- other vector formats


def gpkg(path, blob=None, *, table="lines", definition=None, more=""):
    db = sqlite3.connect(path)
    db.executescript(
        """CREATE TABLE gpkg_spatial_ref_sys (srs_name, srs_id, organization, organization_coordsys_id, definition);
        CREATE TABLE gpkg_contents (table_name, data_type, identifier, srs_id);
        CREATE TABLE gpkg_geometry_columns (table_name, column_name, geometry_type_name, srs_id, z, m);"""
    )
    name = '"' + table.replace('"', '""') + '"'
    db.execute("INSERT INTO gpkg_geometry_columns VALUES (?, 'geom', 'LINESTRING', 7, 0, 0)", [table])
    if definition is not None:
        db.execute("INSERT INTO gpkg_spatial_ref_sys VALUES ('a', 7, 'NONE', 7, ?)", [definition])
    if blob is not None:
        db.execute(f"CREATE TABLE {name} (fid INTEGER PRIMARY KEY, geom BLOB, elev)")
        for k, feature in enumerate(hill()):
            points = feature["geometry"]["coordinates"]
            body = b"".join(struct.pack("<2d", *p) for p in points)
            good = b"GP\0\1\7\0\0\0\1\2\0\0\0" + struct.pack("<I", len(points)) + body
            db.execute(f"INSERT INTO {name} (geom, elev) VALUES (?, ?)", [good if k else blob or good, 10 * k])
    db.executescript(more)
    db.commit()
    db.close()


WKB = b"GP\0\1\7\0\0\0"
DEEP = WKB + (b"\1\7\0\0\0\1\0\0\0" * 50_000)
GPKGS = {
    "no gpkg": lambda p: p.write_text("hello"),
    "another database": lambda p: sqlite3.connect(p).executescript("CREATE TABLE a (b);"),
    "cut off": lambda p: (gpkg(p, b""), p.write_bytes(p.read_bytes()[:9_000])),
    "broken pages": lambda p: (gpkg(p, b""), p.write_bytes(p.read_bytes()[:4_096] + b"\xff" * 20_000)),
    "layer without a table": lambda p: gpkg(p),
    "geometry without its letters": lambda p: gpkg(p, b"XX\0\1" + b"\0" * 40),
    "geometry of one byte": lambda p: gpkg(p, b"G"),
    "geometry of 4e9 points": lambda p: gpkg(p, WKB + b"\1\2\0\0\0\xff\xff\xff\xff"),
    "geometry of 50000 depths": lambda p: gpkg(p, DEEP),
    "geometry of no type": lambda p: gpkg(p, WKB + b"\1\xff\xff\xff\xff" + b"\0" * 40),
    "geometry with a wrong envelope": lambda p: gpkg(p, b"GP\0\x0f\7\0\0\0" + b"\1\2\0\0\0\0\0\0\0"),
    "name with quotes": lambda p: gpkg(p, b"", table='a"; DROP TABLE gpkg_contents; --'),
    "name of a keyword": lambda p: gpkg(p, b"", table="select"),
    "system without a text": lambda p: gpkg(p, b"", definition=""),
    "system of brackets": lambda p: gpkg(p, b"", definition="[" * 100_000),
    "a view of itself": lambda p: gpkg(p, more="CREATE VIEW lines AS SELECT * FROM lines;"),
    "a trigger": lambda p: gpkg(p, b"", more="CREATE TRIGGER t AFTER INSERT ON lines BEGIN DELETE FROM lines; END;"),
}


def shapefile(path, *, shapes, count=None, length=None, kind=3):
    body = b""
    for number, content in enumerate(shapes, 1):
        body += struct.pack(">2i", number, len(content) // 2 if length is None else length) + content
    head = struct.pack(">7i", 9994, 0, 0, 0, 0, 0, (100 + len(body)) // 2) + struct.pack("<2i8d", 1000, kind, *[0.0] * 8)
    path.write_bytes(head + body)
    rows = len(shapes) if count is None else count
    field = struct.pack("<11sc4xBB14x", b"elev", b"N", 10, 2)
    dbf = struct.pack("<4BIHH20x", 3, 26, 1, 1, rows, 65, 11) + field + b"\r"
    path.with_suffix(".dbf").write_bytes(dbf + b"".join(b" %10.2f" % (10.0 * k) for k in range(len(shapes))))


def polyline(points, parts=(0,), count=None):
    count = len(points) if count is None else count
    box = struct.pack("<4d", 0, 0, 1, 1)
    parts = struct.pack(f"<{len(parts)}i", *parts) if parts else b""
    return struct.pack("<i", 3) + box + struct.pack("<2i", len(parts) // 4, count) + parts + b"".join(struct.pack("<2d", *p) for p in points)


GOOD = [polyline(feature["geometry"]["coordinates"]) for feature in hill()]
SHAPEFILES = {
    "no shapefile": lambda p: p.write_text("hello"),
    "a head alone": lambda p: shapefile(p, shapes=[]),
    "cut off": lambda p: (shapefile(p, shapes=GOOD), p.write_bytes(p.read_bytes()[:700])),
    "no table": lambda p: (shapefile(p, shapes=GOOD), p.with_suffix(".dbf").unlink()),
    "a table of 4e9 rows": lambda p: shapefile(p, shapes=GOOD, count=4_000_000_000),
    "records of negative length": lambda p: shapefile(p, shapes=GOOD, length=-5),
    "records of 4 GB": lambda p: shapefile(p, shapes=GOOD, length=2_000_000_000),
    "points that are not there": lambda p: shapefile(p, shapes=[polyline(ring(5), count=2_000_000_000)] + GOOD),
    "parts beyond the end": lambda p: shapefile(p, shapes=[polyline(ring(5), parts=(0, 99, -7))] + GOOD),
    "no parts": lambda p: shapefile(p, shapes=[polyline(ring(5), parts=())] + GOOD),
    "not a number": lambda p: shapefile(p, shapes=[polyline([[math.nan, 0], [1, math.inf]])] + GOOD),
    "another kind": lambda p: shapefile(p, shapes=GOOD, kind=31),
}


def dxf(entities):
    return "0\nSECTION\n2\nENTITIES\n" + entities + "0\nENDSEC\n0\nEOF\n"


def dxf_line(points, z):
    return f"0\nLWPOLYLINE\n8\nC\n38\n{z}\n90\n{len(points)}\n" + "".join(f"10\n{x}\n20\n{y}\n" for x, y in points)


DXF_HILL = "".join(dxf_line(f["geometry"]["coordinates"], f["properties"]["elev"]) for f in hill())
DXFS = {
    "empty": "",
    "no end": dxf(DXF_HILL)[:-30],
    "binary": "AutoCAD Binary DXF\r\n\x1a\0" + "\0" * 100,
    "codes of text": dxf("x\ny\n" * 50),
    "arcs of 1e300": dxf("0\nLWPOLYLINE\n8\nC\n38\n5\n10\n0\n20\n0\n42\n1e300\n10\n9\n20\n0\n" + DXF_HILL),
    "vertices without a line": dxf("0\nVERTEX\n10\n1\n20\n1\n" * 100),
    "a line without vertices": dxf("0\nPOLYLINE\n8\nC\n66\n1\n0\nSEQEND\n" + DXF_HILL),
    "a line of 1e9 vertices": dxf("0\nLWPOLYLINE\n8\nC\n90\n1000000000\n38\n1\n10\n0\n20\n0\n" + DXF_HILL),
    "coordinates of words": dxf(DXF_HILL.replace("100.0", "east")),
    "a block in itself": "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nB\n0\nINSERT\n2\nB\n0\nENDBLK\n0\nENDSEC\n" + dxf("0\nINSERT\n2\nB\n" + DXF_HILL),
}
FGBS = {
    "no fgb": b"hello",
    "letters alone": b"fgb\3fgb\0",
    "a head of 4 GB": b"fgb\3fgb\0\xff\xff\xff\xff" + b"\0" * 100,
    "noise": b"fgb\3fgb\0" + bytes(range(256)) * 40,
}


def bomb(path):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("FG-GML-1-Cntr.xml", b"<" + b" " * 200_000_000)


ENTITIES = '<!DOCTYPE a [<!ENTITY a "aaaaaaaaaa">' + "".join(f'<!ENTITY a{k} "{("&a" + str(k - 1) + ";") * 10}">' for k in range(1, 10)) + "]><Dataset>&a9;</Dataset>"
ARCHIVES = {
    "no zip": ("a.zip", lambda p: p.write_text("hello")),
    "an empty zip": ("a.zip", lambda p: zipfile.ZipFile(p, "w").close()),
    "a bomb": ("a.zip", bomb),
    "a name that leads out": ("a.zip", lambda p: zipfile.ZipFile(p, "w").writestr("../../../tmp/FG-GML-1-Cntr.xml", "<a/>")),
    "entities": ("a.xml", lambda p: p.write_text(ENTITIES)),
    "deep elements": ("a.xml", lambda p: p.write_text("<a>" * 200_000)),
    "a folder of nothing": ("folder", lambda p: p.mkdir()),
}
ASC = "ncols {}\nnrows {}\nxllcorner 0\nyllcorner 0\ncellsize {}\n{}"
RASTERS = {
    "no tif": ("a.tif", b"hello"),
    "a tif of 4e9 tiles": ("a.tif", struct.pack("<2sHIH", b"II", 42, 8, 4) + b"".join(struct.pack("<HHII", t, 4, 1, v) for t, v in ((256, 2**31 - 1), (257, 2**31 - 1), (258, 32), (339, 3))) + b"\0" * 4),
    "a tif that turns in a circle": ("a.tif", struct.pack("<2sHIH", b"II", 42, 8, 0) + struct.pack("<I", 8)),
    "asc of negative size": ("a.asc", ASC.format(-3, 4, 1, "1 2 3").encode()),
    "asc of 1e18 cells": ("a.asc", ASC.format(10**9, 10**9, 1, "1 2 3").encode()),
    "asc with cells of 0": ("a.asc", ASC.format(2, 2, 0, "1 2 3 4").encode()),
    "asc of words": ("a.asc", ASC.format(2, 2, 1, "one two three four").encode()),
    "asc of NaN": ("a.asc", ASC.format(2, 2, 1, "nan nan nan nan").encode()),
    "no exr": ("a.exr", b"\x76\x2f\x31\x01" + b"\xff" * 200),
    "a png of one byte": ("a.png", b"\x89"),
}
OPTIONS = [
    "dem hill.geojson --cell 0 -o out.tif", "dem hill.geojson --cell -5 -o out.tif", "dem hill.geojson --cell nan -o out.tif",
    "dem hill.geojson --cell inf -o out.tif", "dem hill.geojson --cell 1e-300 -o out.tif",
    "densify hill.geojson -i 0 -o out.gpkg", "densify hill.geojson -i 1e-300 -o out.gpkg", "densify hill.geojson -i nan -o out.gpkg",
    "densify hill.geojson -i 1e300 -o out.gpkg", "densify hill.geojson --levels 1e308 -o out.gpkg",
    "densify hill.geojson -i 5 --base 1e308 -o out.gpkg", "densify hill.geojson -i 5 --snap 1e300 -o out.gpkg",
    "densify hill.geojson -i 5 --fit 1e300 -o out.gpkg", "densify hill.geojson -i 5 --fit 1e-300 -o out.gpkg",
    "densify hill.geojson -i 5 --sample 1e-9 -o out.gpkg", "densify hill.geojson -i 5 --simplify 1e300 -o out.gpkg",
    "densify hill.geojson -i 5 --tension 1e300 -o out.gpkg", "densify hill.geojson -i 5 --sea 1e308 -o out.gpkg",
    "densify hill.geojson -i 5 --crs EPSG:2193 --to-crs EPSG:27700 -o out.gpkg", "densify hill.geojson -i 5 --crs (((( -o out.gpkg",
    "densify hill.geojson -i 5 --threads 1024 -o out.gpkg", "densify hill.geojson -i 5 --points hill.geojson -o out.gpkg",
    "densify hill.geojson -i 5 --water hill.geojson -o out.gpkg", "densify hill.geojson -i 5 --frame hill.geojson -o out.gpkg",
    "densify hill.geojson -i 5 --streams hill.geojson --stream-tolerance 1e300 -o out.gpkg",
    "densify hill.geojson -i 5 --streams hill.geojson --stream-tolerance 0 -o out.gpkg",
    "dem hill.geojson --cell 5 --drain all --sinks hill.geojson -o out.tif", "dem hill.geojson --cell 5 --points-sigma 1 -o out.tif",
    "dem hill.geojson --cell 5 --coast 1e308 -o out.tif", "dem hill.geojson --cell 5 --coast nan -o out.tif",
    "dem hill.geojson --cell 5 --base hill.geojson -o out.tif", "--run hill.geojson", "dem hill.geojson --cell 5 --save-run . -o out.tif",
    "skeleton hill.geojson --resolution 1e300 -o out.gpkg", "mesh hill.geojson --base 1e300 -o out.glb",
]  # fmt: skip


LINES = {
    "none": [],
    "a point": [line([[1, 1]])],
    "the same point": [line([[1, 1]] * 50)],
    "not numbers": [line([[1, 1], [None, 3], ["x", "y"]])],
    "far away": [line([[-1e300, 0], [1e300, 1]])],
    "across everything and back": [line([[-300 + 600 * (k % 2), -60 + 0.01 * k] for k in range(10_000)])],
    "up and down across one contour": [line([[-99 + 0.01 * k, 0.1 * k % 2 + 40 * (k % 2)] for k in range(10_000)])],
    "a spiral": [line([[0.01 * k * math.cos(0.1 * k), 0.01 * k * math.sin(0.1 * k)] for k in range(10_000)])],
    "ten thousand at one place": [line([[0, 0], ring(90, 10_000)[k]]) for k in range(10_000)],
    "the same line a thousand times": [line([[0, 0], [50, 50], [90, 0]])] * 1000,
    "loops": [line(ring(10 + k)) for k in range(100)],
    "along contours": [line(ring(100 - 20 * k)[:30]) for k in range(4)],
    "points": [{"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [1, 2]}}],
    "polygons": [{"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [ring(30 + k)]}} for k in range(50)],
    "a polygon of zeros": [{"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [[[0, 0]] * 5]}}],
    "wild heights": [line([[-90, 0, 1e300], [0, 5, -1e300], [90, 0, 15]]), line([[0, -90, 25], [5, 0, 1e-300], [0, 90, 35]])],
    "heights that contradict each other": [line([[k - 50, -90, 15], [50 - k, 90, 38]]) for k in range(100)],
}


def cases():
    """Name, what writes the input into a folder, and the command."""
    densify = "densify {} -i 5 -o out.gpkg --dem out.tif --cell 5"
    for name, text in geojson_texts().items():
        data = text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass")
        yield f"geojson: {name}", (lambda folder, data=data: (folder / "a.geojson").write_bytes(data)), densify.format("a.geojson")
    for name, write in GPKGS.items():
        yield f"gpkg: {name}", (lambda folder, write=write: write(folder / "a.gpkg")), densify.format("a.gpkg")
    for name, write in SHAPEFILES.items():
        yield f"shp: {name}", (lambda folder, write=write: write(folder / "a.shp")), densify.format("a.shp")
    for name, text in DXFS.items():
        yield f"dxf: {name}", (lambda folder, text=text: (folder / "a.dxf").write_text(text)), densify.format("a.dxf")
    for name, data in FGBS.items():
        yield f"fgb: {name}", (lambda folder, data=data: (folder / "a.fgb").write_bytes(data)), densify.format("a.fgb")
    for name, (file, write) in ARCHIVES.items():
        yield f"gsi: {name}", (lambda folder, file=file, write=write: write(folder / file)), densify.format(file)
    for name, (file, data) in RASTERS.items():
        write = lambda folder, file=file, data=data: (folder / file).write_bytes(data)  # noqa: E731
        yield f"raster: {name}", write, f"derive {file} --slope out.tif"
    for name, lines in LINES.items():

        def write(folder, lines=lines):
            (folder / "hill.geojson").write_text(collection(hill()))
            (folder / "lines.geojson").write_text(collection(lines))

        for option in ("streams", "breaklines", "cliffs", "coast", "sinks"):
            yield f"{option}: {name}", write, densify.format(f"hill.geojson --{option} lines.geojson")
        yield f"check: {name}", write, "check hill.geojson --streams lines.geojson --breaklines lines.geojson --cliffs lines.geojson -o out.gpkg"
    for command in OPTIONS:
        yield f"options: {command}", (lambda folder: (folder / "hill.geojson").write_text(collection(hill()))), command


# ---- running


def run(program, folder, command, seconds, gigabytes):
    """Exit status (None: too long), what was said, seconds, and peak memory in megabytes."""
    limit = int(gigabytes * 2**30)
    started = time.monotonic()
    child = subprocess.Popen(
        [program, *command.split()], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)),
    )  # fmt: skip
    try:
        said = child.communicate(timeout=seconds)[1].decode(errors="replace")
    except subprocess.TimeoutExpired:
        child.kill()
        child.communicate()
        return None, "", seconds
    return child.returncode, said, time.monotonic() - started


def fault(status, said, left, outputs):
    """Why a run is bad; None if it is not."""
    if status is None:
        return "took too long"
    if status < 0:
        return f"ended by signal {-status}"
    if status not in (0, 1, 2) or "panicked" in said:
        return f"status {status}: {said.strip()[-80:]}"
    if status and not said.strip().splitlines()[-1:]:
        return "failed without a message"
    if status and "error: " not in said:
        return "failed without an error"
    if status == 0 and not outputs:
        return "succeeded without an output"
    if status and outputs:
        return f"failed, but wrote {', '.join(sorted(outputs))}"
    return f"left {', '.join(sorted(left))}" if left else None


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("--program", default=tools.BINARY)
    a.add_argument("--only", default="", help="cases with this in their name")
    a.add_argument("--seconds", type=float, default=60)
    a.add_argument("--gigabytes", type=float, default=3, help="of address space")
    o = a.parse_args()
    program = os.path.abspath(o.program)
    bad = total = 0
    slowest = (0.0, "")
    for name, write, command in cases():
        if o.only not in name:
            continue
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            write(folder)
            before = {path.name for path in folder.iterdir()}
            status, said, seconds = run(program, folder, command, o.seconds, o.gigabytes)
            new = {path.name for path in folder.iterdir()} - before
        outputs = {file for file in new if file.startswith("out.")}
        why = fault(status, said, new - outputs, outputs)
        total, bad = total + 1, bad + bool(why)
        slowest = max(slowest, (seconds, name))
        message = next((text for text in reversed(said.splitlines()) if "error: " in text), "")
        print(f"{'BAD' if why else 'ok':4}{status!s:>5}{seconds:7.2f} s  {name[:64]:66}{why or message[:110]}")
    print(f"\n{total} inputs, {bad} bad; the slowest took {slowest[0]:.1f} s: {slowest[1]}")
    return 1 if bad else 0


if __name__ == "__main__":
    raise SystemExit(main())
