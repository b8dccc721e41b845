"""What lines, points and polygons are taken from: files, frames, Arrow tables, GeoJSON-like objects, arrays."""

from __future__ import annotations

import json
import os
from typing import Any

import numpy as np

from tokosen import _tokosen
from tokosen._crs import crs_text

TAKEN = (
    "a path, a GeoDataFrame, an Arrow table with GeoArrow geometries, an object with __geo_interface__, or numpy arrays"
)


def source(what: str, given: Any) -> _tokosen.Source:
    """One source. `what` names the argument, for messages."""
    if isinstance(given, _tokosen.Source):
        return given
    if isinstance(given, str | os.PathLike):
        return _tokosen.Source.file(os.fspath(given))
    if is_frame(given):
        return _of_frame(what, given)
    if hasattr(given, "__arrow_c_stream__"):
        return _tokosen.Source.arrow(what, given, crs_text(getattr(given, "crs", None)))
    if hasattr(given, "__geo_interface__"):
        return _of_geojson(what, given.__geo_interface__, getattr(given, "crs", None))
    if isinstance(given, dict):
        return _of_geojson(what, given, None)
    if isinstance(given, np.ndarray):
        return _tokosen.Source.points(_floats(given, 2, what), None)
    if isinstance(given, tuple) and len(given) in (3, 4) and all(_is_array(part) for part in given[:3]):
        return _of_arrays(what, *given)
    if isinstance(given, list | tuple) and given and all(hasattr(part, "__geo_interface__") for part in given):
        features = [{"type": "Feature", "properties": {}, "geometry": part.__geo_interface__} for part in given]
        return _of_geojson(what, {"type": "FeatureCollection", "features": features}, None)
    raise TypeError(f"{what} is {_name_of(given)}; it must be {TAKEN}")


def sources(what: str, given: Any) -> list[_tokosen.Source]:
    """One source, or a list of them."""
    is_several = isinstance(given, list) and given and all(isinstance(part, str | os.PathLike) or is_frame(part) for part in given)
    return [source(what, part) for part in given] if is_several else [source(what, given)]


def places(what: str, given: Any, crs: str | None) -> list[list[float]]:
    """Places in a system: (x, y), several of them, or the points of a GeoDataFrame or GeoSeries."""
    if given is None:
        return []
    if is_frame(given):
        points = given.geometry if crs is None or given.crs is None else given.geometry.to_crs(crs)
        if not (points.geom_type == "Point").all():
            raise TypeError(f"{what} takes points")
        return [[float(x), float(y)] for x, y in zip(points.x, points.y, strict=True)]
    pairs = np.atleast_2d(np.asarray(given, dtype=float))
    if pairs.ndim != 2 or pairs.shape[1] != 2:
        raise TypeError(f"{what} takes (x, y), a list of such pairs, or a GeoDataFrame of points")
    return [[float(x), float(y)] for x, y in pairs]


def is_frame(given: Any) -> bool:
    """Whether it is a GeoDataFrame or a GeoSeries. geopandas is not imported for that."""
    return any(base.__name__ in ("GeoDataFrame", "GeoSeries") for base in type(given).__mro__)


def _of_frame(what: str, frame: Any) -> _tokosen.Source:
    """Features of a GeoDataFrame, or the geometries of a GeoSeries."""
    import shapely

    geometry = frame.geometry
    wkb = list(shapely.to_wkb(np.asarray(geometry.array, dtype=object)))
    attributes: list[tuple[str, Any]] = []
    if hasattr(frame, "columns"):
        for k, name in enumerate(frame.columns):
            if name != geometry.name:
                values = _attribute(frame.iloc[:, k])
                if values is not None:
                    attributes.append((str(name), values))
    return _tokosen.Source.features(what, wkb, attributes, crs_text(frame.crs))


def _attribute(column: Any) -> Any:
    """The values of a column as numbers or as texts; None if they are neither."""
    kind = getattr(column.dtype, "kind", "O")
    if kind in "iufb" and isinstance(column.dtype, np.dtype):
        return np.ascontiguousarray(column.to_numpy(), dtype=np.float64)
    if kind in "iufb":
        return np.ascontiguousarray(column.to_numpy(dtype=np.float64, na_value=np.nan))
    if kind in "mMc" or not hasattr(column, "array"):
        return None
    values = column.to_numpy(dtype=object)
    if all(_is_number(value) or _is_missing(value) for value in values):
        return np.array([np.nan if _is_missing(value) else float(value) for value in values], dtype=np.float64)
    return [None if _is_missing(value) else str(value) for value in values]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float | np.number) or type(value).__name__ == "Decimal"


def _is_missing(value: Any) -> bool:
    return value is None or type(value).__name__ in ("NAType", "NaTType") or (isinstance(value, float) and value != value)


def _of_geojson(what: str, given: Any, crs: Any) -> _tokosen.Source:
    """GeoJSON as Python objects."""
    text = crs_text(crs)
    if text is not None and isinstance(given, dict):
        given = {**given, "crs": {"type": "name", "properties": {"name": text}}}
        if given.get("type") != "FeatureCollection":
            feature = given if given.get("type") == "Feature" else {"type": "Feature", "properties": {}, "geometry": given}
            given = {"type": "FeatureCollection", "features": [feature], "crs": given["crs"]}
    try:
        encoded = json.dumps(given, default=_plain, allow_nan=False)
    except ValueError as error:
        raise _tokosen_input_error(f"{what}: {error}; a coordinate or a value is NaN or infinite") from error
    return _tokosen.Source.geojson(what, encoded.encode())


def _tokosen_input_error(message: str) -> Exception:
    from tokosen._errors import InputError

    return InputError(message)


def _plain(value: Any) -> Any:
    """Values of numpy as Python's."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    if hasattr(value, "isoformat"):
        return value.isoformat()
    raise TypeError(f"a value is {_name_of(value)}, which GeoJSON cannot hold")


def _of_arrays(what: str, coords: Any, offsets: Any, elevations: Any, crs: Any = None) -> _tokosen.Source:
    """Ragged arrays: coordinates (n, 2), offsets (lines + 1), elevations (lines)."""
    offsets = np.asarray(offsets)
    if offsets.size and offsets.dtype.kind not in "iu":
        raise TypeError(f"the offsets of {what} are {offsets.dtype}; they must be whole numbers")
    offsets = np.ascontiguousarray(_flat(offsets, what, "offsets"), dtype=np.int64)
    elevations = _floats(_flat(np.asarray(elevations), what, "elevations"), 1, what)
    return _tokosen.Source.lines(_floats(np.asarray(coords), 2, what), offsets, elevations, crs_text(crs))


def _flat(array: np.ndarray[Any, Any], what: str, part: str) -> np.ndarray[Any, Any]:
    if array.ndim != 1:
        raise ValueError(f"the {part} of {what} have {array.ndim} dimensions; they must have one")
    return array


def _floats(array: np.ndarray[Any, Any], dimensions: int, what: str) -> np.ndarray[Any, Any]:
    """The array as 64-bit floating point, row by row in memory. It is copied only if it is not so already."""
    if array.dtype.kind not in "iufb":
        raise TypeError(f"an array of {what} is {array.dtype}; it must be numbers")
    if array.ndim != dimensions:
        raise ValueError(f"an array of {what} has {array.ndim} dimensions; it must have {dimensions}")
    return np.ascontiguousarray(array, dtype=np.float64)


def _is_array(part: Any) -> bool:
    return isinstance(part, np.ndarray | list | tuple)


def _name_of(given: Any) -> str:
    return "None" if given is None else f"of type {type(given).__name__}"
