"""The keyword arguments that functions share. Their names are those of the program's flags."""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterable, Mapping
from typing import Any, Literal, TypedDict

from tokosen._crs import crs_text
from tokosen._sources import source, sources

Unit = Literal["m", "ft", "us-ft"]
Keep = Literal["contours", "breaklines", "none"]


class InputOptions(TypedDict, total=False):
    """How contours are read and prepared."""

    elevation: str | None
    """The attribute that holds the elevation. If None, it is recognised by its name, else the z coordinate is taken."""
    layer: str | None
    """The layer of a GeoPackage with several."""
    unit: Unit | None
    """The unit of elevations. If None: what an attribute states beside them, else the vertical part of the CRS, else metres."""
    plane_unit: Unit | None
    """The unit of x and y of contours without a CRS. If None: that of the drawing (DXF), else metres."""
    depths: bool
    """Whether the attribute `elevation`, or else attributes with names of depths, hold depths: negative elevations."""
    crs: Any
    """The CRS of the contours, if they name none or a wrong one."""
    work_crs: Any
    """The projected CRS in metres to work in. If None, the contours' own or a suitable one."""
    snap: float
    """Line ends of one elevation are joined up to this distance (0.01)."""
    repair: Literal["none", "safe", "all"] | None
    """How far the contours are repaired ("safe")."""
    strict: bool
    """Whether an error or a warning about the input is an exception."""
    exclude: Any
    """Polygons in which contours are left out. One source, or a list of them."""
    cliffs: Any
    """Lines across which the surface may jump."""
    coast: Any
    """Lines of the coast, polygons of land or sea, or the level of contours that are the coast."""


class SpotOptions(TypedDict, total=False):
    """Spot heights."""

    points: Any
    """Spot heights: the surface passes through them. Also an array (n, 3)."""
    points_sigma: float | None
    """Standard error of the spot heights: the surface comes near them."""


class FitOptions(TypedDict, total=False):
    """How lines are made smooth or denser first."""

    fit: float | None
    """Tolerance of a fit with smooth curves, map units."""
    sample: float | None
    """Vertices are added until they are at most this many times as far apart as the nearest other contour is."""


class WaterOptions(TypedDict, total=False):
    """Lakes and the sea."""

    water: Any
    """Lakes: polygons that are level."""
    sea: float | None
    """The level of the sea; the input must have contours at it."""


class StreamOptions(TypedDict, total=False):
    """Rivers and streams."""

    streams: Any
    """Lines of rivers and streams, in any direction, and polygons of river areas."""
    stream_tolerance: float | None
    """How far streams are moved into the bends of contours, map units."""


class FrameOptions(TypedDict, total=False):
    """Where the ground ends."""

    frame: Any
    """"hull" of the contours, their "bbox", or polygons. "auto" is the hull, or an outline of the contours where these fill
    less than a third of it ("auto")."""
    extend: bool
    """Whether polygons given as `frame` have heights also outside the convex hull of the contours (True)."""


class BreakLineOptions(TypedDict, total=False):
    """Break lines."""

    breaklines: Any
    """Lines along which the ground bends sharply; with z they give heights."""


class ResolutionOptions(TypedDict, total=False):
    """Ridge and canyon lines."""

    resolution: float
    """The method's resolution parameter w: larger values give fewer ridge and canyon lines (1)."""


class PartOptions(TypedDict, total=False):
    """The part of the map that results cover."""

    extent: tuple[float, float, float, float] | None
    """Least x, least y, greatest x, greatest y. Contours around it still count."""
    extent_crs: Any
    """The CRS of the extent, if it is not that of the contours."""
    clip: Any
    """Polygons to which results are cut. Contours around them still count."""


class GroundOptions(PartOptions, total=False):
    """The part of a height map that contours cover. Heights around an extent and around the polygons of `clip` still count."""

    frame: Any
    """Polygons: cells whose centres lie outside of them are no ground."""


class SideOptions(
    InputOptions,
    FitOptions,
    WaterOptions,
    StreamOptions,
    FrameOptions,
    BreakLineOptions,
    ResolutionOptions,
    PartOptions,
    total=False,
):
    """How contours are read and a surface is made."""

    sinks: Any
    """Points and polygons where water may stay."""
    drain: Literal["none", "safe", "all"]
    """Which pits get a way out ("safe")."""
    surface: Literal["linear", "skeleton", "spline"]
    """How heights between contours are interpolated ("spline")."""
    tension: float | None
    """Tension of the smooth surface. If None, chosen from the contours."""
    noise: float | None
    """Noise of the contours, 0 to 1. If None, chosen from the contours."""


class SurfaceOptions(SideOptions, SpotOptions, total=False):
    """How contours are read and a surface is made, with all that belongs to it."""

    base: Any
    """A height map that gives the heights outside the contours."""
    base_fade: float | None
    """Distance at which a twentieth of the difference from the base is left, map units."""


class CheckOptions(
    InputOptions, SpotOptions, FrameOptions, PartOptions, WaterOptions, StreamOptions, BreakLineOptions, total=False
):
    """How contours are read, and what is compared with them."""


class RegionOptions(InputOptions, SpotOptions, FitOptions, WaterOptions, FrameOptions, PartOptions, total=False):
    """How contours are read and parted into sub-domains."""


class SkeletonOptions(RegionOptions, StreamOptions, ResolutionOptions, total=False):
    """How contours are read, and ridge and canyon lines are found."""


_DEFAULTS: dict[str, Any] = {
    "elevation": None,
    "layer": None,
    "unit": None,
    "plane_unit": None,
    "depths": False,
    "crs": None,
    "work_crs": None,
    "snap": 0.01,
    "repair": None,
    "strict": False,
    "fit": None,
    "sample": None,
    "points": None,
    "points_sigma": None,
    "water": None,
    "sea": None,
    "coast": None,
    "streams": None,
    "stream_tolerance": None,
    "breaklines": None,
    "cliffs": None,
    "sinks": None,
    "drain": "safe",
    "exclude": None,
    "frame": "auto",
    "extend": True,
    "base": None,
    "base_fade": None,
    "extent": None,
    "extent_crs": None,
    "clip": None,
    "surface": "spline",
    "resolution": 1.0,
    "tension": None,
    "noise": None,
}
# Lines, polygons and points beside the contours: of one source, or of a list of sources.
_FEATURES = ("coast", "exclude", "cliffs", "water", "streams", "breaklines", "sinks")
_FEATURES_OF_ONE = ("coast", "water")
_SINGLE = ("points", "clip")
_SYSTEMS = ("crs", "work_crs", "extent_crs")


def options(given: Mapping[str, Any], known: type, uncertainty: bool = False) -> dict[str, Any]:
    """All options as the extension module takes them. `known` has the names that the function takes."""
    names = _names(known)
    for name in given:
        if name not in names:
            near = difflib.get_close_matches(name, names, n=1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise TypeError(f"there is no argument {name!r}{hint}")
    found = {**_DEFAULTS, **given, "uncertainty": uncertainty}
    coast = found["coast"]
    is_level = isinstance(coast, int | float) and not isinstance(coast, bool)
    found["coast_level"] = found.pop("coast") if is_level else None
    found["features"] = {
        name: [source(name, features)] if name in _FEATURES_OF_ONE else sources(name, features)
        for name in _FEATURES
        if (features := found.pop(name, None)) is not None
    }
    for name in _SINGLE:
        found[name] = None if found[name] is None else source(name, found[name])
    for name in _SYSTEMS:
        found[name] = crs_text(found[name])
    if not isinstance(found["frame"], str) or found["frame"] not in ("auto", "hull", "bbox"):
        frame = found["frame"]
        is_path = isinstance(frame, str) and not os.path.splitext(frame)[1]
        found["frame"] = frame if is_path else source("frame", frame)
    found["base"] = height_map("base", found["base"])
    if found["extent"] is not None:
        found["extent"] = [float(number) for number in found["extent"]]
    return found


def _names(known: type) -> Iterable[str]:
    """The names of the fields of a TypedDict."""
    return sorted(known.__required_keys__ | known.__optional_keys__)  # type: ignore[attr-defined]


def height_map(what: str, given: Any) -> Any:
    """A height map: a path, or a raster of the extension module."""
    from tokosen._dem import raster

    if given is None or isinstance(given, str | os.PathLike):
        return given if given is None else os.fspath(given)
    return raster(what, given)


def cells(
    cell: float | None,
    cell_degrees: float | None,
    like: Any,
    to_crs: Any,
    max_zoom: int | None = None,
    tile_size: int = 512,
) -> dict[str, Any]:
    """The cells of a height map as the extension module takes them."""
    return {
        "cell": cell,
        "cell_degrees": cell_degrees,
        "like": height_map("like", like),
        "to_crs": crs_text(to_crs),
        "max_zoom": max_zoom,
        "tile_size": tile_size,
    }


__all__ = ["SurfaceOptions", "cells", "height_map", "options"]
