"""Results are those of the program, bit for bit: from files, from frames, from arrays, from Arrow, from GeoJSON."""

import json
import warnings

import geopandas
import numpy as np
import pyarrow
import pyogrio
import pytest
import shapely

import tokosen
from conftest import SAMPLES

def drawn():
    found = sorted(SAMPLES.glob("*.geojson"))
    assert len(found) >= 10
    return found


def read(path):
    frame = geopandas.read_file(path)
    return frame[frame.geometry.geom_type.isin(["LineString", "MultiLineString"])].reset_index(drop=True)


def elevations_of(frame):
    name = next(name for name in ("elev", "ELEV", "elevation", "z") if name in frame)
    return frame[name].to_numpy(dtype=float)


def arrays(frame):
    lines = frame.geometry.array
    _, coords, offsets = shapely.to_ragged_array(shapely.force_2d(lines))
    return coords, offsets[0], elevations_of(frame), frame.crs


def forms(path):
    """The same contours in all forms."""
    frame = read(path)
    yield "file", path
    yield "frame", frame
    if (frame.geometry.geom_type == "LineString").all():
        yield "arrays", arrays(frame)
    yield "arrow", pyarrow.table(frame.to_arrow(geometry_encoding="geoarrow"))
    yield "arrow with WKB", pyarrow.table(frame.to_arrow(geometry_encoding="WKB"))


def numbers(layer):
    """All coordinates and elevations of lines."""
    if isinstance(layer, tokosen.Layer):
        return layer.coords, np.asarray(layer["elev"])
    _, coords, _ = shapely.to_ragged_array(layer.geometry.array)
    return coords, layer["elev"].to_numpy()


@pytest.mark.parametrize("sample", [None, *drawn()], ids=lambda path: path.stem if path else "part")
def test_contours_and_heights_are_those_of_the_program(sample, part, program, tmp_path):
    path, interval, cell = (sample, 2.5, 10) if sample else (part, 10, 30)
    program("densify", path, "-i", interval, "-o", "lines.gpkg", "-q")
    program("dem", path, "--cell", cell, "-o", "dem.tif", "-q")
    wanted = numbers(pyogrio.read_dataframe(tmp_path / "lines.gpkg"))
    heights = tokosen.Dem.read(tmp_path / "dem.tif")
    count = 0
    for form, contours in forms(path):
        found = numbers(tokosen.densify(contours, interval, output="layer"))
        assert all(a.tobytes() == b.tobytes() for a, b in zip(found, wanted)), form
        dem = tokosen.dem(contours, cell)
        assert dem.values.tobytes() == heights.values.tobytes() and dem.transform == heights.transform, form
        count += 1
    assert count >= 4


def test_files_have_the_bytes_of_the_program(part, program, tmp_path):
    program("dem", part, "--cell", 60, "--uncertainty", "-o", "a.tif", "-q")
    tokosen.dem(part, 60, uncertainty=True).to_file(tmp_path / "b.tif")
    assert (tmp_path / "a.tif").read_bytes() == (tmp_path / "b.tif").read_bytes()
    program("densify", part, "-i", 10, "-o", "a.geojson", "-q")
    tokosen.densify(part, 10).to_file(tmp_path / "b.geojson")
    assert (tmp_path / "a.geojson").read_text() == (tmp_path / "b.geojson").read_text()


def test_other_layers_are_those_of_the_program(part, program, tmp_path):
    for verb, make in (("regions", tokosen.regions), ("skeleton", tokosen.skeleton)):
        program(verb, part, "-o", f"{verb}.gpkg", "-q")
        wanted = geopandas.read_file(tmp_path / f"{verb}.gpkg")
        found = make(part, output="geopandas")
        assert list(found.columns) == list(wanted.columns) and len(found) == len(wanted) > 10
        assert found.geometry.to_wkb().equals(wanted.geometry.to_wkb())
        for column in wanted.columns.drop("geometry"):
            assert found[column].astype(object).where(found[column].notna(), None).equals(
                wanted[column].astype(object).where(wanted[column].notna(), None)
            ), (verb, column)


def test_a_terrain_that_is_asked_twice_gives_what_functions_give():
    path = SAMPLES / "fig1f_nested.geojson"
    terrain = tokosen.Terrain(path)
    ten, five = terrain.contours([5, 2.5])
    assert numbers(ten)[0].tobytes() == numbers(tokosen.densify(path, 5))[0].tobytes()
    assert len(five) > len(ten)
    assert terrain.skeleton().coords.tobytes() == tokosen.skeleton(path).coords.tobytes()
    assert terrain.regions().coords.tobytes() == tokosen.regions(path).coords.tobytes()


def test_contours_of_a_height_map_and_what_is_derived_are_those_of_the_program(program, tmp_path):
    truth = SAMPLES / "caryville_20m_truth.tif"
    program("contour", truth, "-i", 20, "-o", "c.gpkg", "-q")
    wanted = numbers(pyogrio.read_dataframe(tmp_path / "c.gpkg"))
    dem = tokosen.Dem.read(truth)
    for given in (truth, dem, dem.to_xarray(), (dem.values, dem.transform, dem.crs)):
        assert all(a.tobytes() == b.tobytes() for a, b in zip(numbers(tokosen.contour(given, 20)), wanted))
    flags = "slope aspect hillshade flow-direction flow-accumulation".split()
    outputs = [part for flag in flags for part in (f"--{flag}", f"{flag}.tif")]
    program("derive", truth, *outputs, "--steep", "steep.gpkg", "-q")
    for flag in flags:
        made = tokosen.derive(dem, flag.replace("-", "_"))
        made.to_file(tmp_path / f"own_{flag}.tif")
        assert (tmp_path / f"own_{flag}.tif").read_bytes() == (tmp_path / f"{flag}.tif").read_bytes(), flag
    steep = tokosen.derive(dem, "steep", output="geopandas")
    assert steep.geometry.to_wkb().equals(geopandas.read_file(tmp_path / "steep.gpkg").geometry.to_wkb())


def test_catchments_streams_and_floods_are_those_of_the_program(program, tmp_path):
    truth = SAMPLES / "caryville_20m_truth.tif"
    places = [(752685.0, 4024000.0), (745000.0, 4019000.0)]
    flags = [part for x, y in places for part in ("--outlet", f"{x},{y}")]
    streams = ["--threshold", "500000"]
    program("derive", truth, *flags, "--catchments", "c.gpkg", "--stream-lines", "s.gpkg", *streams, "-q")
    program("derive", truth, "--flood", "f.tif", "--flood-level", "+3", *streams, "-q")
    program("derive", truth, "--flood", "f.gpkg", "--flood-level", "320", "-q")
    program("derive", truth, "--flow-accumulation", "a.tif", "--accumulation-unit", "m2", "-q")
    dem = tokosen.Dem.read(truth)
    points = geopandas.GeoSeries.from_xy(*zip(*places), crs=dem.crs).to_crs(4326)
    for outlet in (places, points):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", tokosen.FindingWarning)
            found = tokosen.derive(dem, "catchments", outlet=outlet, output="geopandas")
        wanted = pyogrio.read_dataframe(tmp_path / "c.gpkg")
        assert found.geometry.to_wkb().equals(wanted.geometry.to_wkb())
        assert found["above_m2"].tolist() == wanted["above_m2"].tolist()
    lines = tokosen.derive(dem, "stream_lines", threshold=500_000, output="geopandas")
    assert lines.geometry.to_wkb().equals(pyogrio.read_dataframe(tmp_path / "s.gpkg").geometry.to_wkb())
    tokosen.derive(dem, "flood", flood_level="+3", threshold=500_000).to_file(tmp_path / "own.tif")
    assert (tmp_path / "own.tif").read_bytes() == (tmp_path / "f.tif").read_bytes()
    areas = tokosen.derive(dem, "flood_areas", flood_level=320, output="geopandas")
    assert areas.geometry.to_wkb().equals(pyogrio.read_dataframe(tmp_path / "f.gpkg").geometry.to_wkb())
    tokosen.derive(dem, "flow_accumulation", accumulation_unit="m2").to_file(tmp_path / "own.tif")
    assert (tmp_path / "own.tif").read_bytes() == (tmp_path / "a.tif").read_bytes()


def test_contours_for_a_map_are_those_of_the_program(program, tmp_path):
    truth = SAMPLES / "caryville_20m_truth.tif"
    cases = {
        "pieces": (["-i", 20, "--supplementary", "10,5", "--supplementary-spacing", 300], (20,), {"supplementary": [10, 5], "supplementary_spacing": 300}),
        "thin": (["-i", 20, "--scale", 50_000, "--thin"], (20,), {"scale": 50_000, "thin": True}),
        "open": (["--scale", 50_000], (), {"scale": 50_000}),
    }
    for name, (flags, given, asked) in cases.items():
        program("contour", truth, *flags, "-o", f"{name}.gpkg", "-q")
        wanted = pyogrio.read_dataframe(tmp_path / f"{name}.gpkg")
        found = tokosen.contour(truth, *given, **asked, output="geopandas")
        assert numbers(found)[0].tobytes() == numbers(wanted)[0].tobytes(), name
        assert list(found["kind"]) == list(wanted["kind"]), name
    path = SAMPLES / "fig1f_nested.geojson"
    program("densify", path, "-i", 5, "--supplementary", 2.5, "--supplementary-spacing", 5, "-o", "d.gpkg", "-q")
    wanted = pyogrio.read_dataframe(tmp_path / "d.gpkg")
    found = tokosen.densify(path, 5, supplementary=2.5, supplementary_spacing=5)
    assert numbers(found)[0].tobytes() == numbers(wanted)[0].tobytes()
    assert set(found["kind"]) == set(wanted["kind"])
    with pytest.raises(tokosen.ParameterError, match="2.5 or 2.5,1.25"):
        tokosen.densify(path, 5, supplementary=2)


def test_contours_of_a_part_of_a_height_map_are_those_of_the_program(part, program, tmp_path):
    truth = SAMPLES / "caryville_20m_truth.tif"
    west, south, east, north = pyogrio.read_info(part)["total_bounds"]
    middle = ((west + east) / 2, (south + north) / 2)
    circle = geopandas.GeoDataFrame(geometry=[shapely.Point(*middle).buffer(800)], crs=32616)
    circle.to_crs(4326).to_file(tmp_path / "circle.gpkg")
    box = (west + 500, south + 500, *middle)
    degrees = geopandas.read_file(tmp_path / "circle.gpkg")
    whole = tokosen.contour(truth, 20)
    for given, flags in (
        ({"extent": box}, ["--extent", ",".join(map(str, box))]),
        ({"clip": degrees}, ["--clip", "circle.gpkg"]),
        ({"frame": degrees}, ["--frame", "circle.gpkg"]),
    ):
        program("contour", truth, "-i", 20, "-o", "part.gpkg", "-q", "--overwrite", *flags)
        wanted = numbers(pyogrio.read_dataframe(tmp_path / "part.gpkg"))
        found = tokosen.contour(truth, 20, **given)
        assert all(a.tobytes() == b.tobytes() for a, b in zip(numbers(found), wanted)), flags
        assert 0 < len(found.coords) < len(whole.coords), flags
    for wrong, words in (
        ({"extent": box, "clip": degrees}, "either extent or clip"),
        ({"frame": "hull"}, "frame is"),
        ({"extent": (0, 0, 1, 1)}, "outside of the height map"),
    ):
        with pytest.raises(tokosen.Error, match=words):
            tokosen.contour(truth, 20, **wrong)


def test_a_comparison_has_the_figures_of_the_program(part, program):
    truth = SAMPLES / "caryville_20m_truth.tif"
    wanted = json.loads(program("compare", part, truth, "--json", "-q").stdout)
    found = tokosen.compare(part, truth).figures
    assert found["overall"] == wanted["overall"] and found["size"] == wanted["size"]


def test_other_inputs_count_as_in_the_program(program, tmp_path):
    """A lake on the top, a stream down a spur, spot heights, a part of the map: each changes the result, as in the program."""
    (tmp_path / "hill.geojson").write_text(json.dumps(tokosen.example()))
    square = shapely.box(-200, -200, 250, 250)
    given = {
        "water": shapely.Point(0, 0).buffer(30),
        "streams": shapely.LineString([(100, 20), (200, 40), (290, 60)]),
        "points": shapely.Point(-50, 10, 43.0),
        "clip": square,
        "breaklines": shapely.LineString([(-240, -20, 15.0), (-200, 0, 22.0)]),
        "exclude": shapely.Point(0, -140).buffer(15),
    }
    frames = {name: geopandas.GeoDataFrame(geometry=[shape], crs=6677) for name, shape in given.items()}
    plain = tokosen.dem(tmp_path / "hill.geojson", 10)
    for name, frame in frames.items():
        frame.to_file(tmp_path / f"{name}.gpkg")
        program("dem", "hill.geojson", "--cell", 10, "-o", f"{name}.tif", "-q", f"--{name}", f"{name}.gpkg")
        wanted = tokosen.Dem.read(tmp_path / f"{name}.tif").values
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", tokosen.FindingWarning)
            found = tokosen.dem(tmp_path / "hill.geojson", 10, **{name: frame}).values
        assert found.tobytes() == wanted.tobytes(), name
        assert found.tobytes() != plain.values.tobytes(), name
