"""Small maps in GeoJSON, of which the hostile ones are made."""
import json
import math


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


def point(x, y, **properties):
    return {"type": "Feature", "properties": properties, "geometry": {"type": "Point", "coordinates": [x, y]}}


def polygon(*rings, **properties):
    return {"type": "Feature", "properties": properties, "geometry": {"type": "Polygon", "coordinates": list(rings)}}


def putter(**files):
    """What writes these texts as files into a folder: `hill="..."` becomes hill.geojson."""

    def write(folder):
        for name, text in files.items():
            (folder / f"{name}.geojson").write_text(text)

    return write
