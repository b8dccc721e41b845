"""Map tiles are those of the program, byte for byte."""

import pickle

import pytest

import tokosen
from conftest import SAMPLES

ZOOMS = ["--zooms", "11:40,13:20,14:10"]


@pytest.fixture(autouse=True)
def folders(tmp_path):
    """The program writes into the folder a, the package into b."""
    for name in "ab":
        (tmp_path / name).mkdir()


def test_contours_as_tiles_are_those_of_the_program(part, program, tmp_path):
    program("densify", part, "-i", 10, *ZOOMS, "--index", 4, "--attribution", "A & B", "-o", "a/lines.pmtiles", "-q")
    lines = tokosen.densify(part, 10, index=4, output="layer")
    for layer in (lines, pickle.loads(pickle.dumps(lines))):
        target = tmp_path / "b" / "lines.pmtiles"
        layer.to_file(target, zooms={11: 40, 13: 20, 14: 10}, attribution="A & B")
        assert target.read_bytes() == (tmp_path / "a" / "lines.pmtiles").read_bytes()
    # The intervals of the default, and feet.
    program("densify", part, "-i", 50, "--to-unit", "ft", "-o", "a/feet/{z}/{x}/{y}.pbf", "-q")
    tokosen.densify(part, 50, to_unit="ft", output="layer").to_file(tmp_path / "b" / "feet" / "{z}" / "{x}" / "{y}.pbf")
    files = [sorted((tmp_path / name / "feet").rglob("*.*")) for name in "ab"]
    assert len(files[0]) > 4 and [a.read_bytes() for a in files[0]] == [b.read_bytes() for b in files[1]]


def test_contours_of_a_height_map_and_at_levels(program, tmp_path):
    truth = SAMPLES / "caryville_20m_truth.tif"
    extent = (745000, 4017500, 748500, 4020500)
    given = ["--extent", ",".join(map(str, extent))]
    for name, asked, levels in (("i", ["-i", 50], {"interval": 50}), ("l", ["--levels", "640,652.5"], {"levels": [640, 652.5]})):
        program("contour", truth, *asked, *given, "-o", f"a/{name}.pmtiles", "-q")
        tokosen.contour(truth, **levels, extent=extent).to_file(tmp_path / "b" / f"{name}.pmtiles")
        assert (tmp_path / "a" / f"{name}.pmtiles").read_bytes() == (tmp_path / "b" / f"{name}.pmtiles").read_bytes(), name


@pytest.mark.parametrize("encoding, image, side", [(None, "png", 512), ("mapbox", "webp", 256)])
def test_heights_as_tiles_are_those_of_the_program(part, program, tmp_path, encoding, image, side):
    flags = ["--tile-image", image, "--tile-size", side, *(["--png-encoding", encoding] if encoding else [])]
    program("dem", part, "--max-zoom", 12, *flags, "-o", "a/terrain.pmtiles", "-q")
    dem = tokosen.dem(part, max_zoom=12, tile_size=side)
    dem.to_file(tmp_path / "b" / "terrain.pmtiles", png_encoding=encoding, tile_image=image, tile_size=side)
    assert (tmp_path / "a" / "terrain.pmtiles").read_bytes() == (tmp_path / "b" / "terrain.pmtiles").read_bytes()


def test_a_page_shows_the_tiles_of_its_folder(tmp_path):
    with pytest.raises(tokosen.ParameterError, match="no map tiles"):
        tokosen.viewer(tmp_path / "b" / "index.html")
    assert not list((tmp_path / "b").iterdir())
    tokosen.densify(tokosen.example(), 5).to_file(tmp_path / "b" / "lines.pmtiles")
    assert tokosen.viewer(tmp_path / "b" / "index.html", title="A <b>") == ["lines.pmtiles"]
    page = (tmp_path / "b" / "index.html").read_text()
    assert "lines.pmtiles" in page and "A <b>" not in page


def test_what_is_wrong_is_said(tmp_path):
    lines, dem = tokosen.densify(tokosen.example(), 5), tokosen.dem(tokosen.example(), cell=10)
    wrong = [
        (lambda: lines.to_file(tmp_path / "a.gpkg", zooms={12: 10}), "apply to map tiles"),
        (lambda: dem.to_file(tmp_path / "a.tif", attribution="x"), "apply to map tiles"),
        (lambda: lines.to_file(tmp_path / "a.pmtiles", zooms={12: 7}), "multiple"),
        (lambda: lines.to_file(tmp_path / "t" / "{z}" / "{x}" / "{y}.png"), ".pbf or .mvt"),
        (lambda: tokosen.regions(tokosen.example()).to_file(tmp_path / "a.pmtiles"), "contours alone"),
        (lambda: dem.to_file(tmp_path / "a.pmtiles"), "max_zoom"),
        (lambda: tokosen.derive(dem, "slope").to_file(tmp_path / "a.pmtiles"), "heights in metres only"),
        (lambda: tokosen.dem(tokosen.example(), max_zoom=12, tile_size=300), "256 or 512"),
        (lambda: tokosen.dem(tokosen.example(), max_zoom=21), "0 to 20"),
        (lambda: tokosen.dem(tokosen.example(), cell=5, max_zoom=12), "give one of"),
        (lambda: tokosen.dem(tokosen.example(), max_zoom=12, to_crs=6677), "Web Mercator"),
    ]
    for work, message in wrong:
        with pytest.raises(tokosen.Error, match=message.replace(".", r"\.")):
            work()
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]
