"""Shapefiles whose records, parts or table are broken."""
import math
import struct

from hostile_inputs.case import DENSIFY, Case
from hostile_inputs.maps import hill, ring


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


def cases():
    for name, write in SHAPEFILES.items():
        yield Case(f"shp: {name}", lambda folder, write=write: write(folder / "a.shp"), DENSIFY.format("a.shp"))
