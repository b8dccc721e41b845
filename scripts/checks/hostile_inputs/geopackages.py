"""GeoPackages whose tables, geometries or systems are broken."""
import sqlite3
import struct

from hostile_inputs.case import DENSIFY, Case
from hostile_inputs.maps import hill


def gpkg(path, blob=None, *, table="lines", definition=None, more=""):
    db = sqlite3.connect(path)
    db.executescript(
        """CREATE TABLE gpkg_spatial_ref_sys (srs_name, srs_id, organization, organization_coordsys_id, definition, description);
        CREATE TABLE gpkg_contents (
            table_name, data_type, identifier, description, last_change, min_x, min_y, max_x, max_y, srs_id);
        CREATE TABLE gpkg_geometry_columns (table_name, column_name, geometry_type_name, srs_id, z, m);"""
    )
    name = '"' + table.replace('"', '""') + '"'
    db.execute("INSERT INTO gpkg_geometry_columns VALUES (?, 'geom', 'LINESTRING', 7, 0, 0)", [table])
    if definition is not None:
        db.execute("INSERT INTO gpkg_spatial_ref_sys VALUES ('a', 7, 'NONE', 7, ?, NULL)", [definition])
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


def cases():
    for name, write in GPKGS.items():
        yield Case(f"gpkg: {name}", lambda folder, write=write: write(folder / "a.gpkg"), DENSIFY.format("a.gpkg"))
