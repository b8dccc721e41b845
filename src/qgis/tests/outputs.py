"""Compares what QGIS wrote with what the command wrote."""
import sqlite3


def rows(path):
    """All layers of a GeoPackage: their system, columns and rows. Geometries are bytes, so that coordinates are exact."""
    found = {}
    with sqlite3.connect(f"file:{path}?mode=ro", uri=True) as connection:
        layers = connection.execute("SELECT table_name, srs_id FROM gpkg_contents ORDER BY table_name").fetchall()
        for name, system in layers:
            cursor = connection.execute(f'SELECT * FROM "{name}" ORDER BY 1')
            found[name] = (system, [column[0] for column in cursor.description], cursor.fetchall())
    connection.close()
    return found


def content(path):
    """What two equal outputs have in common. A GeoPackage also holds the time at which it was written."""
    return rows(path) if path.suffix == ".gpkg" else path.read_bytes()


def count(path):
    """Number of features in a GeoPackage."""
    return sum(len(features) for _, _, features in rows(path).values())
