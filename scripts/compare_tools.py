#!/usr/bin/env python3
"""Time and memory that tokosen takes for a height map, beside other tools: same contours, same grid, one run each.

    compare_tools.py CONTOURS GRID.tif [--tokosen target/release/tokosen] [--only NAME ...] [--keep DIR] [--json]

CONTOURS is a vector file of contour lines, GRID.tif any GeoTIFF on the grid that is wanted. A row a tool:

    tokosen                 dem --like GRID.tif
    tokosen linear          the same with --surface linear
    gdal_grid linear        Delaunay triangulation of the vertices, GDAL
    GMT surface             blockmean, then minimum curvature with no tension, GMT
    GRASS r.surf.contour    v.to.rast, then flood fill between rasterised contours, GRASS
    GRASS v.surf.rst        regularised spline with tension, defaults, GRASS

What is not installed is said and left out. Each tool gets the lines in a format that it reads itself, 3-D lines or a
table of their vertices, which is made beforehand and not measured; its import, region and export are measured, because
tokosen reads and writes files, too. Wall seconds come from the clock around the program; the peak is the largest resident
memory of one of its processes (10 MB is the least that can be told). The ratios are to the first tool that ran. Take the
figures on a machine that does nothing else.
"""
import argparse
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

import numpy as np
import pyogrio
import rasterio
import shapely

import terrain

# A program's peak starts at the size of the process that launched it, so a bare interpreter does that, not this one.
LAUNCHER = """
import json, os, sys, time
start = time.monotonic()
pid = os.posix_spawnp(sys.argv[2], sys.argv[2:], os.environ)
_, status, usage = os.wait4(pid, 0)
taken = time.monotonic() - start
with open(sys.argv[1], "w") as f:
    json.dump([os.waitstatus_to_exitcode(status), taken, usage.ru_maxrss], f)
"""
RSS_UNIT = 1 if sys.platform == "darwin" else 1024  # bytes in a unit of ru_maxrss


def shell(*commands):
    """One command that runs several, stopping at the first that fails."""
    return ["bash", "-euo", "pipefail", "-c", "\n".join(commands)]


def write_lines(path, lines, crs):
    pyogrio.raw.write(
        path, layer="contours", driver="GPKG", crs=crs, geometry_type="LineString Z", fields=["elev"],
        geometry=shapely.to_wkb(lines, output_dimension=3), field_data=[shapely.get_z(shapely.get_point(lines, 0))])


def tools(work, lines, table, grid, binary):
    """Name, programs that it needs, command and output of each tool. `lines` is a GeoPackage of 3-D lines."""
    with rasterio.open(grid) as g:
        west, south, east, north = (repr(float(v)) for v in g.bounds)
        columns, rows = str(g.width), str(g.height)
        dx, dy = (repr(float(v)) for v in g.res)
    out = lambda name: str(work / name)
    quote = shlex.quote
    grass_start = [f"v.in.ogr -o --quiet input={quote(lines)} output=lines",
                   f"g.region n={north} s={south} e={east} w={west} rows={rows} cols={columns}"]
    grass = lambda name, file, *steps: (name, ["grass"], [
        "grass", "-c", grid, str(work / f"grass_{file}"), "--exec",
        *shell(*grass_start, *steps,
               f"r.out.gdal --quiet -f input=dem output={quote(out(file))} format=GTiff type=Float32 nodata=-9999")],
        out(file))
    return [
        ("tokosen", [binary], [binary, "dem", "-q", lines, "--like", grid, "-o", out("tokosen.tif")], out("tokosen.tif")),
        ("tokosen linear", [binary], [binary, "dem", "-q", lines, "--like", grid, "--surface", "linear",
                                      "-o", out("tokosen_linear.tif")], out("tokosen_linear.tif")),
        ("gdal_grid linear", ["gdal_grid"], [
            "gdal_grid", "-q", "-a", "linear:radius=0:nodata=-9999", "-ot", "Float32", "-co", "COMPRESS=DEFLATE",
            # North before south, so that the first row is the northern one.
            "-txe", west, east, "-tye", north, south, "-outsize", columns, rows, lines, out("gdal_linear.tif")],
         out("gdal_linear.tif")),
        ("GMT surface", ["gmt"], shell(
            f"cd {quote(str(work))}",
            f"gmt blockmean {quote(table)} -R{west}/{east}/{south}/{north} -I{dx}/{dy} -r"
            f" | gmt surface -R{west}/{east}/{south}/{north} -I{dx}/{dy} -r -T0 -Ggmt_surface.nc"), out("gmt_surface.nc")),
        grass("GRASS r.surf.contour", "grass_contour.tif", "v.to.rast --quiet input=lines type=line use=z output=contours",
              "r.surf.contour --quiet input=contours output=dem"),
        grass("GRASS v.surf.rst", "grass_rst.tif", "v.surf.rst --quiet input=lines elevation=dem"),
    ]


def measure(command, output):
    """Wall seconds and peak bytes of a command that writes `output`, or what went wrong."""
    with tempfile.NamedTemporaryFile("r", suffix=".json") as told:
        done = subprocess.run([sys.executable, "-I", "-S", "-c", LAUNCHER, told.name, *command],
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace")
        text = told.read()
    said = (done.stderr.strip().splitlines() or ["it said nothing"])[-1]
    if not text:
        return {"failed": said}
    status, seconds, peak = json.loads(text)
    if status:
        return {"failed": f"exit status {status}: {said}"}
    if not os.path.exists(output):
        return {"failed": f"no output: {said}"}
    return {"seconds": seconds, "peak_bytes": peak * RSS_UNIT}


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("contours")
    a.add_argument("grid")
    a.add_argument("--tokosen", default="target/release/tokosen", help="the program (target/release/tokosen)")
    a.add_argument("--layer", help="layer of CONTOURS (the first)")
    a.add_argument("--elev", help="attribute of CONTOURS that holds the elevation (found by its name)")
    a.add_argument("--only", action="append", metavar="NAME", help="run tools whose name has NAME in it; may be repeated")
    a.add_argument("--keep", metavar="DIR", help="leave the height maps there")
    a.add_argument("--json", action="store_true", help="print the figures as JSON")
    o = a.parse_args()
    if not shutil.which(o.tokosen):
        a.error(f"no program {o.tokosen}: build it, or name it with --tokosen")
    grid = str(pathlib.Path(o.grid).resolve())
    terrain.read_dem(grid)
    lines, levels = terrain.read_lines(o.contours, o.layer, o.elev)
    crs = pyogrio.read_info(o.contours, layer=o.layer)["crs"]
    lines = shapely.force_3d(shapely.force_2d(lines), levels)
    with tempfile.TemporaryDirectory() as temporary:
        work = pathlib.Path(o.keep or temporary).resolve()
        work.mkdir(parents=True, exist_ok=True)
        given, table = pathlib.Path(temporary) / "contours.gpkg", pathlib.Path(temporary) / "contours.xyz"
        write_lines(given, lines, crs)
        if shutil.which("gmt"):
            np.savetxt(table, shapely.get_coordinates(lines, include_z=True), fmt="%.12g")
        figures = {}
        for name, needs, command, output in tools(work, str(given), str(table), grid, o.tokosen):
            if o.only and not any(part in name for part in o.only):
                continue
            missing = [program for program in needs if not shutil.which(program)]
            if missing:
                figures[name] = {"missing": ", ".join(missing)}
                continue
            pathlib.Path(output).unlink(missing_ok=True)
            figures[name] = measure(command, output)
    if not figures:
        a.error("no tool has such a name")
    if o.json:
        print(json.dumps(figures, indent=1))
    else:
        show(figures, int(shapely.get_num_coordinates(lines).sum()))
    # A tool that is not there is no failure; one that broke is.
    sys.exit(any("failed" in f for f in figures.values()))


def show(figures, vertices):
    print(f"{'':24s}{'wall s':>9s}{'ratio':>8s}{'peak MB':>10s}{'ratio':>8s}   {vertices} vertices")
    first = next((f for f in figures.values() if "seconds" in f), None)
    for name, f in figures.items():
        if "missing" in f:
            print(f"{name:24s}  not installed: {f['missing']}")
        elif "failed" in f:
            print(f"{name:24s}  failed: {f['failed']}")
        else:
            print(f"{name:24s}{f['seconds']:9.2f}{f['seconds'] / first['seconds']:8.2f}"
                  f"{f['peak_bytes'] / 1e6:10.1f}{f['peak_bytes'] / first['peak_bytes']:8.2f}")


if __name__ == "__main__":
    main()
