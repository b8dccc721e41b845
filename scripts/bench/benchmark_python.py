#!/usr/bin/env python3
"""Time and memory of the Python package beside the command: the same work on the same contours, by turns.

    benchmark_python.py CONTOURS.gpkg --cell SIZE --interval STEP [--program P] [--runs N]

It runs in a Python in which the package is installed (a release wheel), with geopandas. `--program` is a release build of the
program. The rows of the table: a height map and new contours, from the file and, for the package, from a GeoDataFrame and from
arrays that are in memory already. Time is that of the whole process without the reading of frames. Memory is the largest resident
set; for frames and arrays, what it is larger than with these alone. It needs Linux. Ratios are to the command in the same turn; the median of the runs is printed.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

FORMS = ("file", "frame", "arrays")
JOBS = ("dem", "densify")


def child(form, job, path, cell, interval, output):
    """One run of the package, in a process of its own. Prints its time, and the memory that it took besides the contours."""
    contours = path
    if form != "file":
        import geopandas

        contours = geopandas.read_file(path)
    if form == "arrays":
        import shapely

        lines = contours.explode(index_parts=False)
        _, coords, offsets = shapely.to_ragged_array(shapely.force_2d(lines.geometry.array))
        contours = (coords, offsets[0], lines["elev"].to_numpy(dtype=float), contours.crs)
        del lines
    before = memory("VmRSS") if form != "file" else 0.0
    pathlib.Path("/proc/self/clear_refs").write_text("5")  # the largest set begins anew
    start = time.monotonic()
    import tokosen

    if job == "dem":
        tokosen.dem(contours, cell).to_file(output)
    else:
        tokosen.densify(contours, interval, output="layer").to_file(output)
    taken = time.monotonic() - start
    print(json.dumps([taken, memory("VmHWM") - before]))


def memory(name):
    """A figure about the memory of this process [MB]."""
    lines = pathlib.Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith(name)) / 1024


def measured(command, whole):
    """Time and memory [s, MB] of a process; `whole` if it does not print them itself."""
    start = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    text = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        sys.exit(f"failed: {' '.join(map(str, command))}")
    return [time.monotonic() - start, usage.ru_maxrss / 1024] if whole else json.loads(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("contours", type=pathlib.Path)
    parser.add_argument("--cell", type=float, required=True)
    parser.add_argument("--interval", type=float, required=True)
    parser.add_argument("--program", default="target/release/tokosen")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--child", nargs=3, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    path = arguments.contours.resolve()
    if arguments.child:
        form, job, output = arguments.child
        return child(form, job, path, arguments.cell, arguments.interval, output)
    print(f"{'':10} {'from':8} {'command':>18} {'package':>18} {'time':>7} {'memory':>7}")
    with tempfile.TemporaryDirectory() as folder:
        for job in JOBS:
            output = pathlib.Path(folder) / ("a.tif" if job == "dem" else "a.gpkg")
            size = ["--cell", str(arguments.cell)] if job == "dem" else ["-i", str(arguments.interval)]
            command = [arguments.program, job, str(path), *size, "-o", str(output), "-q"]
            for form in FORMS:
                package = [sys.executable, __file__, str(path), "--cell", str(arguments.cell)]
                package += ["--interval", str(arguments.interval), "--child", form, job, str(output)]
                runs = [(measured(command, True), measured(package, False)) for _ in range(arguments.runs)]
                ratios = [statistics.median(own[k] / other[k] for other, own in runs) for k in (0, 1)]
                shown = [[statistics.median(run[side][k] for run in runs) for k in (0, 1)] for side in (0, 1)]
                cells = [f"{seconds:.2f} s {megabytes:6.0f} MB" for seconds, megabytes in shown]
                print(f"{job:10} {form:8} {cells[0]:>18} {cells[1]:>18} {ratios[0]:7.2f} {ratios[1]:7.2f}", flush=True)


if __name__ == "__main__":
    main()
