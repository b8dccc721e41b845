"""Faulty input gives an exception with a sentence, or a warning. The interpreter never crashes."""

import threading
import warnings

import geopandas
import numpy as np
import pandas
import pytest
import shapely

import tokosen


def hill(dtype=float):
    """Two rings as ragged arrays."""
    angles = np.linspace(0, 2 * np.pi, 40)
    ring = np.column_stack([np.cos(angles), np.sin(angles)])
    ring[-1] = ring[0]
    coords = np.concatenate([200 * ring, 80 * ring])
    return coords.astype(dtype), np.array([0, 40, 80]), np.array([10.0, 20.0])


def frame():
    coords, offsets, elevations = hill()
    lines = shapely.from_ragged_array(shapely.GeometryType.LINESTRING, coords, (offsets,))
    return geopandas.GeoDataFrame({"elev": elevations}, geometry=lines, crs=6677)


@pytest.mark.parametrize("wrong", [None, 5, 1.5, object(), [], [1, 2], {}, "", pandas.DataFrame({"a": [1]}), (1, 2), b"x"])
def test_a_wrong_type_is_told(wrong):
    with pytest.raises((TypeError, tokosen.Error)) as told:
        tokosen.densify(wrong, 5)
    assert str(told.value)


def test_contours_that_are_missing_are_named():
    with pytest.raises(TypeError, match="contours is None; it must be a path, a GeoDataFrame"):
        tokosen.dem(None, 5)


def test_empty_frames_and_frames_without_lines():
    with pytest.raises(tokosen.InputError, match="no contour|no line|there is no"):
        tokosen.dem(frame().iloc[:0], 10)
    points = geopandas.GeoDataFrame({"elev": [1.0]}, geometry=[shapely.Point(0, 0)], crs=6677)
    with pytest.raises(tokosen.InputError, match="line"):
        tokosen.dem(points, 10)


def test_missing_and_mixed_geometries_are_findings():
    given = frame()
    others = geopandas.GeoDataFrame(
        {"elev": [10.0, np.nan, 10.0]}, geometry=[None, shapely.Point(0, 0).buffer(5), shapely.LineString()], crs=6677
    )
    with pytest.warns(tokosen.FindingWarning):
        dem = tokosen.dem(pandas.concat([given, others]), 20)
    assert np.array_equal(dem.values, tokosen.dem(given, 20).values, equal_nan=True)


def test_nan_in_coordinates_and_elevations():
    coords, offsets, elevations = hill()
    coords[3] = np.nan
    with pytest.warns(tokosen.FindingWarning, match="coordinates"):
        assert np.isfinite(tokosen.dem((coords, offsets, elevations), 20).values).any()
    with pytest.raises(tokosen.InputError, match="no contour line"):
        tokosen.dem((coords, offsets, np.full(2, np.nan)), 20)


def test_a_tolerance_that_is_raised_is_told():
    truth = tokosen.dem(frame(), 20)
    with pytest.warns(tokosen.FindingWarning, match="tolerance 0.01 is less than a thousandth of a cell: 0.02 is used"):
        tokosen.contour(truth, 10, tolerance=0.01)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tokosen.contour(truth, 10, tolerance=0.02)


def test_an_error_has_the_findings_that_explain_it():
    coords, offsets, elevations = hill()
    coords[40:] = np.nan
    with pytest.raises(tokosen.InputError) as told:
        tokosen.dem((coords, offsets, elevations), 20)
    assert any("no valid coordinates" in note or "left out" in note for note in told.value.__notes__)


def test_a_missing_crs_is_no_error_but_degrees_are():
    coords, offsets, elevations = hill()
    assert tokosen.dem((coords, offsets, elevations), 20).crs is None
    with pytest.raises(tokosen.InputError, match="degrees"):
        tokosen.dem((coords / 1000 + [139, 35], offsets, elevations), 20)
    named = tokosen.densify((coords / 1000 + [139, 35], offsets, elevations, "EPSG:6668"), 5)
    assert named.crs.to_epsg() == 6668


def test_an_unknown_crs_or_unit_is_told():
    for wrong in ({"crs": "EPSG:999999"}, {"crs": "nonsense"}, {"unit": "furlong"}, {"surface": "flat"}, {"drain": "some"}):
        with pytest.raises(tokosen.ParameterError):
            tokosen.dem(frame(), 10, **wrong)
    with pytest.raises(TypeError, match="did you mean 'streams'"):
        tokosen.dem(frame(), 10, stream="rivers.gpkg")
    with pytest.raises(tokosen.FileError, match="missing.gpkg"):
        tokosen.dem("missing.gpkg", 10)


def test_arrays_of_any_layout_are_read():
    coords, offsets, elevations = hill()
    wanted = tokosen.dem((coords, offsets, elevations), 20).values
    layouts = {
        "columns": np.asfortranarray(coords),
        "stride": np.repeat(coords, 2, axis=0)[::2],
        "backwards": coords[::-1].copy()[::-1],
        "big-endian": coords.astype(">f8"),
        "list": coords.tolist(),
    }
    fixed = coords.copy()
    fixed.setflags(write=False)
    layouts["read-only"] = fixed
    for name, layout in layouts.items():
        found = tokosen.dem((layout, offsets.astype(np.int32), elevations), 20).values
        assert np.array_equal(found, wanted, equal_nan=True), name


@pytest.mark.parametrize(
    "spoil",
    [
        lambda c, o, e: (c, o[:-1], e),
        lambda c, o, e: (c, o[::-1], e),
        lambda c, o, e: (c, o + 1, e),
        lambda c, o, e: (c, -o, e),
        lambda c, o, e: (c[:, :1], o, e),
        lambda c, o, e: (c.ravel(), o, e),
        lambda c, o, e: (np.column_stack([c, c]), o, e),
        lambda c, o, e: (c, o.astype(float), e),
        lambda c, o, e: (c, o, e[:, None]),
        lambda c, o, e: (c.astype(str), o, e),
        lambda c, o, e: (c.astype(complex), o, e),
        lambda c, o, e: (c, o.astype(np.uint64) * 2**62, e),
    ],
)
def test_arrays_that_do_not_fit_are_told(spoil):
    with pytest.raises((ValueError, TypeError)) as told:
        tokosen.dem(spoil(*hill()), 20)
    assert str(told.value)


def test_numbers_out_of_range_are_told():
    for wrong in (0, -1, float("nan"), float("inf")):
        with pytest.raises(tokosen.ParameterError):
            tokosen.dem(frame(), wrong)
        with pytest.raises(tokosen.ParameterError):
            tokosen.densify(frame(), wrong)
    with pytest.raises(tokosen.ParameterError, match="cell"):
        tokosen.dem(frame())
    with pytest.raises(tokosen.ParameterError, match="interval or levels"):
        tokosen.densify(frame())
    with pytest.raises(tokosen.Error):
        tokosen.dem(frame(), 1e-6)


def test_height_maps_that_cannot_be_are_told():
    values = np.zeros((4, 5), dtype=np.float32)
    for wrong in ((values, (10, 1, 0, 0, -10, 40)), (values, (10, 0, 0, 0, 10, 40)), (values[0], (10, 0, 0, 0, -10, 40))):
        with pytest.raises(ValueError):
            tokosen.derive(wrong, "slope")
    with pytest.raises(ValueError):
        tokosen.derive((values[:0], (10, 0, 0, 0, -10, 40)), "slope")
    with pytest.raises(TypeError):
        tokosen.derive(values, "slope")
    with pytest.raises(tokosen.ParameterError, match="what"):
        tokosen.derive((values, (10, 0, 0, 0, -10, 40)), "beauty")
    cells = (values, (10, 0, 0, 0, -10, 40))
    for what, given in [
        ("stream_lines", {}),
        ("stream_lines", {"threshold": -1}),
        ("flood", {}),
        ("flood", {"flood_level": "+3"}),
        ("flood", {"flood_level": "+0", "threshold": 5}),
        ("flood", {"flood_level": float("nan")}),
        ("flow_accumulation", {"accumulation_unit": "acres"}),
        ("catchments", {"outlet": (1e9, 1e9)}),
        ("catchments", {"outlet": (5, 5), "outlet_snap": -1}),
    ]:
        with pytest.raises(tokosen.Error):
            tokosen.derive(cells, what, **given)
    with pytest.raises(TypeError, match="outlet takes"):
        tokosen.derive(cells, "catchments", outlet=(1, 2, 3))


def test_files_that_cannot_be_written_are_told(tmp_path):
    dem = tokosen.dem(frame(), 20)
    with pytest.raises(tokosen.ParameterError, match="png|xyz"):
        dem.to_file(tmp_path / "dem.jpg")
    with pytest.raises((tokosen.FileError, tokosen.InputError)):
        dem.to_file(tmp_path / "missing" / "dem.tif")
    lines = tokosen.densify(frame(), 5, output="layer")
    with pytest.raises(tokosen.Error):
        lines.to_file(tmp_path / "lines.xlsx")
    (tmp_path / "mine.geojson").write_text("{}")
    with pytest.raises(tokosen.Error, match="exists|another program"):
        lines.to_file(tmp_path / "mine.geojson")
    lines.to_file(tmp_path / "mine.geojson", overwrite=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.geojson"]


def test_strict_refuses_faults():
    twice = pandas.concat([frame(), frame().assign(elev=[15.0, 25.0])])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(tokosen.InputError):
            tokosen.dem(twice, 20, strict=True)


def test_threads_of_python_share_the_work():
    wanted = tokosen.dem(frame(), 10).values
    found = []
    threads = [threading.Thread(target=lambda: found.append(tokosen.dem(frame(), 10).values)) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 8 and all(np.array_equal(values, wanted, equal_nan=True) for values in found)


def test_extend_needs_polygons():
    with pytest.raises(ValueError, match="extend=False is for polygons"):
        tokosen.dem(frame(), cell=10, extend=False)
