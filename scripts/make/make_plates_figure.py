#!/usr/bin/env python3
"""Draws the figure of src/guide/models.md: a part of the sample in plates for a laser cutter.

    cargo build --release
    .venv/bin/python scripts/make/make_plates_figure.py target/release/tokosen      # writes samples/figures/plates.png
"""
import argparse
import pathlib
import subprocess
import tempfile
from xml.etree import ElementTree

from PIL import Image, ImageDraw

SAMPLES = pathlib.Path(__file__).resolve().parents[2] / "samples"
WIDTH = 900  # pixels
FINER = 3  # drawn so many times larger, for smooth lines
WOOD = (238, 221, 188)
SVG = "{http://www.w3.org/2000/svg}"


def drawn(root):
    width, height = (float(root.get(side).removesuffix("mm")) for side in ("width", "height"))
    scale = WIDTH * FINER / width
    image = Image.new("RGB", (WIDTH * FINER, round(height * scale)), "white")
    draw = ImageDraw.Draw(image)
    for kinds in (("cut",), ("engrave", "numbers", "cut")):
        for group in root.iterfind(f"{SVG}g/{SVG}g"):
            if group.get("id").split("-")[1] not in kinds:
                continue
            for path in group:
                numbers = [float(number) * scale for number in path.get("d").strip("MZ").split()]
                line = list(zip(numbers[::2], numbers[1::2]))
                line += line[:1] if path.get("d").endswith("Z") else []
                if len(kinds) == 1:
                    # Holes turn the other way.
                    is_hole = sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(line, line[1:])) > 0
                    draw.polygon(line, fill="white" if is_hole else WOOD)
                else:
                    draw.line(line, fill=group.get("stroke"), width=4, joint="curve")
    return image.resize((WIDTH, image.height // FINER), Image.Resampling.LANCZOS)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    program = parser.parse_args().program.resolve()
    with tempfile.TemporaryDirectory() as folder:
        made = pathlib.Path(folder) / "plates.svg"
        command = [program, "mesh", SAMPLES / "caryville_20m.gpkg", "-q", "--extent", "744000,4018000,750000,4022500"]
        subprocess.run([*command, "--thickness", "3mm", "-i", "100", "--size", "120mm", "-o", made], check=True)
        image = drawn(ElementTree.parse(made).getroot())
    image.quantize(32, dither=Image.Dither.NONE).save(SAMPLES / "figures" / "plates.png", optimize=True)


if __name__ == "__main__":
    main()
