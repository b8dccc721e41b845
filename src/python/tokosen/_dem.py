"""Height maps and other rasters."""

from __future__ import annotations

import os
from typing import Any, NamedTuple

import numpy as np

from tokosen import _tokosen
from tokosen._crs import crs_object, crs_text
from tokosen._errors import ParameterError
from tokosen._html import page
from tokosen._mesh import Mesh
from tokosen._tiles import tiling
from tokosen._work import Progress, reporting, warn_of


class Transform(NamedTuple):
    """From cells to coordinates, as in rasterio: x = a * column + b * row + c, y = d * column + e * row + f.

    >>> tokosen.dem(tokosen.example(), cell=10).transform
    Transform(a=10.0, b=0.0, c=-250.0, d=0.0, e=-10.0, f=290.0)
    """

    a: float
    b: float
    c: float
    d: float
    e: float
    f: float


class Volume(NamedTuple):
    """Volumes above and below a level, cubic metres."""

    level: float
    """The level, metres; 0 between two height maps."""
    cut: float
    """Volume of the ground above the level."""
    fill: float
    """Volume between the ground and the level above it: what a reservoir holds."""
    cut_area: float
    """Area of the ground above the level, square metres."""
    fill_area: float
    """Area of the ground below the level, square metres."""
    error_most: float
    """Error of cut minus fill if all heights are wrong by their standard error in the same direction; NaN if it is not known."""


class Dem:
    """Values on a grid of cells with north up: heights, or what is derived from them.

    >>> dem = tokosen.dem(tokosen.example(), cell=10)
    >>> dem
    <Dem height, 55 x 58 cells of 10 x 10, 74 % with data>
    >>> dem.values.dtype, dem.transform.a, dem.bounds
    (dtype('float32'), 10.0, (-250.0, -290.0, 300.0, 290.0))
    """

    def __init__(self, raster: _tokosen.Raster) -> None:
        self._raster = raster

    @staticmethod
    def from_array(values: Any, transform: Any, crs: Any = None) -> Dem:
        """A height map from an array (rows, columns) of metres and a transform as in rasterio (an Affine, or six numbers).

        Cells that are NaN, infinite or masked have no data. The values are copied.

        >>> tokosen.Dem.from_array(np.zeros((4, 5)), (10, 0, 0, 0, -10, 40))
        <Dem height, 5 x 4 cells of 10 x 10, 100 % with data>
        """
        values = np.ma.asarray(values)
        if values.dtype.kind not in "iufb":
            raise TypeError(f"the values are {values.dtype}; they must be numbers")
        with np.errstate(over="ignore"):
            values = np.ma.filled(values.astype(np.float32), np.nan)
        if values.ndim != 2:
            raise ValueError(f"the values have {values.ndim} dimensions; they must have two: rows and columns")
        numbers = [float(number) for number in tuple(transform)[:6]]
        if len(numbers) != 6:
            raise ValueError(f"the transform has {len(numbers)} numbers; it must have six")
        return Dem(_tokosen.Raster.from_array(np.ascontiguousarray(values), numbers, crs_text(crs)))

    @staticmethod
    def read(path: str | os.PathLike[str]) -> Dem:
        """Reads a height map: .tif, .asc, .exr, .png, .xyz, or 基盤地図情報.

        >>> tokosen.dem(tokosen.example(), cell=10).to_file(folder / "hill.tif")
        >>> tokosen.Dem.read(folder / "hill.tif").values.shape
        (58, 55)
        """
        return Dem(_tokosen.Raster.read(os.fspath(path)))

    @property
    def values(self) -> np.ndarray[Any, np.dtype[np.float32]]:
        """The values (rows, columns), from north to south and west to east; NaN where there is no data.

        The array of the raster itself, not a copy: what is changed in it is written by `to_file`.
        """
        return self._raster.values

    @property
    def error(self) -> np.ndarray[Any, np.dtype[np.float32]] | None:
        """The standard errors of the heights, metres, in the shape of `values`; None if they were not asked for."""
        return self._raster.error

    @property
    def transform(self) -> Transform:
        """From cells to coordinates. `affine.Affine(*dem.transform)` makes rasterio's object of it."""
        return Transform(*self._raster.transform)

    @property
    def crs(self) -> Any:
        """The CRS: a pyproj.CRS if pyproj is installed, otherwise a text; None if it is unknown."""
        return crs_object(self._raster.crs)

    @property
    def quantity(self) -> str:
        """What the values are: "height", "slope" and so on."""
        return self._raster.quantity

    @property
    def notes(self) -> list[str]:
        """What was noticed when it was read or made."""
        return self._raster.notes

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, columns = self.values.shape
        return rows, columns

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Least x, least y, greatest x, greatest y of the cells."""
        a, _, c, _, e, f = self.transform
        rows, columns = self.shape
        return c, f + e * rows, c + a * columns, f

    def volume(self, level: Any = None, *, other: Any = None, sigma: float | None = None) -> Any:
        """Volumes above a level (`cut`) and below it (`fill`), or between this height map and another one with the same cells.

        `level` is a height or several of them, metres; for several, the result is a list. `other` is a height map: then `cut` is the
        volume where this one is higher. Volumes are cubic metres, areas square metres. `error_most` is the error of the net volume
        if all heights are wrong by their standard error in the same direction; `sigma` is that error if the height map has none.

        >>> dem = tokosen.dem(tokosen.example(), cell=10)
        >>> dem.volume(0).fill
        0.0
        """
        levels = [0.0] if level is None else np.atleast_1d(np.asarray(level, dtype=np.float64)).tolist()
        beside = None if other is None else raster("other", other)
        found = [Volume(*row) for row in self._raster.volume(levels, beside, sigma)]
        return found if np.ndim(level) > 0 else found[0]

    def shifted(self, grid: str | os.PathLike[str], *, inverse: bool = False) -> Dem:
        """The heights in another height system: with the values of a grid added, or taken off with `inverse`.

        `grid` is a file: .gtx, .tif as in PROJ-data, .isg or .par. Values between nodes are bilinear. Cells outside of the grid lose
        their heights; `notes` tell how many. The CRS names the height system if the grid does.

        >>> hill = tokosen.Dem.from_array(np.full((2, 2), 9.0), (1e-3, 0, 138.0, 0, -1e-3, 35.002), "EPSG:6668")
        >>> tokosen.Dem.from_array(np.full((9, 9), 0.5), (1, 0, 134, 0, -1, 39), "EPSG:6668").to_file(folder / "half.tif")
        >>> hill.shifted(folder / "half.tif").values.tolist()
        [[9.5, 9.5], [9.5, 9.5]]
        """
        return Dem(self._raster.shifted(os.fspath(grid), inverse))

    def mesh(
        self, base_height: float | None = None, *, tolerance: float | None = None, progress: Progress = None
    ) -> Mesh:
        """A 3-D model of the heights; a closed solid if the height of its flat bottom is given, metres.

        It has two triangles between the centres of each four neighbouring cells. With a `tolerance`, it has few triangles, none
        further than this from the height of a cell, metres. Cells without data are no ground. If the cells are not on a plane in
        metres, heights are interpolated in cells that are.

        >>> dem = tokosen.dem(tokosen.example(), cell=10)
        >>> dem.mesh(0).is_solid
        True
        >>> len(dem.mesh(tolerance=1).triangles) < len(dem.mesh().triangles)
        True
        """
        with reporting(progress) as report:
            return Mesh(self._raster.mesh(base_height, tolerance, report))

    def to_html(
        self,
        interval: float | None = None,
        *,
        title: str = "",
        tolerance: float | None = None,
        cell: float | None = None,
        progress: Progress = None,
    ) -> str:
        """A page that shows the heights in 3-D, with contours at an interval in metres if it is given.

        One HTML file, which a browser opens from disk. `cell` is the size of its cells, metres, if they are to be others.

        >>> page = tokosen.dem(tokosen.example(), cell=10).to_html(5, title="hill")
        >>> _ = (folder / "hill.html").write_text(page, encoding="utf-8")
        """
        with reporting(progress) as report:
            return self._raster.html(title, interval, tolerance, cell, report)

    def to_xarray(self, *, error: bool = False) -> Any:
        """A DataArray with the coordinates of cell centres, and the CRS as rioxarray and GDAL write it. xarray must be installed.

        With `error`, a Dataset of the heights and their standard errors (`error`). The values are not copied.

        >>> array = tokosen.dem(tokosen.example(), cell=10).to_xarray()
        >>> array.dims, array.attrs["units"]
        (('y', 'x'), 'm')
        >>> list(tokosen.dem(tokosen.example(), cell=10, uncertainty=True).to_xarray(error=True))
        ['height', 'error']
        """
        if error and self.error is None:
            raise ParameterError("this raster has no standard errors: make it with uncertainty=True")
        try:
            import xarray
        except ImportError as error:
            raise ModuleNotFoundError("a DataArray needs xarray: pip install xarray") from error
        a, _, c, _, e, f = self.transform
        rows, columns = self.shape
        coords: dict[str, Any] = {"y": f + e * (np.arange(rows) + 0.5), "x": c + a * (np.arange(columns) + 0.5)}
        place: dict[str, Any] = {"GeoTransform": f"{c} {a} 0 {f} 0 {e}"}
        crs = self.crs
        if hasattr(crs, "to_cf"):
            place |= crs.to_cf()
        elif crs is not None:
            place["spatial_ref"] = crs
        coords["spatial_ref"] = xarray.DataArray(0, attrs=place)
        attrs = {"units": "m", "long_name": self.quantity, "grid_mapping": "spatial_ref"}
        if self.quantity not in ("height", "difference in height"):
            del attrs["units"]
        name = self.quantity.replace(" ", "_")
        array = xarray.DataArray(self.values, coords=coords, dims=("y", "x"), name=name, attrs=attrs)
        if not error:
            return array
        errors = xarray.DataArray(self.error, coords=coords, dims=("y", "x"), attrs=attrs | {"long_name": "standard error"})
        return xarray.Dataset({name: array, "error": errors})

    def to_file(
        self,
        path: str | os.PathLike[str],
        *,
        to_unit: str = "m",
        cog: bool = False,
        png_encoding: str | None = None,
        tile_size: int = 512,
        tile_image: str = "png",
        attribution: str | None = None,
        overwrite: bool = False,
    ) -> None:
        """Writes the raster: .tif, .exr, .png, .asc or .xyz, as the program does. Standard errors become a second band.

        `to_unit` is the unit of heights: "m", "ft" or "us-ft". `cog` writes a Cloud Optimized GeoTIFF. `png_encoding` is
        "gray16", "gsi", "terrarium" or "mapbox". Files that other programs made are replaced with `overwrite` only.

        A height map that was made with `max_zoom` is also written as terrain tiles: .pmtiles, .mbtiles or
        "FOLDER/{z}/{x}/{y}.png". `png_encoding` is then "terrarium" if it is not given, `tile_size` 512 or 256 pixels, and
        `tile_image` "png" or "webp". `attribution` is the source of the data, which maps show.

        >>> tokosen.dem(tokosen.example(), cell=10).to_file(folder / "dem.tif", cog=True)
        >>> tokosen.dem(tokosen.example(), max_zoom=16).to_file(folder / "terrain.pmtiles", tile_image="webp")
        """
        asked = {
            "to_unit": to_unit,
            "cog": cog,
            "png_encoding": png_encoding,
            "tile_size": tile_size,
            "tile_image": tile_image,
        }
        warned = self._raster.write(os.fspath(path), asked, tiling(None, attribution, overwrite))
        warn_of([warned] if warned else [], stacklevel=3)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        """The values, for functions of numpy."""
        if dtype is None or np.dtype(dtype) == self.values.dtype:
            return self.values.copy() if copy else self.values
        if copy is False:
            raise ValueError(f"the values are {self.values.dtype}: {np.dtype(dtype)} needs a copy")
        return self.values.astype(dtype)

    def __repr__(self) -> str:
        rows, columns = self.shape
        a, e = self.transform.a, -self.transform.e
        share = 100 * np.count_nonzero(~np.isnan(self.values)) / self.values.size
        error = ", with standard errors" if self.error is not None else ""
        return f"<Dem {self.quantity}, {columns} x {rows} cells of {a:g} x {e:g}, {share:.0f} % with data{error}>"

    def _repr_html_(self) -> str:
        picture = self._raster.picture() if self.quantity == "height" else None
        rows, columns = self.shape
        valid = self.values[~np.isnan(self.values)]
        figures = [
            ("values", self.quantity),
            ("cells", f"{columns} x {rows} of {self.transform.a:g} x {-self.transform.e:g}"),
            ("with data", f"{100 * valid.size / self.values.size:.1f} %"),
            ("from, to", f"{valid.min():.2f}, {valid.max():.2f}" if valid.size else "no data"),
            ("CRS", getattr(self.crs, "name", self.crs) or "unknown"),
        ]
        return page("Dem", figures, self.notes, picture)


def raster(what: str, given: Any) -> _tokosen.Raster:
    """A height map of the extension module, from a Dem, a DataArray, or an array with its place."""
    if isinstance(given, Dem):
        return given._raster
    if isinstance(given, str | os.PathLike):
        return _tokosen.Raster.read(os.fspath(given))
    if isinstance(given, tuple) and len(given) in (2, 3):
        return Dem.from_array(*given)._raster
    if all(hasattr(given, name) for name in ("dims", "coords", "values")):
        return _of_data_array(what, given)._raster
    raise TypeError(f"{what} is of type {type(given).__name__}; it must be a path, a Dem, a DataArray, or (values, transform, crs)")


def _of_data_array(what: str, array: Any) -> Dem:
    """A height map from a DataArray of two dimensions with coordinates x and y."""
    array = array.squeeze()
    if len(array.dims) != 2:
        raise ValueError(f"{what} has the dimensions {', '.join(map(str, array.dims))}; it must have two: y and x")
    axes = []
    for name in array.dims:
        if name not in array.coords:
            raise ValueError(f"{what} has no coordinates {name}")
        centres = np.asarray(array.coords[name].values, dtype=np.float64)
        if centres.ndim != 1 or len(centres) < 2:
            raise ValueError(f"{what} has fewer than two cells along {name}")
        step = (centres[-1] - centres[0]) / (len(centres) - 1)
        if not np.allclose(np.diff(centres), step, rtol=1e-3, atol=0):
            raise ValueError(f"the coordinates {name} of {what} are not evenly spaced")
        axes.append((centres, step))
    (y, height), (x, width) = axes
    values = np.asarray(array.values, dtype=np.float32)
    if height > 0:
        values, y, height = values[::-1], y[::-1], -height
    if width < 0:
        values, x, width = values[:, ::-1], x[::-1], -width
    missing = array.attrs.get("_FillValue", array.attrs.get("nodatavals", (np.nan,)))
    for value in np.atleast_1d(missing):
        if not np.isnan(value):
            values = np.where(values == np.float32(value), np.float32(np.nan), values)
    return Dem.from_array(values, (width, 0, x[0] - width / 2, 0, height, y[0] - height / 2), _crs_of(array))


def _crs_of(array: Any) -> Any:
    """The CRS of a DataArray, as rioxarray and `Dem.to_xarray` note it."""
    for name in (array.attrs.get("grid_mapping"), array.encoding.get("grid_mapping"), "spatial_ref", "crs"):
        if name is not None and name in array.coords:
            attrs = array.coords[name].attrs
            return attrs.get("crs_wkt") or attrs.get("spatial_ref")
    return array.attrs.get("crs")
