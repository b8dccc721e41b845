#!/usr/bin/env python3
"""Do the 3-D pages of a terrain, of a height map and of a comparison open in a browser, from disk?

    open_pages.py [--command target/debug/tokosen] [--chromium /usr/bin/chromium]

Makes the pages from a drawn sample, and opens each in Chromium without a window. The page must draw, have its scale and its controls,
say nothing of a fault, and leave no error in the console. A damaged page must say so, and an error that is put into a page must be
seen here. It takes some seconds; check_terrain_page.py tries what the pages can do.

Needs Chromium alone, with WebGL. Without it, it says so and ends with status 0. Otherwise, exit status 0: all of that holds; 1: some does not.
"""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SAMPLE = pathlib.Path(__file__).resolve().parents[2] / "samples" / "fig3a_spur.geojson"
FLAGS = ["--headless=new", "--no-sandbox", "--no-first-run", "--disable-background-networking", "--disable-component-update",
         "--disable-sync", "--enable-unsafe-swiftshader", "--use-gl=angle", "--use-angle=swiftshader", "--enable-logging=stderr"]
# A page that tells whether the browser works at all.
TRIAL = "<canvas></canvas><script>document.body.append(`WebGL: ${!!document.querySelector('canvas').getContext('webgl2')}`)</script>"
# Time that the page believes to pass, milliseconds; the browser goes through it as fast as it can.
PATIENCE = 20_000
LIMIT = 120


def make(command, folder):
    """The pages, by name."""
    dem, other = folder / "dem.tif", folder / "other.tif"
    pages = {name: folder / f"{name}.html" for name in ("terrain", "height_map", "comparison")}
    for arguments in (
        ["dem", SAMPLE, "--cell", "1", "-o", dem],
        ["dem", SAMPLE, "--cell", "1", "--surface", "linear", "-o", other],
        ["mesh", SAMPLE, "-i", "5", "-o", pages["terrain"]],
        ["mesh", dem, "-i", "5", "-o", pages["height_map"]],
        ["compare", dem, other, "--page", pages["comparison"]],
    ):
        subprocess.run([command, *map(str, arguments), "-q"], check=True, timeout=LIMIT)
    return pages


def opened(chromium, page, profile):
    """The page after its scripts ran, without them, and the errors in the console."""
    flags = [*FLAGS, f"--user-data-dir={profile}", f"--virtual-time-budget={PATIENCE}", "--dump-dom"]
    done = subprocess.run([chromium, *flags, page.as_uri()], capture_output=True, text=True, timeout=LIMIT, errors="replace")
    body = re.sub(r"<(script|style)\b.*?</\1>", "", done.stdout, flags=re.DOTALL)
    # Notes about graphics without a graphics card are no errors of the page.
    console = [line for line in done.stderr.splitlines() if "CONSOLE" in line and re.search(r"Uncaught|Error|Refused|violates", line)]
    return body, console


def faults_of(body, console):
    """What is wrong with an open page."""
    wanted = {
        "no picture is drawn": r'<canvas[^>]* data-engine="three',
        "no scale": r'class="scale"><div style="width: [\d.]+px;"></div><span>[\d.]+ k?m<',
        "no controls": r'<input type="range"',
    }
    found = [what for what, pattern in wanted.items() if not re.search(pattern, body)]
    told = re.search(r'<section class="fault".*?<p>(.*?)</p>', body, flags=re.DOTALL)
    return ([f"it says: {told[1]}"] if told else []) + found + console


def draws(chromium, folder):
    """Whether the browser starts here, and draws."""
    (folder / "trial.html").write_text(TRIAL)
    try:
        return "WebGL: true" in opened(chromium, folder / "trial.html", folder / "profile")[0]
    except (OSError, subprocess.TimeoutExpired):
        return False


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", default="target/debug/tokosen")
    parser.add_argument("--chromium", default=next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None))
    args = parser.parse_args()
    if not args.chromium:
        sys.exit(print("skipped: Chromium is not installed"))
    failures = 0
    with tempfile.TemporaryDirectory() as root:
        folder = pathlib.Path(root)
        if not draws(args.chromium, folder):
            sys.exit(print(f"skipped: {args.chromium} does not draw in WebGL here"))
        pages = make(args.command, folder)
        text = pages["terrain"].read_text()
        broken = {
            "damaged": (text.replace('"heights":"', '"heights":"AAAA', 1), "it says: The file is damaged"),
            "with_an_error": (text.replace("</body>", "<script>nothing.here()</script></body>", 1), "nothing is not defined"),
        }
        for name, (changed, _) in broken.items():
            pages[name] = folder / f"{name}.html"
            pages[name].write_text(changed)
        for name, page in pages.items():
            faults = faults_of(*opened(args.chromium, page, folder / "profile"))
            expected = broken.get(name, (None, None))[1]
            holds = any(expected in fault for fault in faults) if expected else not faults
            print("ok  " if holds else "FAIL", name, *faults[:3])
            failures += not holds
    sys.exit(failures > 0)


if __name__ == "__main__":
    main()
