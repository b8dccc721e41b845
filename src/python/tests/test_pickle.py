"""Everything that the package returns goes to other processes."""

import multiprocessing
import pickle
import warnings

import numpy as np
import pytest

import tokosen
from conftest import SAMPLES


def again(thing):
    return pickle.loads(pickle.dumps(thing))


def same(a, b):
    return np.array_equal(np.asarray(a), np.asarray(b), equal_nan=True)


def test_rasters_keep_values_errors_and_place():
    dem = tokosen.dem(tokosen.example(), cell=10, uncertainty=True)
    loaded = again(dem)
    assert same(loaded.values, dem.values) and same(loaded.error, dem.error) and loaded.values.dtype == np.float32
    assert (loaded.transform, str(loaded.crs), loaded.quantity) == (dem.transform, str(dem.crs), dem.quantity)
    slope = again(tokosen.derive(dem, "slope"))
    assert slope.quantity == "slope" and slope.error is None
    assert loaded.volume(0) == dem.volume(0)


@pytest.mark.parametrize("kind", ["lines", "areas", "points"])
def test_layers_keep_geometries_and_attributes(kind, tmp_path):
    terrain = tokosen.Terrain(SAMPLES / "fig3a_spur.geojson")
    layer = {
        "lines": lambda: terrain.contours(1),
        "areas": lambda: tokosen.regions(SAMPLES / "fig3a_spur.geojson"),
        "points": lambda: tokosen.check(
            {
                "type": "FeatureCollection",
                "features": [
                    {"type": "Feature", "properties": {"elev": z}, "geometry": {"type": "LineString", "coordinates": line}}
                    for z, line in [(10, [[0, 0], [500, 0], [500, 0]]), (20, [[0, 100], [500, 100]]), (30, [[0, 200], [500, 200]])]
                ],
            }
        ).findings,
    }[kind]()
    loaded = again(layer)
    assert len(loaded) == len(layer) > 0 and repr(loaded) == repr(layer)
    assert same(loaded.coords, layer.coords) and all(map(same, loaded.offsets, layer.offsets))
    for column in layer.columns:
        values, others = list(loaded[column]), list(layer[column])
        assert [str(value) for value in values] == [str(value) for value in others]
    layer.to_file(tmp_path / "a.geojson")
    loaded.to_file(tmp_path / "b.geojson")
    assert (tmp_path / "a.geojson").read_bytes() == (tmp_path / "b.geojson").read_bytes()


def test_models_checks_terrains_and_comparisons(tmp_path):
    terrain = tokosen.Terrain(tokosen.example(), uncertainty=True)
    model = terrain.mesh(0)
    loaded = again(model)
    assert same(loaded.vertices, model.vertices) and same(loaded.triangles, model.triangles) and loaded.is_solid
    model.to_file(tmp_path / "a.glb")
    loaded.to_file(tmp_path / "b.glb")
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()

    assert same(again(terrain).dem(cell=10).values, terrain.dem(cell=10).values)
    assert again(terrain).dem(cell=10).error is not None
    found = tokosen.check(tokosen.example())
    assert again(found).figures == found.figures and same(again(found).repaired().coords, found.repaired().coords)
    compared = tokosen.compare(terrain, terrain.dem(cell=10), sigma=0.5)
    assert again(compared).figures == compared.figures


def test_a_terrain_warns_once():
    lines = tokosen.example()
    with pytest.warns(tokosen.FindingWarning):
        terrain = tokosen.Terrain(lines, points=np.array([[0.0, 0.0, 4000.0]]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        again(terrain)


def test_work_in_other_processes():
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        (height,) = pool.map(tokosen.Dem.volume, [tokosen.dem(tokosen.example(), cell=10)])
    assert height.cut > 0


def test_errors_as_a_dataset():
    xarray = pytest.importorskip("xarray")
    dem = tokosen.dem(tokosen.example(), cell=10, uncertainty=True)
    both = dem.to_xarray(error=True)
    assert isinstance(both, xarray.Dataset) and same(both["error"], dem.error) and same(both["height"], dem.values)
    assert both["error"].attrs["units"] == "m" and "spatial_ref" in both.coords
    with pytest.raises(tokosen.ParameterError, match="uncertainty"):
        tokosen.dem(tokosen.example(), cell=10).to_xarray(error=True)
