#!/usr/bin/env python3
"""Runs topo_to_raster of GeoLibre, a free tool in the manner of ANUDEM, on contours and streams.

    topo_to_raster.py CONTOURS.gpkg STREAMS.gpkg TRUTH.tif OUT.tif

OUT gets the grid of TRUTH: the tool chooses the position of its cells itself, so its heights are read between them, bilinear.
The Python package is geolibre-wasm. It downloads the tool as a WebAssembly module, or takes that of the variable GEOLIBRE_WASM.
Prints the seconds that the tool took.
"""
import argparse
import pathlib
import sys
import tempfile
import time

import numpy as np
import pyogrio
import rasterio
import shapely
from rasterio.warp import Resampling, reproject


def write(path, source, with_levels, crs):
    """Lines as GeoJSON, with the attribute elev."""
    parts = shapely.get_parts(shapely.from_wkb(pyogrio.raw.read(source)[2]))
    levels = shapely.get_z(shapely.get_point(parts, 0)) if with_levels else np.zeros(len(parts))
    pyogrio.raw.write(path, geometry=shapely.to_wkb(shapely.force_2d(parts)), field_data=[levels], fields=["elev"],
                      geometry_type="LineString", crs=crs.to_wkt(), driver="GeoJSON", COORDINATE_PRECISION="4", RFC7946="NO")


def run_tool(folder, *arguments):
    """Runs the tool; it sees the folder as /data."""
    # Here, so that the description is printed without these packages, which nothing else needs.
    import geolibre_wasm
    import wasmtime

    engine = wasmtime.Engine()
    module = wasmtime.Module.from_file(engine, geolibre_wasm.runtime_path())
    store, linker, system = wasmtime.Store(engine), wasmtime.Linker(engine), wasmtime.WasiConfig()
    told = folder / "told.txt"
    system.argv = ["geolibre", *arguments]
    system.preopen_dir(str(folder), "/data")
    system.stdout_file = system.stderr_file = str(told)
    store.set_wasi(system)
    linker.define_wasi()
    try:
        linker.instantiate(store, module).exports(store)["_start"](store)
    except wasmtime.ExitTrap as end:
        if end.code:
            sys.exit(f"topo_to_raster: {told.read_text(errors='replace').strip()}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("contours", "streams", "truth", "out"):
        parser.add_argument(name, type=pathlib.Path)
    args = parser.parse_args()
    contours, streams, truth, out = args.contours, args.streams, args.truth, args.out
    with rasterio.open(truth) as source:
        profile, crs, cell = source.profile, source.crs, source.transform.a
    heights = np.full((profile["height"], profile["width"]), np.nan, "float32")
    with tempfile.TemporaryDirectory() as made:
        folder = pathlib.Path(made)
        write(folder / "contours.geojson", contours, True, crs)
        write(folder / "streams.geojson", streams, False, crs)
        start = time.monotonic()
        run_tool(folder, "topo_to_raster", "--contours=/data/contours.geojson", "--streams=/data/streams.geojson",
                 "--elevation_field=elev", f"--cell_size={cell}", "--output=/data/dem.tif")
        taken = time.monotonic() - start
        with rasterio.open(folder / "dem.tif") as source:
            reproject(rasterio.band(source, 1), heights, src_crs=crs, dst_crs=crs, dst_transform=profile["transform"],
                      dst_nodata=np.nan, resampling=Resampling.bilinear)
    profile.update(dtype="float32", nodata=np.nan, count=1, driver="GTiff")
    with rasterio.open(out, "w", **profile) as file:
        file.write(heights, 1)
    print(f"{taken:.1f}")


if __name__ == "__main__":
    main()
