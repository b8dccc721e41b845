#!/usr/bin/env python3
"""How the verbs end under limits of their address space (ulimit -v), as a table.

    limits.py                                   # 4000 x 4000 cells, limits of 100 MB to 2 GB in steps of 100 MB
    limits.py --side 1000 --limits 100 200 300
    limits.py --only derive

A run must end well (its time in seconds is told), or refuse with a message (no). Everything else is a fault: a signal (its
number is told, below 0), another status, no message, a refusal that leaves files (left), or no end. The script ends with 1 if
there is a fault.
"""
import argparse
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np
import rasterio

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))  # the modules that scripts share
import tools

VERBS = {
    "derive --slope": "derive a.tif --slope out.tif",
    "derive, three": "derive a.tif --slope out.tif --aspect out2.tif --hillshade out3.png",
    "derive --steep": "derive a.tif --steep out.gpkg",
    "derive --flow-accumulation": "derive a.tif --flow-accumulation out.tif",
    "compare": "compare a.tif b.tif",
    "compare --report": "compare a.tif b.tif --report out.html -o out.tif",
    "contour": "contour a.tif -i 20 -o out.gpkg",
    "dem": "dem map.gpkg --cell {cell} -o out.tif",
    "dem, linear": "dem map.gpkg --cell {cell} --surface linear -o out.tif",
    "densify": "densify map.gpkg -i 5 -o out.gpkg",
    "mesh": "mesh map.gpkg -o out.glb",
}


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("--tokosen", default=str(tools.BINARY), help="the program (target/release/tokosen)")
    a.add_argument("--side", type=int, default=4000, help="cells along each side of the rasters (4000)")
    a.add_argument("--cell", type=float, default=5, help="cell size of height maps from contours (5)")
    a.add_argument("--limits", type=int, nargs="+", default=range(100, 2001, 100), metavar="MB", help="limits, in 1,000,000 bytes")
    a.add_argument("--only", action="append", metavar="NAME", help="run only verbs with NAME in their name; may be repeated")
    a.add_argument("--seconds", type=float, default=600, help="time for a run (600)")
    args = a.parse_args()
    verbs = {name: line for name, line in VERBS.items() if not args.only or any(part in name for part in args.only)}
    faults = 0
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        make_inputs(folder, args.side)
        print("MB".rjust(26), *(str(limit).rjust(6) for limit in args.limits))
        for name, line in verbs.items():
            print(name.rjust(26), end=" ", flush=True)
            for limit in args.limits:
                told, fault = run(args.tokosen, folder, line.format(cell=args.cell), limit, args.seconds)
                faults += fault
                print((told + "!" * fault).rjust(6), end=" ", flush=True)
            print()
    print(f"{faults} faults" if faults else "no faults")
    sys.exit(1 if faults else 0)


def make_inputs(folder, side):
    """Two height maps of hills with rough ground, and contours."""
    random = np.random.default_rng(1)
    y, x = np.mgrid[0:side, 0:side].astype("f4")
    hills = 500 + 200 * np.sin(x / 300) * np.cos(y / 400) + 60 * np.sin(x / 57 + y / 91)
    for name, roughness in [("a.tif", 0.1), ("b.tif", 0.8)]:
        heights = (hills + roughness * random.standard_normal((side, side))).astype("f4")
        transform = rasterio.transform.from_origin(400000, 4000000, 5, 5)
        kind = {"driver": "GTiff", "count": 1, "dtype": "float32", "crs": "EPSG:6690", "transform": transform}
        with rasterio.open(folder / name, "w", width=side, height=side, **kind) as file:
            file.write(heights, 1)
    (folder / "map.gpkg").write_bytes(tools.SAMPLE.read_bytes())


def run(program, folder, line, limit, seconds):
    """What is told of a run, and whether it is a fault."""
    before = set(folder.iterdir())

    def set_limit():
        resource.setrlimit(resource.RLIMIT_AS, (limit * 1_000_000,) * 2)

    started = time.monotonic()
    try:
        ended = subprocess.run(
            [program, *line.split(), "--overwrite"], cwd=folder, preexec_fn=set_limit, stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, timeout=seconds, text=True, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return "late", True
    taken = time.monotonic() - started
    new = set(folder.iterdir()) - before
    for path in new:
        if path.is_file():
            path.unlink()
    if ended.returncode == 0:
        return f"{taken:.1f}", False
    if ended.returncode == 1 and "error: " in ended.stderr:
        return ("left", True) if new else ("no", False)
    print(ended.stderr, file=sys.stderr)
    return str(ended.returncode), True


if __name__ == "__main__":
    main()
