"""The functions of the package: one for each verb of the program."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from typing import Any, Literal, Unpack

from tokosen import _tokosen
from tokosen._crs import crs_text
from tokosen._dem import Dem, raster
from tokosen._html import page
from tokosen._layers import Layer, Output, shaped
from tokosen._mesh import Mesh
from tokosen._options import (
    CheckOptions,
    GroundOptions,
    Keep,
    RegionOptions,
    SideOptions,
    SkeletonOptions,
    SurfaceOptions,
    Unit,
    cells,
    height_map,
    options,
)
from tokosen._sources import is_frame, places, source, sources
from tokosen._terrain import Terrain, is_several, levels_of, terrain_for_dem
from tokosen._work import Progress, reporting, warn_of


def densify(
    contours: Any,
    interval: float | Sequence[float] | None = None,
    *,
    levels: Sequence[float] | None = None,
    base_level: float = 0.0,
    to_crs: Any = None,
    to_unit: Unit = "m",
    to_depths: bool = False,
    index: int = 5,
    simplify: float | None = None,
    keep_input: bool = False,
    supplementary: float | Sequence[float] | None = None,
    supplementary_spacing: float | None = None,
    scale: float | None = None,
    thin: bool = False,
    uncertainty: bool = False,
    output: Output = None,
    progress: Progress = None,
    **given: Unpack[SurfaceOptions],
) -> Any:
    """Contour lines at a finer interval, as the command `tokosen densify`.

    A GeoDataFrame gives a GeoDataFrame; everything else gives a Layer, unless `output` says otherwise. With several intervals,
    the result is a list. `base_level` is the offset of the levels. See `Terrain` for the contours and the other arguments, and
    `Terrain.contours` for what is returned.

    >>> lines = tokosen.densify(tokosen.example(), 5)
    >>> lines.name, len(lines)
    ('contours_5m', 7)
    """
    levels_of(interval, levels, base_level, to_crs, to_unit, supplementary=supplementary, scale=scale)
    terrain = Terrain(contours, uncertainty=uncertainty, to_unit=to_unit, progress=progress, **given)
    return terrain.contours(
        interval,
        levels=levels,
        base_level=base_level,
        to_crs=to_crs,
        index=index,
        simplify=simplify,
        keep_input=keep_input,
        supplementary=supplementary,
        supplementary_spacing=supplementary_spacing,
        scale=scale,
        thin=thin,
        to_depths=to_depths,
        output=output,
        progress=progress,
    )


def dem(
    contours: Any,
    cell: float | None = None,
    *,
    cell_degrees: float | None = None,
    like: Any = None,
    to_crs: Any = None,
    max_zoom: int | None = None,
    tile_size: int = 512,
    uncertainty: bool = False,
    progress: Progress = None,
    **given: Unpack[SurfaceOptions],
) -> Dem:
    """A height map, as the command `tokosen dem`. See `Terrain.dem` for the cells, `Terrain` for the contours and the other arguments.

    >>> tokosen.dem(tokosen.example(), cell=5, uncertainty=True)
    <Dem height, 110 x 114 cells of 5 x 5, 75 % with data, with standard errors>
    """
    grid = cells(cell, cell_degrees, like, to_crs, max_zoom, tile_size)
    terrain = terrain_for_dem(contours, grid, uncertainty, "m", progress, given)
    with reporting(progress) as report:
        return Dem(terrain._terrain.dem(grid, report))


def mesh(
    contours: Any,
    base_height: float | None = None,
    *,
    tolerance: float | None = None,
    cell: float | None = None,
    keep: Keep = "none",
    progress: Progress = None,
    **given: Unpack[SurfaceOptions],
) -> Mesh:
    """A 3-D model, as the command `tokosen mesh`; a solid if the height of its flat bottom is given.

    >>> tokosen.mesh(tokosen.example(), 0).is_solid
    True
    """
    terrain = Terrain(contours, cell=cell, progress=progress, **given)
    return terrain.mesh(base_height, tolerance=tolerance, cell=cell, keep=keep, progress=progress)


def regions(
    contours: Any,
    *,
    to_crs: Any = None,
    to_unit: Unit = "m",
    output: Output = None,
    progress: Progress = None,
    **given: Unpack[RegionOptions],
) -> Any:
    """The sub-domains between contours as areas with their landforms, as the command `tokosen regions`.

    >>> tokosen.regions(tokosen.example())["class"]
    ['tableland', 'tableland', 'tableland', 'peak']
    """
    found = options(given, RegionOptions)
    with reporting(progress) as report:
        layer, warned = _tokosen.regions(sources("contours", contours), found, crs_text(to_crs), to_unit, report)
    warn_of(warned, stacklevel=3)
    return shaped(layer, output, is_frame(contours))


def skeleton(
    contours: Any,
    *,
    to_crs: Any = None,
    to_unit: Unit = "m",
    output: Output = None,
    progress: Progress = None,
    **given: Unpack[SkeletonOptions],
) -> Any:
    """Ridge and canyon lines with heights, as the command `tokosen skeleton`.

    >>> "kind" in tokosen.skeleton(tokosen.example()).columns
    True
    """
    found = options(given, SkeletonOptions)
    with reporting(progress) as report:
        layer, warned = _tokosen.skeleton(sources("contours", contours), found, crs_text(to_crs), to_unit, report)
    warn_of(warned, stacklevel=3)
    return shaped(layer, output, is_frame(contours))


def contour(
    dem: Any,
    interval: float | Sequence[float] | None = None,
    *,
    levels: Sequence[float] | None = None,
    base_level: float = 0.0,
    to_crs: Any = None,
    to_unit: Unit = "m",
    to_depths: bool = False,
    index: int = 5,
    tolerance: float | None = None,
    smooth: float | None = None,
    supplementary: float | Sequence[float] | None = None,
    supplementary_spacing: float | None = None,
    scale: float | None = None,
    thin: bool = False,
    output: Output = None,
    progress: Progress = None,
    **given: Unpack[GroundOptions],
) -> Any:
    """Contour lines of a height map, smooth and with few vertices, as the command `tokosen contour`.

    `dem` is a path, a Dem, a DataArray, or (values, transform, crs). `tolerance` is how far lines may be from the bilinear surface
    of the heights, map units (half a cell); at least a thousandth of a cell is used. `smooth` smooths noisy heights first, by this
    distance. `extent` or `clip` is the part of the height map that the lines are cut to; outside of `frame` is no ground.
    `supplementary`, `supplementary_spacing`, `scale`, `thin` and `to_depths` are those of `Terrain.contours`.

    >>> hill = tokosen.dem(tokosen.example(), cell=10)
    >>> sorted(set(tokosen.contour(hill, 10)["elev"].tolist()))
    [20.0, 30.0, 40.0]
    """
    asked = levels_of(
        interval,
        levels,
        base_level,
        to_crs,
        to_unit,
        index=index,
        supplementary=supplementary,
        supplementary_spacing=supplementary_spacing,
        scale=scale,
        thin=thin,
        to_depths=to_depths,
    )
    ground = options(given, GroundOptions)
    with reporting(progress) as report:
        found, warned = _tokosen.contour(raster("dem", dem), ground, asked, tolerance, smooth, report)
    warn_of(warned, stacklevel=3)
    layers = [shaped(layer, output, False) for layer in found]
    return layers if is_several(interval) else layers[0]


def bands(
    dem: Any,
    interval: float | Sequence[float] | None = None,
    *,
    levels: Sequence[float] | None = None,
    base_level: float = 0.0,
    to_crs: Any = None,
    to_unit: Unit = "m",
    to_depths: bool = False,
    output: Output = None,
    progress: Progress = None,
    **given: Unpack[GroundOptions],
) -> Any:
    """The areas between the contours of a height map, as polygons. For those between contours see `Terrain.bands`.

    The arguments are those of `contour`; the attributes are those of `Terrain.bands`.

    >>> hill = tokosen.dem(tokosen.example(), cell=10)
    >>> sorted(set(tokosen.bands(hill, 10)["elev_from"].tolist()))
    [10.0, 20.0, 30.0, 40.0]
    """
    asked = levels_of(interval, levels, base_level, to_crs, to_unit, to_depths=to_depths)
    ground = options(given, GroundOptions)
    with reporting(progress) as report:
        found, warned = _tokosen.bands(raster("dem", dem), ground, asked, report)
    warn_of(warned, stacklevel=3)
    layers = [shaped(layer, output, False) for layer in found]
    return layers if is_several(interval) else layers[0]


Derived = Literal[
    "slope",
    "aspect",
    "hillshade",
    "flow_direction",
    "flow_accumulation",
    "steep",
    "catchments",
    "stream_lines",
    "flood",
    "flood_areas",
]


def derive(
    dem: Any,
    what: Derived,
    *,
    azimuth: float = 315.0,
    altitude: float = 45.0,
    z_factor: float = 1.0,
    multidirectional: bool = False,
    steep_angle: float = 30.0,
    steep_height: float = 5.0,
    accumulation_unit: Literal["cells", "m2"] = "cells",
    outlet: Any = None,
    outlet_snap: float | None = None,
    threshold: float | None = None,
    flood_level: float | str | None = None,
    flood_from: Any = None,
    flood_bands: Sequence[float] = (),
    output: Output = None,
    progress: Progress = None,
) -> Any:
    """A raster, lines or areas from a height map, as the command `tokosen derive`.

    `dem` is a path, a Dem, a DataArray, or (values, transform, crs). "slope" and "aspect" are in degrees. "hillshade" takes
    `azimuth`, `altitude`, `z_factor` and `multidirectional`. "flow_direction" and "flow_accumulation" are D8. These are a Dem.
    "steep" gives areas of at least `steep_angle` degrees and `steep_height` metres, "catchments" an area for each outlet.

    Water: "flow_accumulation" counts cells, or square metres (`accumulation_unit`). With `outlet`, "catchments" gives those above
    these places only; each moves to the largest stream within `outlet_snap` metres (default: 3 cells). "stream_lines" are lines
    where at least `threshold` square metres drain through a cell. "flood" is the depth of water, "flood_areas" its outline and
    volume: below `flood_level` and joined to the edge or to `flood_from`; or, with a text such as "+3", 3 m above the streams.
    `flood_bands` parts "flood_areas" at these depths in metres, from small to large. Places are (x, y), several of them, or points
    of a GeoDataFrame.

    >>> hill = tokosen.dem(tokosen.example(), cell=10)
    >>> tokosen.derive(hill, "slope").quantity, tokosen.derive(hill, "steep", steep_angle=5).geometry_type
    ('slope', 'Polygon')
    """
    numbers = [float(number) for number in (azimuth, altitude, z_factor, steep_angle, steep_height)]
    with reporting(progress) as report:
        cells = raster("dem", dem)
        is_rise = isinstance(flood_level, str) and flood_level.strip().startswith("+")
        water = {
            "accumulation_unit": accumulation_unit,
            "outlet": places("outlet", outlet, cells.crs),
            "outlet_snap": outlet_snap,
            "threshold": threshold,
            "flood_level": None if flood_level is None or is_rise else float(flood_level),
            "flood_rise": float(flood_level) if flood_level is not None and is_rise else None,
            "flood_from": places("flood_from", flood_from, cells.crs),
            "flood_bands": [float(depth) for depth in flood_bands],
        }
        found, warned = _tokosen.derive(cells, what, multidirectional, numbers, None, water, report)
    warn_of(warned, stacklevel=3)
    return Dem(found) if isinstance(found, _tokosen.Raster) else shaped(found, output, False)


class Check:
    """The findings about contours, and the contours with safe repairs.

    >>> found = tokosen.check(tokosen.example())
    >>> found.ok, len(found.findings), found.figures["interval"]
    (True, 0, 10.0)
    """

    def __init__(self, findings: _tokosen.Layer, figures: str, repaired: list[_tokosen.Layer], of_frame: bool) -> None:
        self.findings = Layer(findings)
        """All findings: points with code, severity, message, elevations, features and a proposed repair."""
        self.figures: dict[str, Any] = json.loads(figures)
        """What `tokosen check --json` prints: the input, the counts, and each finding."""
        self._repaired = repaired
        self._of_frame = of_frame

    @property
    def ok(self) -> bool:
        """Whether no finding is an error or a warning."""
        return not (self.figures["counts"]["error"] or self.figures["counts"]["warning"])

    def repaired(self, *, output: Output = None) -> Any:
        """The contours, repaired as far as `repair` allowed.

        >>> tokosen.check(tokosen.example()).repaired().columns
        ['elev', 'feature', 'depression']
        """
        return shaped(self._repaired[0], output, self._of_frame)

    def spots(self, *, output: Output = None) -> Any:
        """The spot heights that come with the contours or were given; None if there are none.

        >>> len(tokosen.check(tokosen.example(), points=np.array([[0.0, 0.0, 45.0]])).spots())
        1
        """
        return shaped(self._repaired[1], output, self._of_frame) if len(self._repaired) > 1 else None

    def __repr__(self) -> str:
        counts = ", ".join(f"{count} {severity}s" for severity, count in self.figures["counts"].items())
        return f"<Check of {self.figures['lines']} lines: {counts}>"

    def _repr_html_(self) -> str:
        notes = [f"{row['severity']}: {row['message']}" for row in self.findings]
        more = [f"and {len(notes) - 10} more"] if len(notes) > 10 else []
        return page("Check", [("lines", self.figures["lines"]), *self.figures["counts"].items()], notes[:10] + more)


def check(
    contours: Any,
    *,
    to_crs: Any = None,
    to_unit: Unit = "m",
    progress: Progress = None,
    **given: Unpack[CheckOptions],
) -> Check:
    """The faults of contours, their places and proposed repairs, as the command `tokosen check`.

    Lakes, streams and break lines that are given are compared with the contours. Nothing is a warning here: see `Check.findings`.

    >>> tokosen.check(tokosen.example())
    <Check of 4 lines: 0 errors, 0 notes, 0 warnings>
    """
    found = options(given, CheckOptions)
    with reporting(progress) as report:
        findings, figures, repaired, _ = _tokosen.check(
            sources("contours", contours), found, crs_text(to_crs), to_unit, report
        )
    return Check(findings, figures, repaired, is_frame(contours))


class Comparison:
    """The differences between two height maps or surfaces, A minus B, metres.

    >>> hill = tokosen.dem(tokosen.example(), cell=10)
    >>> found = tokosen.compare(tokosen.example(), hill)
    >>> found.figures["overall"]["rmse"] < 0.5
    True
    """

    def __init__(self, comparison: _tokosen.Comparison, recipe: tuple[Any, Any, dict[str, Any]]) -> None:
        self._comparison = comparison
        self._recipe = recipe

    def __reduce__(self) -> Any:
        """For pickle: the two sides and the options. They are compared again in the other process."""
        return _compared, self._recipe

    @property
    def figures(self) -> dict[str, Any]:
        """What `tokosen compare --json` prints: figures over all cells and by class."""
        figures: dict[str, Any] = json.loads(self._comparison.json())
        return figures

    @property
    def text(self) -> str:
        """The table of figures, and what they mean."""
        return "\n".join(self._comparison.text())

    @property
    def difference(self) -> Dem:
        """A minus B, metres, as a raster.

        >>> hill = tokosen.dem(tokosen.example(), cell=10)
        >>> tokosen.compare(tokosen.example(), hill).difference.quantity
        'difference in height'
        """
        return Dem(self._comparison.difference())

    def to_html(self, path: str | os.PathLike[str] | None = None, *, overwrite: bool = False) -> str | None:
        """The report, a page with maps, charts and tables: written to a file, or returned.

        >>> tokosen.compare(tokosen.example(), tokosen.dem(tokosen.example(), cell=10)).to_html(folder / "report.html")
        """
        if path is None:
            return self._comparison.page()
        self._comparison.write_page(os.fspath(path), overwrite)
        return None

    def __repr__(self) -> str:
        overall = self.figures["overall"]
        return f"<Comparison of {overall['cells']} cells: bias {overall['bias']:.2f} m, RMSE {overall['rmse']:.2f} m>"

    def _repr_html_(self) -> str:
        overall = self.figures["overall"]
        names = {"bias": "bias", "RMSE": "rmse", "90 % within": "le90"}
        rows = [("cells", str(overall["cells"])), *((shown, f"{overall[name]:.2f} m") for shown, name in names.items())]
        return page("Comparison: A minus B", rows, self._comparison.text()[:2], self._comparison.picture())


def compare(
    a: Any,
    b: Any,
    *,
    cell: float | None = None,
    like: Any = None,
    points: Any = None,
    sigma: float | None = None,
    interval: float | None = None,
    progress: Progress = None,
    **given: Unpack[SideOptions],
) -> Comparison:
    """Compares two height maps or surfaces of contours, as the command `tokosen compare`. B is the reference.

    Each side is a height map (a path, a Dem, a DataArray, or (values, transform, crs)), contours (as for `Terrain`), or a Terrain.
    Two surfaces need a grid: `cell` or `like`. `points` are check points. `sigma` is the stated accuracy, metres; `interval` that
    at whose levels terraces are searched for.

    >>> tokosen.compare(tokosen.example(), tokosen.dem(tokosen.example(), cell=10))
    <Comparison of 2350 cells: bias 0.00 m, RMSE 0.00 m>
    """
    found = options(given, SideOptions)
    side_a, side_b = _side("a", a), _side("b", b)
    checks = None if points is None else source("points", points)
    with reporting(progress) as report:
        made = _tokosen.compare(side_a, side_b, found, cells(cell, None, like, None), [sigma, interval], checks, report)
    asked = {"cell": cell, "like": like, "points": points, "sigma": sigma, "interval": interval, **given}
    return Comparison(made, (a, b, asked))


def _compared(a: Any, b: Any, asked: dict[str, Any]) -> Comparison:
    """A comparison of what was compared before."""
    return compare(a, b, **asked)


RASTERS = (".tif", ".tiff", ".asc", ".exr", ".png", ".xyz")


def _side(what: str, given: Any) -> Any:
    """One side of a comparison as the extension module takes it."""
    if isinstance(given, Terrain):
        return given._terrain
    if isinstance(given, str | os.PathLike):
        path = os.fspath(given)
        is_raster = str(path).lower().endswith(RASTERS)
        return path if is_raster else sources("contours", given)
    is_array = isinstance(given, tuple) and len(given) in (2, 3) and getattr(given[0], "ndim", 0) == 2 and len(tuple(given[1])) >= 6
    is_data_array = all(hasattr(given, name) for name in ("dims", "coords", "values"))
    if isinstance(given, Dem) or is_data_array or (is_array and len(tuple(given[1])) in (6, 9)):
        return height_map(what, given)
    return sources("contours", given)
