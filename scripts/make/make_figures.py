#!/usr/bin/env python3
"""Draws the figures of samples/README.md with the program itself.

    cargo build --release
    .venv/bin/python scripts/make/make_figures.py target/release/tokosen      # writes samples/figures/*.png

Each picture is one that `--preview` draws, made smaller and reduced to a palette.
"""
import argparse
import pathlib
import subprocess
import tempfile

from PIL import Image

SAMPLES = pathlib.Path(__file__).resolve().parents[2] / "samples"
WIDTH = 900  # pixels
COLOURS = (256, 128, 64)  # the first that keeps a file below LARGEST
LARGEST = 150_000  # bytes

# Picture, sample, verb and its options.
FIGURES = [
    ("fig1a", "fig1a_one_to_one", "regions"),
    ("fig1b", "fig1b_one_convolution", "skeleton"),
    ("fig1c", "fig1c_many_convolutions", "skeleton"),
    ("fig1d", "fig1d_two_branches_one_convolution", "skeleton"),
    ("fig1e", "fig1e_three_branches", "skeleton"),
    ("fig1f", "fig1f_nested", "regions"),
    ("fig2", "fig2_triangles", "skeleton --triangles"),
    ("fig3a_reserved", "fig3a_spur", "skeleton --triangles --resolution 2.7"),
    ("fig3a_eliminated", "fig3a_spur", "skeleton --triangles --resolution 2.8"),
    ("fig3b_reserved", "fig3b_three_arms", "skeleton --triangles --resolution 0.7"),
    ("fig3b_eliminated", "fig3b_three_arms", "skeleton --triangles --resolution 0.8"),
    ("fig5ab_lines", "fig5ab_two_branches_ridges_canyon", "skeleton"),
    ("fig5ab_terrain", "fig5ab_two_branches_ridges_canyon", "mesh"),
    ("fig5cd_lines", "fig5cd_three_branches_basin", "skeleton"),
    ("fig5cd_terrain", "fig5cd_three_branches_basin", "mesh"),
    ("fig6", "fig6_ridge", "skeleton --triangles"),
    ("fig7", "caryville_20m", "mesh"),
    ("fig8_bare", "fig6_ridge", "mesh --surface linear"),
    ("fig8", "fig6_ridge", "mesh"),
]


def draw(program, picture, sample, verb, folder):
    source = next(SAMPLES.glob(f"{sample}.g*"))
    name, *options = verb.split()
    model = folder / ("model.ply" if name == "mesh" else "layers.gpkg")
    seen = folder / "look.png"
    subprocess.run([program, name, source, "-o", model, "--preview", seen, "--quiet", *options], check=True)
    image = Image.open(seen).convert("RGB")
    image = image.resize((WIDTH, round(image.height * WIDTH / image.width)), Image.Resampling.LANCZOS)
    path = SAMPLES / "figures" / f"{picture}.png"
    for colours in COLOURS:
        # Colours start from their spread, not their share of the picture: lines are thin, but keep their ink. Then they are
        # moved to the means of what they stand for, which keeps shading smooth.
        reduced = image.quantize(colours, method=Image.Quantize.MAXCOVERAGE, kmeans=3, dither=Image.Dither.NONE)
        reduced.save(path, optimize=True)
        if path.stat().st_size <= LARGEST:
            break
    print(f"{path.name}: {path.stat().st_size} bytes")
    return path.stat().st_size


def main():
    args = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    args.add_argument("program", help="the tokosen binary")
    args = args.parse_args()
    program = pathlib.Path(args.program).resolve()
    (SAMPLES / "figures").mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        total = sum(draw(program, *figure, pathlib.Path(folder)) for figure in FIGURES)
    print(f"{total} bytes in all")


if __name__ == "__main__":
    main()
