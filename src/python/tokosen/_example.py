"""Contours to try the functions with."""

from __future__ import annotations

import math
from typing import Any


def example() -> dict[str, Any]:
    """The contours of a drawn hill, every 10 m from 10 to 40 m, as GeoJSON in the CRS EPSG:6677.

    >>> [feature["properties"]["elev"] for feature in tokosen.example()["features"]]
    [10, 20, 30, 40]
    """
    features = []
    for elevation, radius in ((10, 300.0), (20, 220.0), (30, 150.0), (40, 80.0)):
        ring = []
        for k in range(72):
            angle = math.radians(5 * k)
            # A hill with three spurs.
            distance = radius * (1 + 0.1 * math.cos(3 * angle)) / 1.1
            ring.append([round(distance * math.cos(angle), 3), round(distance * math.sin(angle), 3)])
        geometry = {"type": "LineString", "coordinates": [*ring, ring[0]]}
        features.append({"type": "Feature", "properties": {"elev": elevation}, "geometry": geometry})
    system = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::6677"}}
    return {"type": "FeatureCollection", "crs": system, "features": features}
