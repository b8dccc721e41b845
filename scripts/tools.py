"""Shared by the benchmark scripts: how tokosen and other tools make a height map, and the time and memory of a run.

Every tool gets the same contours and makes a height map on the same grid. The work before and after its interpolation (a
table of vertices, a shapefile of points, GRASS's import, rasterised lines, export) is a separate step, which a measurement
can exclude.
"""
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from typing import NamedTuple

import numpy as np
import pyogrio
import rasterio
import shapely

import terrain

ROOT = pathlib.Path(__file__).resolve().parent.parent
SAMPLE = ROOT / "samples" / "caryville_20m.gpkg"
SAMPLE_TRUTH = ROOT / "samples" / "caryville_20m_truth.tif"
SAMPLE_INTERVAL = 20.0
BINARY = ROOT / "target" / "release" / "tokosen"
QUICK_BINARY = ROOT / "target" / "debug" / "tokosen"  # built in less time, and slower
ONE_THREAD = "tokosen, one thread"

# A program's peak starts at the size of the process that launched it, so a bare interpreter does that, not this one.
# The program leads a group of processes, so that all of them end when its time is over or the user stops it.
LAUNCHER = """
import json, os, signal, sys, time
told, limit, command = sys.argv[1], float(sys.argv[2]), sys.argv[3:]
start = time.monotonic()
pid = os.posix_spawnp(command[0], command, os.environ, setpgroup=0)
late = []
def stop(number, frame):
    late.append(number == signal.SIGALRM)
    os.killpg(pid, signal.SIGKILL)
for number in (signal.SIGALRM, signal.SIGINT, signal.SIGTERM):
    signal.signal(number, stop)
signal.setitimer(signal.ITIMER_REAL, limit)
_, status, usage = os.wait4(pid, 0)
taken = time.monotonic() - start
with open(told, "w") as f:
    json.dump([any(late), os.waitstatus_to_exitcode(status), taken, usage.ru_utime + usage.ru_stime, usage.ru_maxrss], f)
"""
RSS_UNIT = 1 if sys.platform == "darwin" else 1024  # bytes in a unit of ru_maxrss


class Tool(NamedTuple):
    name: str
    program: str  # what has to be installed
    before: list  # commands that make its input from ours
    session: list  # what the command is run within; not measured
    command: list  # the interpolation
    after: list  # commands that make a file of the result which rasterio reads
    output: str


class Inputs(NamedTuple):
    """The same contours in the formats of all tools, and the grid."""

    lines: str  # GeoPackage of 3-D lines with the attribute elev
    points: str  # shapefile of their vertices, attribute elev
    table: str  # their vertices as triples of 64-bit floats
    grid: str  # GeoTIFF on the grid that is wanted


def read_contours(path, layer=None, elev=None):
    """3-D lines of a vector file and its coordinate reference system."""
    if not os.path.exists(path):
        sys.exit(f"{path}: no such file")
    lines, levels = terrain.read_lines(path, layer, elev)
    if not len(lines):
        sys.exit(f"{path}: no lines")
    if not np.isfinite(levels).all():
        sys.exit(f"{path}: {int((~np.isfinite(levels)).sum())} lines have no elevation; is it another attribute (--elev)?")
    return shapely.force_3d(shapely.force_2d(lines), levels), pyogrio.read_info(path, layer=layer)["crs"]


def write_inputs(folder, lines, crs, transform, shape):
    """Writes what the tools read into `folder`."""
    inputs = Inputs(*(str(folder / name) for name in ("contours.gpkg", "points.shp", "points.bin", "grid.tif")))
    if crs and rasterio.crs.CRS.from_user_input(crs).is_geographic:
        sys.exit("the contours are in degrees, in which other tools do not interpolate: project them first")
    if not np.isclose(transform.a, -transform.e) or transform.b or transform.d:
        sys.exit("the grid is turned or its cells are not square, which SAGA cannot do")
    if not shapely.box(*rasterio.transform.array_bounds(*shape, transform)).intersects(shapely.box(*shapely.total_bounds(lines))):
        sys.exit("the grid and the contours do not overlap; are they in one coordinate reference system?")
    xyz = shapely.get_coordinates(lines, include_z=True)
    write = dict(crs=crs, fields=["elev"])
    pyogrio.raw.write(
        inputs.lines, layer="contours", driver="GPKG", geometry_type="LineString Z", geometry=shapely.to_wkb(
            lines, output_dimension=3), field_data=[shapely.get_z(shapely.get_point(lines, 0))], **write)
    pyogrio.raw.write(
        inputs.points, driver="ESRI Shapefile", geometry_type="Point", geometry=shapely.to_wkb(shapely.points(xyz[:, :2])),
        field_data=[xyz[:, 2].copy()], **write)
    xyz.astype("<f8").tofile(inputs.table)
    with rasterio.open(inputs.grid, "w", driver="GTiff", dtype="float32", count=1, height=shape[0], width=shape[1],
                       crs=crs, transform=transform, compress="deflate") as file:
        file.write(np.zeros(shape, "float32"), 1)
    return inputs


def tools(folder, inputs, binary):
    """Every tool that can be compared. Each leaves its height map in `folder`."""
    with rasterio.open(inputs.grid) as grid:
        west, south, east, north = (repr(float(v)) for v in grid.bounds)
        columns, rows, cell = str(grid.width), str(grid.height), repr(float(grid.res[0]))
        (x0, y1), (x1, y0) = grid.xy(0, 0), grid.xy(grid.height - 1, grid.width - 1)
    lines, points, table = (shlex.quote(path) for path in (inputs.lines, inputs.points, inputs.table))

    def tokosen(name, *options):
        output = file_of(folder, name)
        return Tool(name, binary, [], [], [binary, "dem", "-q", inputs.lines, "--like", inputs.grid, *options, "-o", output],
                    [], output)

    def grass(name, command, *before):
        output = file_of(folder, name)
        place = output.removesuffix(".tif")
        session = ["grass", f"{place}/PERMANENT", "--exec"]
        start = shell(f"v.in.ogr -o --quiet input={lines} output=lines",
                      f"g.region n={north} s={south} e={east} w={west} rows={rows} cols={columns}", *before)
        return Tool(name, "grass", [["grass", "-c", inputs.grid, place, "--exec", *start]], session, command, [
            [*session, "r.out.gdal", "--quiet", "-cf", "input=dem", f"output={output}", "format=GTiff", "type=Float32",
             "nodata=-9999"]], output)

    gmt, saga, gdal = "GMT surface", "SAGA multilevel B-spline", "gdal_grid linear"
    # Nodes at the cell centres: with cells (-r), and in a GeoTIFF, GMT 6.4 shifts the surface by half a cell or a whole one.
    region = f"-R{float(x0)!r}/{float(x1)!r}/{float(y0)!r}/{float(y1)!r} -I{cell}"
    gmt_file = file_of(folder, gmt, "nc")
    rst = ["v.surf.rst", "--quiet", "input=lines", "elevation=dem", f"nprocs={os.cpu_count() or 1}"]
    return [
        tokosen("tokosen"),
        tokosen(ONE_THREAD, "--threads", "1"),
        tokosen("tokosen skeleton", "--surface", "skeleton"),
        tokosen("tokosen linear", "--surface", "linear"),
        Tool(gmt, "gmt", [], [], shell(
            f"gmt blockmean {table} -bi3d -bo3d {region}"
            # No tension is its default; written out because most maps are made with some.
            f" | gmt surface -bi3d {region} -T0 -G{shlex.quote(gmt_file)}"), [], gmt_file),
        Tool(saga, "saga_cmd", [], [], [
            "saga_cmd", "-f=q", "grid_spline", "4", "-SHAPES", inputs.points, "-FIELD", "elev", "-TARGET_DEFINITION", "0",
            # FITS 1: the bounds are those of the cells, not of their centres.
            "-TARGET_USER_SIZE", cell, "-TARGET_USER_FITS", "1", "-TARGET_USER_XMIN", west, "-TARGET_USER_XMAX", east,
            "-TARGET_USER_YMIN", south, "-TARGET_USER_YMAX", north, "-TARGET_OUT_GRID", file_of(folder, saga)],
             [], file_of(folder, saga)),
        grass("GRASS r.surf.contour", ["r.surf.contour", "--quiet", "input=contours", "output=dem"],
              "v.to.rast --quiet input=lines type=line use=z output=contours"),
        grass("GRASS v.surf.rst", rst),
        # Fewer points than by default for each piece of the map: much faster, and less accurate.
        grass("GRASS v.surf.rst npmin=120", [*rst, "npmin=120"]),
        Tool(gdal, "gdal_grid", [], [], [
            "gdal_grid", "-q", "-a", "linear:radius=0:nodata=-9999", "-ot", "Float32", "-co", "COMPRESS=DEFLATE",
            # North before south, so that the first row is the northern one.
            "-txe", west, east, "-tye", north, south, "-outsize", columns, rows, inputs.lines, file_of(folder, gdal)],
             [], file_of(folder, gdal)),
    ]


def file_of(folder, name, extension="tif"):
    return str(folder / re.sub("[^a-z0-9]+", "_", name.lower())) + "." + extension


def shell(*commands):
    """One command that runs several, stopping at the first that fails."""
    return ["bash", "-euo", "pipefail", "-c", "\n".join(commands)]


def find(binary):
    """The full path of tokosen; exits with a hint if it is missing."""
    return shutil.which(os.path.abspath(binary)) or shutil.which(binary) or sys.exit(
        f"{binary}: no such program; build it with `cargo build --release`, or name it with --tokosen")


def chosen(every, only):
    """Those of the tools whose name has one of the words in it, and the names of those that are not installed."""
    wanted = [tool for tool in every if not only or any(word in tool.name for word in only)]
    if not wanted:
        sys.exit(f"no tool has such a name; there are: {'; '.join(tool.name for tool in every)}")
    present = [tool for tool in wanted if shutil.which(tool.program)]
    return present, [tool.name for tool in wanted if tool not in present]


def versions(present):
    """Names and versions as the programs state them, each program once."""
    out = []
    for program in dict.fromkeys(tool.program for tool in present):
        said = subprocess.run([program, "--version"], capture_output=True, text=True, errors="replace", stdin=subprocess.DEVNULL)
        number = re.search(r"\d+(\.\d+)+", said.stdout + said.stderr)
        name = {"gdal_grid": "GDAL", "saga_cmd": "SAGA", "gmt": "GMT", "grass": "GRASS"}.get(program, "tokosen")
        out.append(f"{name} {number[0] if number else '?'}")
    return ", ".join(out)


def prepare(tool, folder, limit):
    """Wall seconds of the steps before the interpolation, or what went wrong."""
    return steps(tool.before, folder, limit)


def interpolate(tool, folder, limit):
    """Wall and CPU seconds and the peak bytes of the largest process of the interpolation, or what went wrong."""
    pathlib.Path(tool.output).unlink(missing_ok=True)
    # GRASS keeps its maps inside: running it again has to be allowed to replace them.
    return run(tool.command, folder, limit, tool.session, {"GRASS_OVERWRITE": "1"})


def finish(tool, folder, limit):
    """Wall seconds of the steps after the interpolation, which leave the output file, or what went wrong."""
    told = steps(tool.after, folder, limit)
    return told if "seconds" not in told or os.path.exists(tool.output) else {"failed": "it wrote no height map"}


def steps(commands, folder, limit):
    seconds = 0.0
    for command in commands:
        told = run(command, folder, limit)
        if "seconds" not in told:
            return told
        seconds += told["seconds"]
    return {"seconds": seconds}


def run(command, folder, limit, session=(), extra=None):
    with tempfile.NamedTemporaryFile("r", suffix=".json") as told, tempfile.TemporaryFile() as said:
        subprocess.run([*session, sys.executable, "-I", "-S", "-c", LAUNCHER, told.name, str(limit), *command], cwd=folder,
                       stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said, env={**os.environ, **(extra or {})})
        text = told.read()
        said.seek(0)
        last = (said.read().decode(errors="replace").strip().splitlines() or ["it said nothing"])[-1]
    if not text:
        return {"failed": last}
    late, status, seconds, cpu, peak = json.loads(text)
    if late:
        return {"over": limit}
    if status:
        return {"failed": f"exit status {status}: {last}"}
    return {"seconds": seconds, "cpu_seconds": cpu, "peak_bytes": peak * RSS_UNIT}


def say(what):
    """Shows the current step, on a terminal only."""
    if sys.stderr.isatty():
        print(f"\r\033[K{what}", end="", file=sys.stderr, flush=True)


def table(head, rows):
    """A Markdown table whose columns line up, the first one to the left."""
    width = [max(len(row[i]) for row in [head, *rows]) for i in range(len(head))]
    line = lambda row: "| " + " | ".join(c.ljust(w) if i == 0 else c.rjust(w) for i, (c, w) in enumerate(zip(row, width))) + " |"
    rule = "|" + "|".join("-" * (w + 2) if i == 0 else "-" * (w + 1) + ":" for i, w in enumerate(width)) + "|"
    return "\n".join([line(head), rule, *map(line, rows)])
