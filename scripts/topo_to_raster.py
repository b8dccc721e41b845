#!/usr/bin/env python3
"""Runs topo_to_raster of GeoLibre, a free tool in the manner of ANUDEM, on contours and streams.

    topo_to_raster.py CONTOURS.gpkg STREAMS.gpkg TRUTH.tif OUT.tif

OUT gets the grid of TRUTH: the tool chooses the position of its cells itself, so its heights are read between them, bilinear.
The Python package is geolibre-wasm. It downloads its WebAssembly module, or takes that of the variable GEOLIBRE_WASM. Prints
the seconds that the tool took.
"""
import pathlib
import sys
import tempfile
import time

import geolibre_wasm
import numpy as np
import pyogrio
import rasterio
import shapely
from rasterio.warp import Resampling, reproject


def geojson(path, with_levels, crs):
    _, _, wkb, _ = pyogrio.raw.read(path)
    parts = shapely.get_parts(shapely.from_wkb(wkb))
    levels = shapely.get_z(shapely.get_point(parts, 0)) if with_levels else np.zeros(len(parts))
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "lines.geojson"
        pyogrio.raw.write(out, geometry=shapely.to_wkb(shapely.force_2d(parts)), field_data=[levels], fields=["elev"],
                          geometry_type="LineString", crs=crs.to_wkt(), driver="GeoJSON", COORDINATE_PRECISION="4", RFC7946="NO")
        return out.read_bytes()


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    contours, streams, truth, out = map(pathlib.Path, sys.argv[1:])
    with rasterio.open(truth) as source:
        profile, crs, cell = source.profile, source.crs, source.transform.a
    inputs = {"contours.geojson": geojson(contours, True, crs), "streams.geojson": geojson(streams, False, crs)}
    args = ["--contours=/work/contours.geojson", "--streams=/work/streams.geojson", "--elevation_field=elev",
            f"--cell_size={cell}", "--output=/work/dem.tif"]
    start = time.monotonic()
    done = geolibre_wasm.run_tool("topo_to_raster", args=args, input=inputs)
    taken = time.monotonic() - start
    if done.exit_code:
        sys.exit("topo_to_raster: " + " ".join(done.stdout))
    with rasterio.MemoryFile(done.files["dem.tif"]) as file, file.open() as source:
        heights = np.full((profile["height"], profile["width"]), np.nan, "float32")
        reproject(rasterio.band(source, 1), heights, src_crs=crs, dst_crs=crs, dst_transform=profile["transform"],
                  dst_nodata=np.nan, resampling=Resampling.bilinear)
    profile.update(dtype="float32", nodata=np.nan, count=1, driver="GTiff")
    with rasterio.open(out, "w", **profile) as file:
        file.write(heights, 1)
    print(f"{taken:.1f}")


if __name__ == "__main__":
    main()
