#!/usr/bin/env python3
"""Draws the picture of the guide's page about contours for a map: on the left all lines of the sample every 5 m, on the right those of
a map of 1:25 000.

    cargo build --release
    .venv/bin/python scripts/make/make_map_figure.py target/release/tokosen      # writes samples/figures/map_25000.png
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

from PIL import Image, ImageDraw

SAMPLES = pathlib.Path(__file__).resolve().parents[2] / "samples"
LOW, HIGH = (749800, 4020600), (752800, 4023600)  # a valley floor with hills
SCALE = 25_000
PIXELS = 4  # for a millimetre on the map
FINER = 4  # lines are drawn larger, and then made smaller
GAP = 12  # pixels between both halves
BROWN = (84, 48, 22)
# Width and dashes of each kind of line, millimetres.
LOOKS = {
    "index": (0.3, None),
    "intermediate": (0.15, None),
    "supplementary": (0.15, (2.0, 0.7)),
    "supplementary_quarter": (0.15, (0.7, 0.7)),
}
HALVES = (
    ["-i", "5", "--index", "20"],
    ["-i", "20", "--supplementary", "10,5", "--scale", str(SCALE)],
)


def dashed(points, dashes):
    """The pieces of a line on paper that are drawn."""
    if not dashes:
        return [points]
    pieces, left, is_on = [[points[0]]], dashes[0], True
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        length = ((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5
        at = 0.0
        while length - at > left:
            at += left
            place = (x0 + (x1 - x0) * at / length, y0 + (y1 - y0) * at / length)
            if is_on:
                pieces[-1].append(place)
            else:
                pieces.append([place])
            is_on = not is_on
            left = dashes[0] if is_on else dashes[1]
        left -= length - at
        if is_on:
            pieces[-1].append((x1, y1))
    return pieces


def half(program, options, folder):
    """The lines of a run, drawn at the scale."""
    path = folder / "lines.geojson"
    extent = ",".join(map(str, LOW + HIGH))
    subprocess.run(
        [program, "densify", SAMPLES / "caryville_20m.gpkg", *options, "--extent", extent, "--overwrite", "--quiet", "-o", path],
        check=True,
    )
    unit = PIXELS * FINER * 1000 / SCALE  # pixels for a metre
    size = [round((b - a) * unit) for a, b in zip(LOW, HIGH)]
    picture = Image.new("RGB", size, "white")
    draw = ImageDraw.Draw(picture)
    for feature in json.loads(path.read_text())["features"]:
        found = feature["properties"]
        width, dashes = LOOKS[found.get("kind") or ("index" if found["is_index"] else "intermediate")]
        on_paper = [((x - LOW[0]) * unit, (HIGH[1] - y) * unit) for x, y, *_ in feature["geometry"]["coordinates"]]
        for piece in dashed(on_paper, dashes and [length * PIXELS * FINER for length in dashes]):
            draw.line(piece, BROWN, round(width * PIXELS * FINER), "curve")
    draw.rectangle((0, 0, size[0] - 1, size[1] - 1), outline=BROWN, width=2)
    return picture.resize([side // FINER for side in size], Image.Resampling.LANCZOS)


def main():
    args = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    args.add_argument("program", help="the tokosen binary")
    program = pathlib.Path(args.parse_args().program).resolve()
    with tempfile.TemporaryDirectory() as folder:
        halves = [half(program, options, pathlib.Path(folder)) for options in HALVES]
    width, height = halves[0].size
    picture = Image.new("RGB", (2 * width + GAP, height), "white")
    for k, part in enumerate(halves):
        picture.paste(part, (k * (width + GAP), 0))
    path = SAMPLES / "figures" / "map_25000.png"
    picture.quantize(16, dither=Image.Dither.NONE).save(path, optimize=True)
    print(f"{path.name}: {picture.width} x {picture.height}, {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
