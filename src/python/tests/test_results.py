"""The forms of results: Arrow, numpy, geopandas, xarray."""

import geopandas
import numpy as np
import pyarrow
import pytest

import tokosen
from conftest import SAMPLES

DRAWN = SAMPLES / "fig1f_nested.geojson"


def test_coordinates_are_shared_not_copied():
    lines = tokosen.densify(DRAWN, 5)
    table = pyarrow.table(lines)
    vertices = table["geometry"].chunk(0).values.values
    address = vertices.buffers()[1].address
    assert lines.coords.__array_interface__["data"][0] == address == lines.coords.__array_interface__["data"][0]
    assert not lines.coords.flags.writeable
    assert lines.offsets[0][-1] == len(lines.coords) and len(lines.offsets[0]) == len(lines) + 1


def test_arrow_tables_are_read_by_geopandas():
    hill = tokosen.example()
    hill["features"][2]["properties"]["elev"] = 70
    findings = tokosen.check(hill).findings
    assert len(findings)
    for layer in (tokosen.densify(DRAWN, 5), tokosen.regions(DRAWN), findings):
        frame = geopandas.GeoDataFrame.from_arrow(pyarrow.table(layer))
        own = layer.to_geopandas()
        assert frame.geometry.to_wkb().equals(own.geometry.to_wkb())
        assert [column for column in frame if column != "geometry"] == layer.columns
        assert frame.crs == own.crs and (frame.crs is not None or layer.crs is None)


def test_the_form_follows_the_contours_unless_it_is_named():
    frame = geopandas.read_file(DRAWN)
    assert isinstance(tokosen.densify(frame, 5), geopandas.GeoDataFrame)
    assert isinstance(tokosen.densify(frame, 5, output="layer"), tokosen.Layer)
    assert isinstance(tokosen.densify(DRAWN, 5), tokosen.Layer)
    with pytest.raises(ValueError, match="output"):
        tokosen.densify(frame, 5, output="table")
    example = tokosen.densify(tokosen.example(), 5, output="geopandas")
    back = tokosen.densify(example, 2.5)
    assert len(back) > len(example) and back.crs == example.crs


def test_heights_are_the_array_itself(part):
    dem = tokosen.dem(part, 60, uncertainty=True)
    assert dem.values is dem.values and dem.values.flags.c_contiguous and dem.values.dtype == np.float32
    assert np.shares_memory(np.asarray(dem), dem.values) and np.shares_memory(dem.to_xarray().values, dem.values)
    assert dem.error.shape == dem.values.shape and np.nanmin(dem.error) >= 0
    rows, columns = dem.shape
    west, south, east, north = dem.bounds
    assert np.isclose(east - west, 60 * columns) and np.isclose(north - south, 60 * rows)


def test_xarray_goes_both_ways(part):
    dem = tokosen.dem(part, 60)
    array = dem.to_xarray()
    again = tokosen.derive(array, "slope")
    assert again.transform == dem.transform and again.crs == dem.crs
    turned = array.sortby("y")
    assert np.array_equal(tokosen.derive(turned, "slope").values, again.values, equal_nan=True)


def test_models_and_pages_of_a_height_map(part, tmp_path):
    dem = tokosen.dem(part, 60)
    whole, few = dem.mesh(), dem.mesh(tolerance=2)
    heights = dem.values[np.isfinite(dem.values)]
    assert set(whole.vertices[:, 2].astype(np.float32)) <= set(heights) and len(few.triangles) < len(whole.triangles) / 2
    solid = dem.mesh(0, tolerance=2)
    assert solid.is_solid and solid.vertices[:, 2].min() == 0
    few.to_file(tmp_path / "surface.xml")
    page = dem.to_html(20, title="part")
    assert page.startswith("<!DOCTYPE html>") and '"title":"part"' in page and '"contours":"' in page
    terrain = tokosen.Terrain(part)
    kept = terrain.mesh(tolerance=5, keep="contours")
    assert len(kept.triangles) > len(terrain.mesh(tolerance=5).triangles)
    for given in ({"keep": "contours"}, {"keep": "rivers", "tolerance": 5}):
        with pytest.raises(tokosen.ParameterError, match="keep"):
            terrain.mesh(**given)
    with pytest.raises(tokosen.ParameterError, match="models are made of heights"):
        tokosen.derive(dem, "slope").mesh()
    with pytest.raises(tokosen.Error, match="no cell with a height"):
        tokosen.Dem.from_array(np.full((4, 5), np.nan), (10, 0, 0, 0, -10, 40)).mesh()


def test_files_of_rasterio_and_pyogrio_agree(part, tmp_path):
    rasterio = pytest.importorskip("rasterio")
    dem = tokosen.dem(part, 60, uncertainty=True)
    dem.to_file(tmp_path / "d.tif", cog=True)
    with rasterio.open(tmp_path / "d.tif") as file:
        assert tuple(file.transform)[:6] == dem.transform
        assert np.array_equal(file.read(1, masked=True).filled(np.nan), dem.values, equal_nan=True)
        assert file.crs.to_epsg() == dem.crs.to_epsg()
        assert file.count == 2
    lines = tokosen.densify(DRAWN, 5)
    lines.to_file(tmp_path / "l.gpkg")
    assert len(geopandas.read_file(tmp_path / "l.gpkg")) == len(lines)


def test_geoparquet_is_read_and_written(tmp_path):
    lines = tokosen.densify(DRAWN, 5)
    lines.to_file(tmp_path / "l.parquet")
    levels = sorted(tokosen.densify(tmp_path / "l.parquet", 5)["elev"])
    assert levels == sorted(lines["elev"])
    found = geopandas.read_parquet(tmp_path / "l.parquet")
    assert sorted(found["elev"]) == levels
    found.to_parquet(tmp_path / "theirs.parquet", write_covering_bbox=True)
    low_x, low_y, high_x, high_y = found.total_bounds
    part = f"{tmp_path / 'theirs.parquet'}|bbox={low_x},{low_y},{(low_x + high_x) / 2},{high_y}"
    assert set(tokosen.densify(part, 5)["elev"]) <= set(levels)


def test_units_and_systems_of_results():
    metres = tokosen.densify(tokosen.example(), 5)
    feet = tokosen.densify(tokosen.example(), 20, to_unit="ft")
    assert np.allclose(np.asarray(feet["elev"])[np.asarray(feet["source"]) == "interpolated"] % 20, 0)
    degrees = tokosen.densify(tokosen.example(), 5, to_crs=6668)
    assert degrees.crs.to_epsg() == 6668 and np.all(np.abs(degrees.coords[:, 1]) < 90) and len(degrees) == len(metres)


def test_a_base_in_memory_fills_around_the_contours():
    base = (np.full((100, 100), 5, dtype=np.float32), (20, 0, -1000, 0, -20, 1000), "EPSG:6677")
    dem = tokosen.dem(tokosen.example(), 20, base=base)
    assert dem.shape == (100, 100) and np.isfinite(dem.values).all()


def test_samples_and_profiles_are_heights_of_the_surface():
    terrain = tokosen.Terrain(DRAWN, uncertainty=True)
    dem = terrain.dem(cell=5)
    rows, cols = np.nonzero(np.isfinite(dem.values))
    t = dem.transform
    x, y = t.c + (cols + 0.5) * t.a, t.f + (rows + 0.5) * t.e
    heights, errors = terrain.sample(np.column_stack([x, y]))
    # Cell by cell the same surface; height maps of streams and water may differ, and there are none here.
    assert np.nanmax(np.abs(heights - dem.values[rows, cols])) < 0.5
    assert np.isfinite(errors).all()
    along = terrain.profile([(x[0], y[0]), (x[-1], y[-1])], step=3)
    assert along["distance"][-1] == pytest.approx(np.hypot(x[-1] - x[0], y[-1] - y[0]))
    assert len(along["z"]) == len(along["x"]) and np.isfinite(along["z"]).any()
    with pytest.raises(tokosen.ParameterError, match="pairs of x and y"):
        terrain.sample([1.0, 2.0])


def test_volumes_are_sums_over_cells():
    dem = tokosen.dem(DRAWN, cell=5)
    heights = dem.values[np.isfinite(dem.values)].astype(float)
    level = float(np.median(heights))
    found = dem.volume(level, sigma=0.5)
    assert found.cut == pytest.approx(25 * np.clip(heights - level, 0, None).sum(), rel=1e-6)
    assert found.fill == pytest.approx(25 * np.clip(level - heights, 0, None).sum(), rel=1e-6)
    assert found.error_most == pytest.approx(25 * heights.size * 0.5, rel=1e-6)
    assert [volume.level for volume in dem.volume([level, level + 1])] == [level, level + 1]
    assert dem.volume(other=dem).cut == 0.0
