"""Coordinate reference systems: pyproj's objects, EPSG codes, names, WKT."""

from __future__ import annotations

from typing import Any


def crs_text(crs: Any) -> str | None:
    """A system as text: its EPSG code if it has one, otherwise its WKT."""
    if crs is None or isinstance(crs, str):
        return crs
    if isinstance(crs, int) and not isinstance(crs, bool):
        return f"EPSG:{crs}"
    code = crs.to_epsg() if hasattr(crs, "to_epsg") else None
    if code is not None:
        return f"EPSG:{code}"
    if hasattr(crs, "to_wkt"):
        return str(crs.to_wkt())
    raise TypeError(f"a coordinate reference system is an EPSG code, a text or a pyproj.CRS, not {type(crs).__name__}")


def crs_object(text: str | None) -> Any:
    """A pyproj.CRS, if pyproj is installed; otherwise the text."""
    if text is None:
        return None
    try:
        import pyproj
    except ImportError:
        return text
    return pyproj.CRS.from_user_input(text)
