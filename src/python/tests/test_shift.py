"""Heights in another height system: grids in the formats of their publishers, against PROJ, GDAL and own arithmetic."""

import math
import struct
import warnings

import numpy as np
import pyproj
import pytest
import rasterio

import tokosen

# The south-west node, the steps and the nodes of the grids: meshes of 45 by 30 seconds, as the parameters of GSI have them.
WEST, SOUTH, DX, DY, COLS, ROWS = 138.5, 35.25, 1 / 80, 1 / 120, 41, 31
LON, LAT = WEST + DX * np.arange(COLS), SOUTH + DY * np.arange(ROWS)
# From south to north, metres, in the digits that the text formats have. Heights of the same size have as many digits.
NODES = np.round(0.4 * np.sin(np.add.outer(LAT * 9, LON * 7)) + 0.3 * np.cos(np.subtract.outer(LAT * 3, LON * 11)), 4)
HEIGHTS = np.random.default_rng(5).uniform(-0.9, 0.9, (100, 100)).astype(np.float32)
CELL_X, CELL_Y = (COLS - 1.02) * DX / 100, (ROWS - 1.02) * DY / 100
TRANSFORM = (CELL_X, 0, WEST + 0.01 * DX, 0, -CELL_Y, SOUTH + (ROWS - 1.01) * DY)


def gtx(path):
    head = struct.pack(">4d2i", SOUTH, WEST, DY, DX, ROWS, COLS)
    path.write_bytes(head + NODES.astype(">f4").tobytes())


def gtg(path, source=6694, target=6695):
    """As PROJ-data has them."""
    transform = rasterio.transform.from_origin(WEST - DX / 2, SOUTH + (ROWS - 0.5) * DY, DX, DY)
    profile = {"driver": "GTiff", "width": COLS, "height": ROWS, "count": 1, "dtype": "float32", "crs": "EPSG:6668"}
    with rasterio.open(path, "w", transform=transform, **profile) as file:
        file.write(NODES[::-1].astype(np.float32), 1)
        file.update_tags(
            TYPE="VERTICAL_OFFSET_VERTICAL_TO_VERTICAL",
            source_crs_epsg_code=str(source),
            target_crs_epsg_code=str(target),
            AREA_OR_POINT="Point",
        )


def dms(angle):
    seconds = round(angle * 3600)
    return f"{seconds // 3600}°{seconds // 60 % 60:02d}'{seconds % 60:02d}\""


def isg(path):
    """ISG 2.0, with bounds of nodes in degrees, minutes and seconds."""
    fields = [
        ("model name", ":", "made for a test"), ("model year", ":", "2025"), ("model type", ":", "hybrid"),
        ("data type", ":", "geoid"), ("data units", ":", "meters"), ("data format", ":", "grid"),
        ("data ordering", ":", "N-to-S, W-to-E"), ("ref ellipsoid", ":", "GRS80"), ("ref frame", ":", "ITRF2014"),
        ("height datum", ":", "---"), ("tide system", ":", "zero-tide"), ("coord type", ":", "geodetic"),
        ("coord units", ":", "dms"), ("map projection", ":", "---"), ("EPSG code", ":", "6668"),
        ("lat min", "=", dms(LAT[0])), ("lat max", "=", dms(LAT[-1])), ("lon min", "=", dms(LON[0])),
        ("lon max", "=", dms(LON[-1])), ("delta lat", "=", dms(DY)), ("delta lon", "=", dms(DX)), ("nrows", "=", ROWS),
        ("ncols", "=", COLS), ("nodata", "=", "-9999.0000"), ("creation date", "=", "01/04/2025"), ("ISG format", "=", "2.0"),
    ]
    lines = [f"{name:<15}{sign} {value:>14}" for name, sign, value in fields]
    rows = [" ".join(f"{value:11.4f}" for value in row) for row in NODES[::-1]]
    text = ["begin_of_head " + "=" * 48, *lines, "end_of_head " + "=" * 50, *rows]
    path.write_text("\n".join(text) + "\n", encoding="utf-8")


def mesh_code(lat, lon):
    """The eight digits of the mesh of 45 by 30 seconds at a south-west corner (JIS X 0410)."""
    rows, cols = round(lat * 120), round((lon - 100) * 80)
    (p, q), (u, v) = divmod(rows, 80), divmod(cols, 80)
    return f"{p:02d}{u:02d}{q // 10}{v // 10}{q % 10}{v % 10}"


def par(path):
    """As GSI's corrections of heights: 16 lines of a head, then codes and values; meshes without a value are left out."""
    head = ["JGD2000-JGD2011", "Ver.1.0.0", *[""] * 13, "MeshCode   dB(sec)   dL(sec)   dH(m)"]
    body = [f"{mesh_code(lat, lon)}   0.00000   0.00000 {value:9.4f}" for lat, row in zip(LAT, NODES) for lon, value in zip(LON, row)]
    path.write_text("\n".join(head + body) + "\n", encoding="ascii")


def bilinear(lon, lat):
    """Own arithmetic between the nodes."""
    x, y = (lon - WEST) / DX, (lat - SOUTH) / DY
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    x, y = x - i, y - j
    nodes = NODES.astype(np.float32).astype(float)
    south = (1 - x) * nodes[j, i] + x * nodes[j, i + 1]
    return (1 - y) * south + y * ((1 - x) * nodes[j + 1, i] + x * nodes[j + 1, i + 1])


def places():
    """The centres of 10,000 cells."""
    a, _, c, _, e, f = TRANSFORM
    return np.meshgrid(c + a * (np.arange(100) + 0.5), f + e * (np.arange(100) + 0.5))


def shifted(path, **given):
    dem = tokosen.Dem.from_array(HEIGHTS, TRANSFORM, "EPSG:6668")
    return dem.shifted(path, **given)


@pytest.mark.parametrize("make", [gtx, gtg])
def test_shifts_are_those_of_proj(tmp_path, make):
    path = tmp_path / f"grid.{'gtx' if make is gtx else 'tif'}"
    make(path)
    lon, lat = places()
    for inverse in (False, True):
        pipeline = f"+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad +step +proj=vgridshift +grids={path} " \
            f"+multiplier={-1 if inverse else 1} +step +proj=unitconvert +xy_in=rad +xy_out=deg"
        _, _, expected = pyproj.Transformer.from_pipeline(pipeline).transform(lon, lat, HEIGHTS.astype(float))
        found = shifted(path, inverse=inverse).values
        assert np.isfinite(expected).all()
        assert np.abs(found - expected).max() < 1e-6


@pytest.mark.parametrize("make", [isg, par])
def test_text_formats_are_read_as_published(tmp_path, make):
    path = tmp_path / f"grid.{make.__name__}"
    make(path)
    expected = bilinear(*places())
    assert np.abs(shifted(path).values - (HEIGHTS + expected)).max() < 1e-6
    assert np.abs(shifted(path, inverse=True).values - (HEIGHTS - expected)).max() < 1e-6


def test_gdal_reads_the_same_isg(tmp_path):
    isg(tmp_path / "grid.isg")
    try:
        file = rasterio.open(tmp_path / "grid.isg")
    except rasterio.errors.RasterioIOError:
        pytest.skip("this GDAL does not read ISG")
    with file:
        assert np.abs(file.read(1) - NODES[::-1]).max() < 1e-6
        assert math.isclose(file.transform.c, WEST - DX / 2, abs_tol=1e-9)
        assert math.isclose(file.transform.f, LAT[-1] + DY / 2, abs_tol=1e-9)


def test_the_system_is_named_if_the_grid_names_it(tmp_path):
    gtg(tmp_path / "grid.tif")
    # The code is written without PROJ's name for it, so PROJ is less sure.
    vertical = lambda dem: [part.to_epsg(min_confidence=20) for part in dem.crs.sub_crs_list[1:]]  # noqa: E731
    up = shifted(tmp_path / "grid.tif")
    assert (vertical(up), up.notes) == ([6695], [])
    assert vertical(up.shifted(tmp_path / "grid.tif", inverse=True)) == [6694]
    gtx(tmp_path / "grid.gtx")
    nameless = up.shifted(tmp_path / "grid.gtx")
    assert vertical(nameless) == []
    assert "does not name the height system" in " ".join(nameless.notes)


def test_heights_alone_are_shifted(tmp_path):
    gtx(tmp_path / "grid.gtx")
    slope = tokosen.derive(tokosen.Dem.from_array(HEIGHTS, TRANSFORM, "EPSG:6668"), "slope")
    with pytest.raises(tokosen.ParameterError, match="heights can be shifted"):
        slope.shifted(tmp_path / "grid.gtx")
    far = tokosen.Dem.from_array(HEIGHTS, (0.01, 0, 10, 0, -0.01, 60), "EPSG:6668")
    with warnings.catch_warnings(), pytest.raises(tokosen.Error, match="does not cover"):
        far.shifted(tmp_path / "grid.gtx")
