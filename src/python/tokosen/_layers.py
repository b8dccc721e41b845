"""Layers of features as results."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from typing import Any, Literal

import numpy as np

from tokosen import _tokosen
from tokosen._crs import crs_object
from tokosen._tiles import tiling
from tokosen._work import warn_of

Output = Literal["geopandas", "layer"] | None
"""The form of a result: a GeoDataFrame, a Layer, or None for a GeoDataFrame if the contours were one."""


class Layer:
    """Features with one type of geometry: contours, areas, points.

    It is an Arrow table with GeoArrow geometries (`__arrow_c_stream__`), which pyarrow, geopandas, polars, DuckDB and lonboard
    read without a copy.

    >>> lines = tokosen.densify(tokosen.example(), 5)
    >>> lines
    <Layer contours_5m: 7 LineString, columns elev, source, is_index, depression, closed>
    >>> lines["elev"]
    array([10., 15., 20., 25., 30., 35., 40.])
    >>> lines.coords.shape[1]
    3
    """

    def __init__(self, layer: _tokosen.Layer) -> None:
        self._layer = layer

    @property
    def name(self) -> str:
        """The name of the layer, as in files."""
        return self._layer.name

    @property
    def crs(self) -> Any:
        """The CRS: a pyproj.CRS if pyproj is installed, otherwise a text; None if it is unknown."""
        return crs_object(self._layer.crs)

    @property
    def geometry_type(self) -> str:
        """Point, LineString or Polygon."""
        return self._layer.geometry_type

    @property
    def columns(self) -> list[str]:
        """The names of the attributes."""
        return self._layer.columns

    @property
    def coords(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        """The coordinates of all vertices, one feature after the other: (n, 3) for lines, otherwise (n, 2).

        A view of the table, without a copy. It cannot be written to.
        """
        width = 3 if self.geometry_type == "LineString" else 2
        return np.frombuffer(self._layer.coords(), dtype=np.float64).reshape(-1, width)

    @property
    def offsets(self) -> tuple[np.ndarray[Any, np.dtype[np.int32]], ...]:
        """Where each line starts in `coords`; for areas, where each ring starts, and each polygon among the rings.

        Views of the table, without a copy. Each has one number more than there are parts. Points have none.
        """
        return tuple(np.frombuffer(part, dtype=np.int32) for part in self._layer.offsets())

    def __len__(self) -> int:
        return len(self._layer)

    def __getitem__(self, column: str) -> Any:
        """The values of an attribute: an array of numbers or of True and False, or a list of texts."""
        return self._layer.column(column)

    def __iter__(self) -> Iterator[dict[str, Any]]:
        """The attributes of each feature."""
        columns = {name: self[name] for name in self.columns}
        for k in range(len(self)):
            yield {name: values[k] for name, values in columns.items()}

    def to_geopandas(self) -> Any:
        """The layer as a GeoDataFrame. geopandas must be installed.

        >>> frame = tokosen.densify(tokosen.example(), 5).to_geopandas()
        >>> frame.crs.to_epsg(), len(frame)
        (6677, 7)
        """
        try:
            import geopandas
            import shapely
        except ImportError as error:
            raise ModuleNotFoundError("a GeoDataFrame needs geopandas: pip install geopandas") from error
        kind = {
            "Point": shapely.GeometryType.POINT,
            "LineString": shapely.GeometryType.LINESTRING,
            "Polygon": shapely.GeometryType.POLYGON,
        }[self.geometry_type]
        if len(self) == 0:
            geometry = np.array([], dtype=object)
        else:
            offsets = tuple(part.astype(np.int64) for part in self.offsets) or None
            geometry = shapely.from_ragged_array(kind, self.coords, offsets)
            if self.geometry_type == "Point":
                geometry[np.isnan(self.coords[:, 0])] = None
        columns = {name: self[name] for name in self.columns}
        return geopandas.GeoDataFrame(columns, geometry=list(geometry), crs=self._layer.crs)

    def to_file(
        self,
        path: str | os.PathLike[str],
        *,
        zooms: Mapping[int, float] | None = None,
        attribution: str | None = None,
        overwrite: bool = False,
    ) -> None:
        """Writes the layer: .gpkg, .geojson, .fgb, .parquet, .shp or .dxf, as the program does.

        A GeoPackage that exists keeps its other layers. Other files are replaced if tokosen made them; `overwrite` replaces all.

        Contours are also written as map tiles: .pmtiles, .mbtiles or "FOLDER/{z}/{x}/{y}.pbf". `zooms` are the intervals by zoom,
        each until the next, and the last one is the highest zoom; without it, the program's default. `attribution` is the source
        of the data, which maps show.

        >>> lines = tokosen.densify(tokosen.example(), 5)
        >>> lines.to_file(folder / "lines.gpkg")
        >>> lines.to_file(folder / "lines.pmtiles", zooms={12: 10, 14: 5})
        """
        warn_of(self._layer.write(os.fspath(path), tiling(zooms, attribution, overwrite)), stacklevel=3)

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        """The layer as a stream of Arrow, without a copy."""
        return self._layer.__arrow_c_stream__(requested_schema)

    def __repr__(self) -> str:
        columns = ", ".join(self.columns)
        return f"<Layer {self.name}: {len(self)} {self.geometry_type}, columns {columns}>"


def shaped(layer: _tokosen.Layer, output: Output, of_frame: bool) -> Any:
    """A result in the form that is asked for."""
    if output not in (None, "geopandas", "layer"):
        raise ValueError(f"output is {output!r}; it must be 'geopandas', 'layer' or None")
    made = Layer(layer)
    return made.to_geopandas() if output == "geopandas" or (output is None and of_frame) else made
