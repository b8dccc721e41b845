"""The ground between contours."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any, NamedTuple, Unpack

import numpy as np

from tokosen import _tokosen
from tokosen._crs import crs_text
from tokosen._dem import Dem
from tokosen._errors import FindingWarning, ParameterError
from tokosen._html import page
from tokosen._layers import Layer, Output, shaped
from tokosen._mesh import Mesh
from tokosen._options import Keep, RegionOptions, SkeletonOptions, SurfaceOptions, Unit, cells, options
from tokosen._sources import is_frame, sources
from tokosen._work import Progress, reporting, warn_of


class Accuracy(NamedTuple):
    """The expected error of heights, metres."""

    rmse: float
    """Root mean square."""
    le90: float
    """The error that 90 % of the heights are within."""


class Terrain:
    """The surface between contours: built once, asked often.

    `contours` are a path or a list of paths, a GeoDataFrame, an Arrow table with GeoArrow geometries, an object with
    `__geo_interface__`, or ragged arrays `(coords, offsets, elevations, crs)`: line k has the coordinates from `offsets[k]` to
    before `offsets[k + 1]`.

    `cell`, `cell_degrees` or `like` are the cells of the height map that will be asked for. Then the smooth surface has its nodes
    at their centres, as that of the program. With `uncertainty`, standard errors are estimated. `to_unit` is the unit of heights
    in arguments. `progress` is a function (step, share), or True for bars of tqdm. All other arguments are in `SurfaceOptions`.

    Findings about the input that may make the result wrong are warnings (`FindingWarning`); all are in `findings`.

    A pickled terrain holds what it was built from, and is built again when it is loaded; so its files must be there.

    >>> terrain = tokosen.Terrain(tokosen.example())
    >>> terrain
    <Terrain of 4 lines at 4 levels from 10 to 40 m, interval 10 m>
    >>> [len(layer) for layer in terrain.contours([5, 2])]
    [7, 18]
    >>> terrain.dem(cell=10).shape
    (58, 55)
    """

    def __init__(
        self,
        contours: Any,
        *,
        cell: float | None = None,
        cell_degrees: float | None = None,
        like: Any = None,
        uncertainty: bool = False,
        to_unit: Unit = "m",
        progress: Progress = None,
        **given: Unpack[SurfaceOptions],
    ) -> None:
        grid = cells(cell, cell_degrees, like, None)
        self._build(contours, grid, uncertainty, to_unit, False, progress, given)

    def _build(
        self,
        contours: Any,
        grid: dict[str, Any],
        uncertainty: bool,
        to_unit: Unit,
        only_dem: bool,
        progress: Progress,
        given: Any,
    ) -> None:
        self._recipe = (contours, grid, uncertainty, to_unit, only_dem, dict(given))
        self._of_frame = is_frame(contours)
        self._given = dict(given)
        self._contours = sources("contours", contours)
        self._to_unit: Unit = to_unit
        found = options(given, SurfaceOptions, uncertainty)
        with reporting(progress) as report:
            self._terrain = _tokosen.Terrain.build(self._contours, found, grid, to_unit, only_dem, report)
        warn_of(self._terrain.warned(), stacklevel=5)

    def __reduce__(self) -> Any:
        """For pickle: what the terrain was built from. It is built again in the other process."""
        return rebuilt, self._recipe

    def contours(
        self,
        interval: float | Sequence[float] | None = None,
        *,
        levels: Sequence[float] | None = None,
        base_level: float = 0.0,
        to_crs: Any = None,
        to_unit: Unit | None = None,
        to_depths: bool = False,
        index: int = 5,
        simplify: float | None = None,
        keep_input: bool = False,
        supplementary: float | Sequence[float] | None = None,
        supplementary_spacing: float | None = None,
        scale: float | None = None,
        thin: bool = False,
        output: Output = None,
        progress: Progress = None,
    ) -> Any:
        """The contours of the input, unchanged, with new ones between them.

        `interval` is one interval, or several: then the result is a list. `levels` are single elevations instead. `base_level` is the
        offset of the levels. One level in `index` is an index contour. `simplify` is the largest distance between a new contour
        and its course with fewer vertices (1 % of the mean spacing of the contours); 0 keeps all. The attributes are elev, source
        (input or interpolated), is_index, depression and closed; with `uncertainty` also err_v, err_h and inferred; with `to_depths`
        also depth, which is positive downwards.

        For a map: `supplementary` are half of the interval, or half and a quarter of it, at which contours are drawn where the ground
        needs them; `supplementary_spacing` is how far apart the others are there, metres. `scale` is the number of the map's scale:
        all lines are simplified for it, also those of the input, small rings are left out, and it chooses the interval if none is
        given. With `thin`, intermediate contours are left out on steep slopes. The attribute kind is then index, intermediate,
        supplementary or supplementary_quarter.

        >>> lines = tokosen.Terrain(tokosen.example()).contours(5)
        >>> sorted(set(lines["source"]))
        ['input', 'interpolated']
        """
        asked = levels_of(
            interval,
            levels,
            base_level,
            to_crs,
            to_unit or self._to_unit,
            index=index,
            supplementary=supplementary,
            supplementary_spacing=supplementary_spacing,
            scale=scale,
            thin=thin,
            to_depths=to_depths,
        )
        with reporting(progress) as report:
            found = self._terrain.contours(asked, simplify, keep_input, report)
        layers = [shaped(layer, output, self._of_frame) for layer in found]
        return layers if is_several(interval) else layers[0]

    def bands(
        self,
        interval: float | Sequence[float] | None = None,
        *,
        levels: Sequence[float] | None = None,
        base_level: float = 0.0,
        to_crs: Any = None,
        to_unit: Unit | None = None,
        to_depths: bool = False,
        output: Output = None,
        progress: Progress = None,
    ) -> Any:
        """The areas between the contours of an interval, up to the frame, as polygons.

        `interval`, `levels` and `base_level` are those of `contours`. The areas are a partition: where two meet, both have the vertices
        of the contour between them. The attributes are elev_from, elev_to, elev_mid (half-way between), kind (ground, lake or sea),
        area_m2 and share.

        >>> areas = tokosen.Terrain(tokosen.example()).bands(10)
        >>> round(float(sum(areas["share"])), 9)
        1.0
        """
        asked = levels_of(interval, levels, base_level, to_crs, to_unit or self._to_unit, to_depths=to_depths)
        with reporting(progress) as report:
            found, warned = self._terrain.bands(asked, report)
        warn_of(warned, stacklevel=3)
        layers = [shaped(layer, output, self._of_frame) for layer in found]
        return layers if is_several(interval) else layers[0]

    def labels(
        self,
        interval: float,
        *,
        height: float | None = None,
        base_level: float = 0.0,
        to_crs: Any = None,
        to_unit: Unit | None = None,
        to_depths: bool = False,
        index: int = 5,
        output: Output = None,
        progress: Progress = None,
    ) -> Any:
        """Labels of the index contours of an interval: points with text, elev, angle (degrees counter-clockwise) and height.

        `height` is that of the text, map units (a 250th of the map's longer side).

        >>> tokosen.Terrain(tokosen.example()).labels(2)["text"][0]
        '10'
        """
        size = 0.0 if height is None else float(height)
        if height is not None and not size > 0:
            raise ParameterError(f"height is {height}, it must be more than 0")
        unit = to_unit or self._to_unit
        asked = levels_of(interval, None, base_level, to_crs, unit, index=index, labels=size, to_depths=to_depths)
        with reporting(progress) as report:
            found = self._terrain.contours(asked, None, False, report)
        return shaped(found[1], output, self._of_frame)

    def dem(
        self,
        *,
        cell: float | None = None,
        cell_degrees: float | None = None,
        like: Any = None,
        to_crs: Any = None,
        max_zoom: int | None = None,
        tile_size: int = 512,
        progress: Progress = None,
    ) -> Dem:
        """The height map at the centres of cells, metres; with standard errors if the terrain was built with `uncertainty`.

        `cell` is the size of cells in units of the working CRS or of `to_crs`, or of contours without a CRS that are in feet;
        `cell_degrees` is in degrees. `like` is a raster whose cells are taken: a path, a Dem, a DataArray, or (values, transform,
        crs). With `max_zoom`, the cells are the pixels of terrain tiles of this zoom, which have `tile_size` of them (256 or 512).

        >>> tokosen.Terrain(tokosen.example(), uncertainty=True).dem(cell=10).error.shape
        (58, 55)
        """
        with reporting(progress) as report:
            return Dem(self._terrain.dem(cells(cell, cell_degrees, like, to_crs, max_zoom, tile_size), report))

    def sample(self, points: Any) -> tuple[np.ndarray[Any, np.dtype[np.float64]], np.ndarray[Any, np.dtype[np.float64]]]:
        """Heights at places and their standard errors, metres. NaN where there is no ground, and for errors if the terrain was
        built without `uncertainty`.

        `points` are (x, y) pairs in the coordinates of the contours: an array (n, 2), or a list.

        >>> heights, errors = tokosen.Terrain(tokosen.example()).sample([(0.0, 1e9)])
        >>> heights
        array([nan])
        """
        heights, errors = self._terrain.sample(_places("points", points))
        return np.asarray(heights), np.asarray(errors)

    def profile(self, line: Any, step: float | None = None) -> dict[str, np.ndarray[Any, np.dtype[np.float64]]]:
        """Heights along a line: arrays `distance` (metres from its start), `x`, `y`, `z` and `error` (metres), as columns of a frame.

        `line` is a LineString, or (x, y) pairs in the coordinates of the contours. Places are at most `step` metres apart (a 500th of
        the line), and all vertices of the line are among them.

        >>> terrain = tokosen.Terrain(tokosen.example())
        >>> sorted(terrain.profile([(0, 0), (100, 0)], step=50))
        ['distance', 'error', 'x', 'y', 'z']
        """
        columns = self._terrain.profile(_places("line", getattr(line, "coords", line)), step)
        return {name: np.asarray(column) for name, column in zip(("distance", "x", "y", "z", "error"), columns, strict=True)}

    def skeleton(self, *, output: Output = None, progress: Progress = None) -> Any:
        """Ridge and canyon lines with heights, as the function `skeleton` with the same input.

        >>> tokosen.Terrain(tokosen.example()).skeleton().geometry_type
        'LineString'
        """
        found = self._apart(SkeletonOptions)
        with reporting(progress) as report:
            layer, _ = _tokosen.skeleton(self._contours, found, None, self._to_unit, report)
        return shaped(layer, output, self._of_frame)

    def regions(self, *, output: Output = None, progress: Progress = None) -> Any:
        """The sub-domains between contours with their landforms, as the function `regions` with the same input.

        >>> tokosen.Terrain(tokosen.example()).regions()["class"]
        ['tableland', 'tableland', 'tableland', 'peak']
        """
        found = self._apart(RegionOptions)
        with reporting(progress) as report:
            layer, _ = _tokosen.regions(self._contours, found, None, self._to_unit, report)
        return shaped(layer, output, self._of_frame)

    def _apart(self, known: type) -> dict[str, Any]:
        """The options of a step that needs no surface."""
        names = known.__optional_keys__  # type: ignore[attr-defined]
        return options({name: value for name, value in self._given.items() if name in names}, known)

    def mesh(
        self,
        base_height: float | None = None,
        *,
        tolerance: float | None = None,
        cell: float | None = None,
        keep: Keep = "none",
        progress: Progress = None,
    ) -> Mesh:
        """A 3-D model of the surface; a closed solid if the height of its flat bottom is given, metres.

        With a `tolerance`, it has few triangles, none further than this from the surface at the centre of a cell of size `cell`,
        metres. Lines to `keep` are edges of these triangles, or chains of edges, with all their vertices: "contours" (of the input,
        with break lines), "breaklines" or "none".

        >>> terrain = tokosen.Terrain(tokosen.example())
        >>> terrain.mesh().is_solid
        False
        >>> len(terrain.mesh(tolerance=1).triangles) < len(terrain.mesh().triangles)
        True
        """
        if cell is not None and tolerance is None:
            raise ParameterError("cell has a meaning only with a tolerance")
        if keep != "none" and tolerance is None:
            raise ParameterError("keep has a meaning only with a tolerance: without it, all lines are edges")
        with reporting(progress) as report:
            return Mesh(self._terrain.mesh(base_height, tolerance, cell, keep, report))

    def to_html(
        self,
        interval: float | None = None,
        *,
        title: str = "",
        tolerance: float | None = None,
        cell: float | None = None,
        progress: Progress = None,
    ) -> str:
        """A page that shows the terrain in 3-D, with new contours at an interval in metres if it is given.

        One HTML file, which a browser opens from disk. Expected errors are in it if the terrain was built with `uncertainty`.

        >>> page = tokosen.Terrain(tokosen.example()).to_html(5, title="hill")
        >>> _ = (folder / "hill.html").write_text(page, encoding="utf-8")
        """
        with reporting(progress) as report:
            return self._terrain.html(title, interval, tolerance, cell, report)

    def pits(
        self, *, cell: float | None = None, like: Any = None, output: Output = None, progress: Progress = None
    ) -> Any:
        """The pits that are left in the smooth surface or, if cells are given, in the height map: points with depth, area, reason.

        >>> len(tokosen.Terrain(tokosen.example()).pits())
        0
        """
        with reporting(progress) as report:
            return shaped(self._terrain.pits(cells(cell, None, like, None), report), output, self._of_frame)

    def streams(self, *, output: Output = None) -> Any:
        """The streams as they are used: with direction, heights, Strahler order, and how far they were moved.

        >>> len(tokosen.Terrain(tokosen.example()).streams())
        0
        """
        return shaped(self._terrain.streams(), output, self._of_frame)

    def breaklines(self, *, output: Output = None) -> Any:
        """The break lines as they are used.

        >>> len(tokosen.Terrain(tokosen.example()).breaklines())
        0
        """
        return shaped(self._terrain.breaklines(), output, self._of_frame)

    @property
    def findings(self) -> Layer:
        """What was noticed about the input: points with code, severity, message, elevations and features.

        >>> tokosen.Terrain(tokosen.example()).findings["code"]
        []
        """
        return Layer(self._terrain.findings())

    @property
    def conflicts(self) -> Layer:
        """The findings about inputs that contradict each other."""
        return Layer(self._terrain.conflicts())

    @property
    def accuracy(self) -> Accuracy | None:
        """The expected error of heights, metres: `rmse`, root mean square, and `le90`, which 90 % of them are within. None if unknown.

        It is estimated by hiding contours. A small map has too few of them.

        >>> tokosen.Terrain(tokosen.example()).accuracy is None
        True
        """
        accuracy: tuple[float, float] | None = self._terrain.figures()["accuracy"]
        return None if accuracy is None else Accuracy(*accuracy)

    @property
    def interval(self) -> float:
        """The vertical interval of the contours, metres."""
        return float(self._terrain.figures()["interval"])

    def __repr__(self) -> str:
        figures = self._terrain.figures()
        low, high, count = figures["levels"]
        span = f"{count} levels from {low:g} to {high:g} m"
        return f"<Terrain of {figures['lines']} lines at {span}, interval {figures['interval']:g} m>"

    def _repr_html_(self) -> str:
        figures = self._terrain.figures()
        low, high, count = figures["levels"]
        accuracy = figures["accuracy"]
        rows = [
            ("contours", f"{figures['lines']} lines, {figures['vertices']} vertices"),
            ("levels", f"{count} from {low:g} to {high:g} m, interval {figures['interval']:g} m"),
            ("CRS", figures["crs"] or "unknown"),
            ("expected error", "unknown" if accuracy is None else f"{accuracy[0]:.2g} m (RMSE), 90 % within {accuracy[1]:.2g} m"),
            ("findings", len(self.findings)),
        ]
        notes = [f"{row['severity']}: {row['message']}" for row in self.findings]
        more = [f"and {len(notes) - 10} more"] if len(notes) > 10 else []
        return page("Terrain", rows, notes[:10] + more, self._terrain.picture())


def levels_of(
    interval: float | Sequence[float] | None,
    levels: Sequence[float] | None,
    base_level: float,
    to_crs: Any,
    to_unit: Unit,
    *,
    index: int = 5,
    supplementary: float | Sequence[float] | None = None,
    supplementary_spacing: float | None = None,
    scale: float | None = None,
    thin: bool = False,
    to_depths: bool = False,
    labels: float | None = None,
) -> dict[str, Any]:
    """The levels of lines, as the compiled functions take them. Intervals or levels must be given, or a scale that chooses one."""
    steps = numbers_of(interval)
    if interval is None and levels is None and scale is None or interval is not None and levels is not None:
        raise ParameterError("give either interval or levels")
    if interval is not None and not steps:
        raise ParameterError("interval is an empty list")
    return {
        "intervals": steps,
        "levels": None if levels is None else numbers_of(levels),
        "base_level": base_level,
        "to_crs": crs_text(to_crs),
        "to_unit": to_unit,
        "to_depths": to_depths,
        "index": index,
        "supplementary": numbers_of(supplementary),
        "supplementary_spacing": supplementary_spacing,
        "scale": None if scale is None else float(scale),
        "thin": thin,
        "labels": labels,
    }


def numbers_of(given: float | Sequence[float] | None) -> list[float]:
    """A number or several as a list."""
    return [] if given is None else [float(number) for number in np.atleast_1d(np.asarray(given, dtype=np.float64))]


def is_several(interval: Any) -> bool:
    """Whether it is a list of intervals, which gives a list of results."""
    return np.ndim(interval) > 0


def rebuilt(contours: Any, grid: dict[str, Any], uncertainty: bool, to_unit: Unit, only_dem: bool, given: Any) -> Terrain:
    """A terrain from what it was built from. What its findings warn of was said when it was built first."""
    terrain = Terrain.__new__(Terrain)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FindingWarning)
        terrain._build(contours, grid, uncertainty, to_unit, only_dem, None, given)
    return terrain


def terrain_for_dem(
    contours: Any, grid: dict[str, Any], uncertainty: bool, to_unit: Unit, progress: Progress, given: Any
) -> Terrain:
    """A terrain that is asked for height maps alone, which is quicker."""
    terrain = Terrain.__new__(Terrain)
    terrain._build(contours, grid, uncertainty, to_unit, True, progress, given)
    return terrain


def _places(name: str, given: Any) -> list[list[float]]:
    """(x, y) pairs as the extension module takes them; further coordinates do not count."""
    array = np.asarray(given, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] < 2:
        raise ParameterError(f"{name} must be pairs of x and y, an array (n, 2); it has the shape {array.shape}")
    places: list[list[float]] = array[:, :2].tolist()
    return places
