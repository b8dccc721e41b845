#!/usr/bin/env python3
"""Draws the figure of src/guide/bands.md: the sample in bands of 100 m, with its contours.

    cargo build --release
    .venv/bin/python scripts/make/make_bands_figure.py target/release/tokosen      # writes samples/figures/bands.png
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

from PIL import Image, ImageDraw

SAMPLES = pathlib.Path(__file__).resolve().parents[2] / "samples"
WIDTH = 900  # pixels
FINER = 3  # drawn so many times larger, for smooth lines
TINTS = [(148, 190, 130), (196, 214, 148), (236, 229, 166), (229, 196, 128), (206, 155, 98), (176, 118, 80), (233, 226, 221)]
LINE, INDEX = (140, 100, 60), (90, 55, 25)


def drawn(bands, lines):
    places = [p for area in bands for p in area["geometry"]["coordinates"][0]]
    west, south = (min(p[k] for p in places) for k in (0, 1))
    east, north = (max(p[k] for p in places) for k in (0, 1))
    scale = WIDTH * FINER / (east - west)
    pixels = lambda ring: [((p[0] - west) * scale, (north - p[1]) * scale) for p in ring]
    image = Image.new("RGB", (WIDTH * FINER, round((north - south) * scale)), "white")
    draw = ImageDraw.Draw(image)
    heights = sorted({area["properties"]["elev_from"] for area in bands})
    # Areas in holes are smaller than the areas around them.
    for area in sorted(bands, key=lambda area: -ring_size(area["geometry"]["coordinates"][0])):
        tint = TINTS[heights.index(area["properties"]["elev_from"]) * len(TINTS) // len(heights)]
        draw.polygon(pixels(area["geometry"]["coordinates"][0]), fill=tint)
    for line in lines:
        is_index = line["properties"]["elev"] % 100 == 0
        colour, width = (INDEX, 5) if is_index else (LINE, 2)
        draw.line(pixels(line["geometry"]["coordinates"]), fill=colour, width=width)
    return image.resize((WIDTH, image.height // FINER), Image.Resampling.LANCZOS)


def ring_size(ring):
    return abs(sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(ring, ring[1:])))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    program = parser.parse_args().program.resolve()
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "densify", SAMPLES / "caryville_20m.gpkg", "-q", "--surface", "linear", "--extent", "744000,4018000,750000,4022500"]
        subprocess.run([*command, "-i", "100", "-o", "index.geojson", "--bands", "bands.geojson"], cwd=folder, check=True)
        subprocess.run([*command, "-i", "20", "-o", "lines.geojson"], cwd=folder, check=True)
        bands, lines = (json.loads((pathlib.Path(folder) / f"{name}.geojson").read_text())["features"] for name in ("bands", "lines"))
    image = drawn(bands, lines).quantize(64, method=Image.Quantize.MAXCOVERAGE, kmeans=3, dither=Image.Dither.NONE)
    image.save(SAMPLES / "figures" / "bands.png", optimize=True)


if __name__ == "__main__":
    main()
