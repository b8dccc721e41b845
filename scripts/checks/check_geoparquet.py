#!/usr/bin/env python3
"""Checks GeoParquet files with geopandas and pyarrow, and reads those that geopandas writes.

    check_geoparquet.py CONTOURS [--command target/release/tokosen]

Contours, areas and points are written as GeoPackage and as GeoParquet: geometries and attributes must be the same, bit for bit,
also of the rows that geopandas finds in a box. The CRS must be that of the GeoPackage, and coordinates of many systems must mean
the same places. Files of geopandas, with and without boxes, in three compressions, must give the lines of the GeoPackage.

Needs geopandas and pyarrow. Without them, it says so and ends with status 0. Otherwise, exit status 0: all of that holds; 1: some
does not.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import pyogrio
import pyproj
import shapely

# What is written: a name, the command, and columns that are compared.
RUNS = [("lines", "densify {contours} -i 5 -o {out}"), ("areas", "regions {contours} -o {out}"), ("points", "check {wrong} -o {out}")]
# Systems of many projections, with a place in each.
SYSTEMS = [4326, 6668, 32616, 25832, 6677, 2229, 3857, 28992, 3035, 2154, 27700, 5070, 5514, 2056, 3413, 7423]


def rows(frame):
    """All rows, so that equal ones are equal features."""
    columns = sorted(set(frame.columns) - {"geometry"})
    shapes = shapely.to_wkb(shapely.normalize(frame.geometry.values), output_dimension=3)
    cells = [[None if value is None or value != value else value for value in frame[column]] for column in columns]
    return sorted(map(repr, zip(shapes, *cells)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("contours")
    parser.add_argument("--command", default="target/release/tokosen")
    args = parser.parse_args()
    try:
        import geopandas
        import pyarrow.parquet
    except ImportError as error:
        print(f"skipped: {error.name} is not installed")
        return 0
    failures = 0

    def expect(holds, what):
        nonlocal failures
        print("ok  " if holds else "FAIL", what, flush=True)
        failures += not holds

    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)

        def tokosen(line, **names):
            words = [word.format(**names) for word in line.split()]
            return subprocess.run([args.command, *words, "-q", "--overwrite"], capture_output=True, text=True)

        # Wrong elevations, so that there are findings.
        wrong = pyogrio.read_dataframe(args.contours)
        column = next(name for name in wrong.columns if wrong[name].dtype.kind in "if")
        wrong.loc[::20, column] += 500
        wrong.geometry = shapely.force_2d(wrong.geometry.values)
        pyogrio.write_dataframe(wrong, folder / "wrong.gpkg")
        for name, line in RUNS:
            for extension in ("gpkg", "parquet"):
                tokosen(line, contours=args.contours, wrong=folder / "wrong.gpkg", out=folder / f"{name}.{extension}")
            wanted, found = pyogrio.read_dataframe(folder / f"{name}.gpkg"), geopandas.read_parquet(folder / f"{name}.parquet")
            same = rows(wanted) == rows(found.drop(columns="bbox", errors="ignore"))
            expect(same and wanted.crs.to_epsg() == found.crs.to_epsg() and len(found) > 0, f"{name}: {len(found)} rows, {found.crs.to_string()}")
            about = pyarrow.parquet.ParquetFile(folder / f"{name}.parquet")
            geo = json.loads(about.metadata.metadata[b"geo"])
            expect(geo["version"] == "1.1.0" and about.metadata.row_group(0).column(0).compression == "ZSTD", f"{name}: version and compression")
            if name == "lines":
                lines = rows(wanted[["geometry", "elev"]])
                x0, y0, x1, y1 = wanted.total_bounds
                box = (x0 + 0.4 * (x1 - x0), y0 + 0.4 * (y1 - y0), x0 + 0.5 * (x1 - x0), y0 + 0.5 * (y1 - y0))
                part = geopandas.read_parquet(folder / "lines.parquet", bbox=box)
                own = wanted.cx[box[0]:box[2], box[1]:box[3]]
                expect(set(rows(own)) <= set(rows(part.drop(columns="bbox", errors="ignore"))) and len(part) < len(wanted),
                       f"lines: {len(part)} of {len(wanted)} are found by a box")
        frame = pyogrio.read_dataframe(folder / "lines.gpkg")
        for compression, covering in (("snappy", True), ("zstd", False), (None, True), ("gzip", False), ("brotli", False)):
            frame.to_parquet(folder / "theirs.parquet", compression=compression, write_covering_bbox=covering)
            run = tokosen("densify {contours} -i 5 -o {out}", contours=folder / "theirs.parquet", out=folder / "back.gpkg")
            if run.returncode:
                expect(compression == "brotli" and "which is not read" in run.stderr, f"geopandas, {compression}: {run.stderr.strip()}")
                continue
            back = rows(pyogrio.read_dataframe(folder / "back.gpkg")[["geometry", "elev"]])
            expect(back == lines, f"geopandas, {compression}, {'with' if covering else 'without'} boxes: {len(back)} lines")
        for code in SYSTEMS:
            line = "densify {contours} -i 20 -o {out} --to-crs EPSG:" + str(code)
            run = tokosen(line, contours=args.contours, out=folder / "system.parquet")
            if run.returncode:
                print(f"     EPSG:{code} is not written: {run.stderr.strip()[:150]}")
                continue
            own, true = geopandas.read_parquet(folder / "system.parquet").crs, pyproj.CRS.from_epsg(code)
            area = true.area_of_use
            lon, lat = (np.linspace(a, b, 5)[1:4] for a, b in ((area.west, area.east), (area.south, area.north)))
            places = [pyproj.Transformer.from_crs(crs.geodetic_crs, crs, always_xy=True).transform(lon, lat) for crs in (own, true)]
            off = float(np.abs(np.subtract(*places)).max())
            expect(own.to_epsg() == code and off < 1e-3, f"EPSG:{code}: {off:.1e} units beside pyproj's own")
    print(f"{failures} faults")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
