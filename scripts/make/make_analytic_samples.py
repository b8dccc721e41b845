#!/usr/bin/env python3
"""Makes the drawn samples: the shapes that test a contour reconstruction, a few lines each.

    python3 -m venv .venv && .venv/bin/pip install -r scripts/requirements.txt
    .venv/bin/python scripts/make/make_analytic_samples.py            # writes samples/fig*.geojson
    .venv/bin/python scripts/make/make_analytic_samples.py --plot     # and samples/shapes.png

The shapes are those that the figures of Zhang, Konno and Tokuyama, "3D Terrain Reconstruction Based on Contours"
(CAD/CG 2005) name; the lines are drawn anew. Those of figures 1 and 5 are closed cubic splines through a few points,
sampled every STEP metres, so that a bay is exactly as deep and as narrow as it was meant to be. Those of figures 2, 3 and
6 are polygons of a few corners at whole coordinates, so that every triangle, length and height can be worked out on
paper; tests/library/figures does so. Coordinates are those of
JGD2011 plane rectangular zone X (EPSG:6678, x east, y north), rounded to a centimetre, near Mt. Iwate.
Higher ground lies on the right of every line. Each ring repeats its first point.
"""
import argparse
import json
import pathlib

import numpy as np
import shapely
from scipy.interpolate import splev, splprep

SAMPLES = pathlib.Path(__file__).resolve().parents[2] / "samples"
EPSG = 6678
ORIGIN = np.array([14_000.0, -16_500.0])  # of the drawings, plane coordinates in metres
STEP = 5.0  # distance between vertices, metres


def ring(points, falls_inward=False):
    """A smooth closed line through `points` (metres from ORIGIN); clockwise around higher ground."""
    p = np.asarray(points, float)
    p = np.vstack([p, p[:1]])
    chord = np.sqrt(np.hypot(*np.diff(p, axis=0).T))
    u = np.r_[0, np.cumsum(chord)]
    spline, _ = splprep(p.T, u=u, per=True, s=0)
    fine = np.column_stack(splev(np.linspace(0, u[-1], 4001), spline))
    along = np.r_[0, np.cumsum(np.hypot(*np.diff(fine, axis=0).T))]
    n = max(8, round(along[-1] / STEP))
    t = np.linspace(0, along[-1], n + 1)[:-1]
    q = np.round(np.column_stack([np.interp(t, along, fine[:, k]) for k in (0, 1)]) + ORIGIN, 2)
    clockwise = not shapely.is_ccw(shapely.linearrings(q))
    if clockwise == falls_inward:
        q = q[::-1]
    return np.vstack([q, q[:1]])


def polygon(corners):
    """A closed line of straight segments through `corners` (metres from ORIGIN); clockwise around higher ground."""
    q = np.round(np.asarray(corners, float) + ORIGIN, 2)
    if shapely.is_ccw(shapely.linearrings(q)):
        q = q[::-1]
    return np.vstack([q, q[:1]])


def ellipse(x, y, a, b, turn=0.0, wobble=0.0, lobes=3, phase=0.0, falls_inward=False):
    """A wobbly ellipse around (x, y) with half axes a and b, turned by `turn` degrees."""
    t = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    r = 1 + wobble * np.cos(lobes * t + phase)
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    ex, ey = a * r * np.cos(t), b * r * np.sin(t)
    return ring(np.column_stack([x + c * ex - s * ey, y + s * ex + c * ey]), falls_inward)


def stroke(centre_line, half_width):
    """The outline of a broad stroke along a line, its corners rounded by the spline."""
    outline = shapely.LineString(centre_line).buffer(half_width).exterior
    return ring([outline.interpolate(d).coords[0] for d in np.arange(0, outline.length - 20, 25)])


def fig1a():
    return "simple one-to-one correspondence", [
        (100, ellipse(0, 0, 360, 270, 15, 0.05)),
        (110, ellipse(10, 5, 220, 150, 15, 0.05)),
    ]


def fig1b():
    """The upper line has one deep bay that the lower line does not follow."""
    horseshoe = [(-230, 60), (-200, 150), (-100, 200), (30, 205), (160, 180), (230, 110), (235, 20), (180, -20),
                 (110, 25), (40, 90), (-60, 95), (-110, 40), (-100, -30), (-20, -60), (90, -75), (190, -85),
                 (225, -140), (170, -190), (30, -200), (-110, -180), (-200, -110), (-235, -20)]
    return "one-to-one correspondence with a single convolution", [
        (100, ellipse(0, 0, 380, 310, 0, 0.03)),
        (110, ring(horseshoe)),
    ]


def fig1c():
    """The upper line meanders: deep bays from both sides, none of them in the lower line."""
    x = np.linspace(-430, 430, 400)
    swing = 150 * np.clip(1.35 * np.sin(x / 60), -1, 1) * (1 - (x / 900) ** 2)
    return "one-to-one correspondence with multiple convolutions", [
        (100, ellipse(0, 0, 640, 340, 0, 0.03, 4)),
        (110, stroke(np.column_stack([x, swing + 25 * np.sin(x / 200)]), 42)),
    ]


def fig1d():
    """Two tops, one of which reaches around the other."""
    hook = [(-290, 20), (-270, 150), (-160, 225), (0, 240), (160, 215), (235, 130), (190, 75), (110, 120),
            (-10, 145), (-125, 115), (-175, 20), (-145, -85), (-40, -135), (90, -140), (190, -135), (215, -200),
            (110, -240), (-40, -240), (-180, -200), (-270, -100)]
    return "double branching with a single convolution", [
        (100, ellipse(15, 0, 440, 350, 0, 0.03)),
        (110, ring(hook)),
        (110, ellipse(70, -5, 150, 65, -5, 0.06)),
    ]


def fig1e():
    trefoil = [(0, 420), (120, 400), (180, 290), (190, 150), (260, 60), (390, -20), (450, -140), (390, -260),
               (250, -290), (120, -240), (0, -200), (-120, -240), (-250, -290), (-390, -260), (-450, -140),
               (-390, -20), (-260, 60), (-190, 150), (-180, 290), (-120, 400)]
    return "triple branching", [
        (100, ring(trefoil)),
        (110, ellipse(0, 270, 100, 80, 80, 0.06)),
        (110, ellipse(290, -135, 110, 75, -30, 0.06)),
        (110, ellipse(-290, -135, 105, 80, 30, 0.06)),
    ]


def fig1f():
    """Nested sub-domains: a stepped hill (tablelands), a crater (ridge-peak, then basin) and a hollow at the level
    of the lines around it, with lower ground in it."""
    return "nested sub-domains with interior boundaries of different kind", [
        (100, ellipse(0, 0, 760, 470, 5, 0.03, 4)),
        (110, ellipse(-390, 60, 240, 200, 20, 0.05)),
        (120, ellipse(-400, 70, 120, 95, 20, 0.05)),
        (110, ellipse(340, 90, 250, 220, 0, 0.04, 4)),
        (110, ellipse(345, 95, 160, 135, 0, 0.04, 4, falls_inward=True)),
        (100, ellipse(350, 95, 80, 65, 0, 0.04, falls_inward=True)),
        (100, ellipse(-20, -240, 150, 95, -5, 0.05, falls_inward=True)),
        (90, ellipse(-15, -245, 75, 45, -5, 0.05, falls_inward=True)),
    ]


def fig2():
    """A spur of the lower line is a terminal triangle, the step from it to the ground above a junction, the rest sleeves."""
    return "terminal, sleeve and junction triangles", [
        (100, polygon([(0, 0), (90, -10), (100, 40), (160, 50), (100, 60), (95, 110), (-10, 100)])),
        (110, polygon([(38, 41), (57, 35), (70, 51), (45, 66)])),
    ]


def fig3a():
    """A junction with two corners on the lower line: legs 9-40-41 around the spur, 9-12-15 in the junction."""
    return "case 2: a spur of the lower line, r = 82 / 30", [
        (100, polygon([(-100, -60), (0, -60), (0, -9), (40, 0), (0, 9), (0, 60), (-100, 60)])),
        (110, polygon([(-12, 0), (-50, -25), (-80, 0), (-50, 25)])),
    ]


def fig3b():
    """A top with three arms around a triangle of sides 18, 15 and 15; the arms' legs are 41, 12.5 and 19.5 long."""
    return "case 3: three arms of one line, r1 = 25 / 33 and r2 = 39 / 33", [
        (100, polygon([(-60, -80), (0, -95), (60, -80), (80, 0), (60, 60), (0, 75), (-60, 60), (-80, 0)])),
        (110, polygon([(0, -40), (-9, 0), (-12.5, 12), (0, 12), (18.9, 16.8), (9, 0)])),
    ]


def fig6():
    """A spur with parallel sides 20 m apart, whose corners alternate, below a straight piece of the upper line."""
    return "a ridge line along a straight spur", [
        (100, polygon([(-100, -60), (0, -60), (0, -10), (10, -10), (30, -10), (50, -10), (75, 0), (60, 10), (40, 10),
                       (20, 10), (0, 10), (0, 60), (-105, 64)])),
        (110, polygon([(-30, -20), (-30, 0), (-30, 20), (-72, 24), (-66, -22)])),
    ]


def fig5ab():
    """Two tops, nearer to each other than the lower line on both sides of the saddle is to itself: a canyon lies between
    them. Three spurs of the lower line that the tops do not follow are ridges."""
    lower = [(-620, 150), (-500, 165), (-390, 200), (-290, 300), (-210, 430), (-150, 430), (-120, 300), (-75, 215),
             (-20, 165), (0, 155), (25, 165), (75, 205), (150, 260), (260, 290), (370, 250), (450, 160),
             (560, 120), (680, 140), (700, 95), (600, 20), (490, -50), (440, -160), (330, -240), (200, -250),
             (90, -215), (30, -180), (0, -170), (-30, -180), (-100, -215), (-220, -270), (-340, -250),
             (-430, -150), (-450, -20), (-520, 60), (-630, 100)]
    return "double branching with ridges and a canyon", [
        (100, ring(lower)),
        (110, ellipse(-240, 10, 150, 125, -20, 0.06)),
        (110, ellipse(245, 15, 140, 135, 20, 0.06)),
        (120, ellipse(-250, 15, 60, 45, -20, 0.05)),
    ]


def fig5cd():
    """Three tops around a hollow: canyons run up between the tops, a basin lies in the middle, and the ground between
    the lower line and the hollow, which are of one level, is a rim of ridge-peaks."""
    lower = []
    for k in range(3):
        a = np.radians(90 - 120 * k)
        c, s = np.cos(a), np.sin(a)
        # One top's share of the line in polar form: degrees from the axis of the top, radius.
        for turn, r in [(-52, 430), (-40, 560), (-22, 640), (0, 660), (22, 640), (40, 560), (52, 430), (60, 285)][::-1]:
            d = a + np.radians(turn)
            lower.append((r * np.cos(d), r * np.sin(d)))
    tops = []
    for k, (bend, size) in enumerate([(0.07, 1.0), (0.05, 0.92), (0.06, 1.06)]):
        a = 90 - 120 * k
        x, y = 400 * np.cos(np.radians(a)), 400 * np.sin(np.radians(a))
        tops.append((110, ellipse(x, y, 135 * size, 165 * size, a, bend, 3, k)))
    return "triple branching with canyons, a basin and ridge-peaks", [
        (100, ring(lower)),
        *tops,
        (100, ellipse(0, 0, 165, 150, 0, 0.1, 3, np.radians(270), falls_inward=True)),
        (90, ellipse(0, 0, 75, 65, 0, 0.06, 3, np.radians(270), falls_inward=True)),
    ]


FIGURES = {
    "fig1a_one_to_one": fig1a, "fig1b_one_convolution": fig1b, "fig1c_many_convolutions": fig1c,
    "fig1d_two_branches_one_convolution": fig1d, "fig1e_three_branches": fig1e, "fig1f_nested": fig1f,
    "fig2_triangles": fig2, "fig3a_spur": fig3a, "fig3b_three_arms": fig3b,
    "fig5ab_two_branches_ridges_canyon": fig5ab, "fig5cd_three_branches_basin": fig5cd, "fig6_ridge": fig6,
}


def check(name, lines):
    """Stops when two lines share a point or a line touches itself."""
    geo = [shapely.linestrings(p) for _, p in lines]
    for i, a in enumerate(geo):
        if not (shapely.is_simple(a) and shapely.is_closed(a)):
            raise SystemExit(f"{name}: line {i} touches itself or is open")
        for j in range(i):
            if shapely.intersects(a, geo[j]):
                raise SystemExit(f"{name}: lines {j} and {i} touch")


def write(name, title, lines):
    features = [
        {"type": "Feature", "properties": {"elev": e}, "geometry": {"type": "LineString", "coordinates": p.tolist()}}
        for e, p in lines
    ]
    head = {"type": "FeatureCollection", "name": name, "description": title,
            "crs": {"type": "name", "properties": {"name": f"urn:ogc:def:crs:EPSG::{EPSG}"}}}
    text = json.dumps(head)[:-1] + ', "features": [\n' + ",\n".join(json.dumps(f) for f in features) + "\n]}\n"
    path = SAMPLES / f"{name}.geojson"
    path.write_text(text)
    print(f"{path.name}: {len(lines)} lines, {sum(len(p) for _, p in lines)} vertices, {len(text)} bytes")


def plot(drawn):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    fig, axes = plt.subplots(3, 4, figsize=(16, 12))
    colours = {90: "tab:blue", 100: "tab:green", 110: "tab:orange", 120: "tab:red"}
    for ax, (name, (title, lines)) in zip(axes.flat, drawn.items()):
        for e, p in lines:
            ax.plot(*(p - ORIGIN).T, color=colours[e], lw=1.5)
        ax.set_title(f"{name.split('_')[0]}: {title}", fontsize=8)
        ax.set_aspect("equal")
        ax.tick_params(labelsize=6)
    keys = [plt.Line2D([], [], color=c, label=f"{e} m") for e, c in colours.items()]
    fig.legend(handles=keys, loc="lower center", ncols=len(keys), fontsize=9)
    fig.tight_layout(rect=(0, 0.03, 1, 1))
    fig.savefig(SAMPLES / "shapes.png", dpi=75, metadata={"Software": None})


def main():
    args = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    args.add_argument("--plot", action="store_true", help="also draw samples/shapes.png")
    args = args.parse_args()
    drawn = {name: make() for name, make in FIGURES.items()}
    if args.plot:
        plot(drawn)
    for name, (title, lines) in drawn.items():
        check(name, lines)
        write(name, title, lines)


if __name__ == "__main__":
    main()
