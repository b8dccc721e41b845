#!/usr/bin/env python3
"""Draws the picture of the README: on the left a hillshade of the plain triangulation of the sample's contours, on the right one
of tokosen's surface.

    cargo build --release
    .venv/bin/python scripts/make/make_before_after.py target/release/tokosen      # writes samples/figures/before_after.png

Both are made from the same contours, on the same cells, under the same light.
"""
import argparse
import pathlib
import subprocess
import tempfile

from PIL import Image

SAMPLES = pathlib.Path(__file__).resolve().parents[2] / "samples"
EXTENT = "749007,4016952,753201,4021146"  # hills and a valley; multiples of the cell size
CELL = 9  # metres, one pixel
GAP = 12  # pixels between both halves
SURFACES = ("linear", "spline")


def hillshade(program, surface, folder):
    """The shaded surface as a picture in grey."""
    path = folder / f"{surface}.png"
    contours = SAMPLES / "caryville_20m.gpkg"
    options = ["--surface", surface, "--extent", EXTENT, "--cell", str(CELL), "--hillshade", path, "--quiet"]
    subprocess.run([program, "derive", contours, *options], check=True)
    return Image.open(path).convert("L")


def main():
    args = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    args.add_argument("program", help="the tokosen binary")
    program = pathlib.Path(args.parse_args().program).resolve()
    with tempfile.TemporaryDirectory() as folder:
        halves = [hillshade(program, surface, pathlib.Path(folder)) for surface in SURFACES]
    width, height = halves[0].size
    picture = Image.new("L", (2 * width + GAP, height), 255)
    for k, half in enumerate(halves):
        picture.paste(half, (k * (width + GAP), 0))
    path = SAMPLES / "figures" / "before_after.png"
    picture.save(path, optimize=True)
    print(f"{path.name}: {picture.width} x {picture.height}, {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
