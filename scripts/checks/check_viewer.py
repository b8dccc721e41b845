#!/usr/bin/env python3
"""Checks of the page for map tiles, in a browser without a window.

    check_viewer.py CONTOURS ZOOM [--command target/release/tokosen] [--chromium /usr/bin/chromium] [--pictures FOLDER]

Makes pages with tiles of contours, of heights and of both, as archives and as folders, and opens them from a server of its own.
At four zooms there must be lines and shading; the browser asks only for what is in the folder, and reports no error. Heights that
the page shows, and those that MapLibre GL has decoded, must be those of a GeoTIFF with the same cells, up to half a step of the
encoding, at 1000 places each. Names and sources with HTML must do nothing. A page that is opened as a file, a server without range
requests, and files that are missing or damaged must end in a sentence. --pictures keeps pictures of all of them.

Needs Chromium and the Python package playwright (which need not bring a browser). Without them, it says so and ends with status
0. Otherwise, exit status 0: all of that holds; 1: some does not.
"""
import contextlib
import functools
import http.server
import io
import pathlib
import random
import shutil
import subprocess
import threading

import numpy as np
import PIL.Image
import rasterio

from browser import EVIL, FLAGS, Checks, arguments, run_checks

WIDTH = 2 * 20037508.342789244
STEPS = {"terrarium": 1 / 256, "mapbox": 0.1, "gsi": 0.01}
READY = "() => window.tokosen && document.querySelector('.panel') && tokosen.map.loaded() && tokosen.map.areTilesLoaded()"


class Handler(http.server.SimpleHTTPRequestHandler):
    """Gives out a folder, with range requests unless the server has none."""

    def log_message(self, *_):
        pass

    def do_GET(self):
        wanted = self.headers.get("Range")
        path = pathlib.Path(self.translate_path(self.path))
        if not (wanted and self.server.has_ranges and path.is_file()):
            return super().do_GET()
        first, last = wanted.removeprefix("bytes=").split("-")
        size = path.stat().st_size
        first, last = int(first), min(int(last or size - 1), size - 1)
        self.send_response(206)
        self.send_header("Content-Range", f"bytes {first}-{last}/{size}")
        self.send_header("Content-Length", str(last - first + 1))
        self.end_headers()
        with open(path, "rb") as file:
            file.seek(first)
            self.wfile.write(file.read(last - first + 1))


@contextlib.contextmanager
def served(folder, has_ranges=True):
    """The address of a server for a folder."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=folder))
    server.has_ranges = has_ranges
    # A page that has seen enough of a file closes the connection.
    server.handle_error = lambda *_: None
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/"
    finally:
        server.shutdown()


def colours(page):
    """The share of pixels with the colour of lines, and the number of greys, in the middle of the page."""
    picture = PIL.Image.open(io.BytesIO(page.screenshot())).convert("RGB").crop((320, 60, 880, 640))
    red, green, blue = np.moveaxis(np.asarray(picture).astype(int), 2, 0)
    lines = (red - blue > 40) & (red < 210)
    return lines.mean(), len(np.unique(red[~lines]))


def look(checks, page, name, zooms, has_lines=True, has_shade=True):
    """The page at some zooms."""
    page.wait_for_function(READY, timeout=60000)
    for zoom in zooms:
        page.evaluate("zoom => tokosen.map.jumpTo({ zoom })", zoom)
        page.wait_for_timeout(300)
        page.wait_for_function(READY, timeout=60000)
        page.wait_for_timeout(500)
        lines, greys = colours(page)
        shown = (lines > 0.002) == has_lines and (greys > 40 or not has_shade)
        checks.expect(shown, f"{name}, zoom {zoom}: {100 * lines:.1f} % of the pixels are lines, {greys} tones")
        if checks.pictures:
            page.screenshot(path=checks.pictures / f"{name}_{zoom}.png")


def same_heights(checks, page, name, truth, encoding, zoom, side):
    """Heights of the page and of MapLibre GL beside those of a GeoTIFF."""
    with rasterio.open(truth) as source:
        expected, grid = source.read(1, masked=True).filled(np.nan).astype(float), source.transform
    rows, cols = np.nonzero(np.isfinite(expected))
    chosen = random.Random(1).sample(range(len(rows)), 1000)
    rows, cols = rows[chosen], cols[chosen]
    x, y = grid.c + (cols + 0.5) * grid.a, grid.f + (rows + 0.5) * grid.e
    lng, lat = x / WIDTH * 360, np.degrees(2 * np.arctan(np.exp(2 * np.pi * y / WIDTH)) - np.pi / 2)
    read = """async (places) => {
        const read = tokosen.heightReader(tokosen.sets.find((set) => set.kind === 'terrain'));
        const heights = [];
        for (const [lng, lat] of places) heights.push(await read({ lng, lat }));
        return heights;
    }"""
    found = np.array(page.evaluate(read, np.stack([lng, lat], 1).tolist()), dtype=float)
    off = np.abs(found - expected[rows, cols])
    checks.expect(bool((off <= STEPS[encoding] / 2 + 1e-3).all()), f"{name}: the page reads 1000 heights within {off.max():.4f} m")
    # What the map has decoded: visit the places until their tiles were there.
    decoded = """async ([places, zoom, side]) => {
        const { map, sets } = tokosen, number = sets.findIndex((set) => set.kind === 'terrain');
        const heights = places.map(() => null), manager = map.style.tileManagers[`set ${number}`];
        for (let k = 0; k < places.length; k++) {
            if (heights[k] !== null) continue;
            map.jumpTo({ center: places[k].slice(0, 2), zoom });
            await new Promise((done) => map.once('idle', done));
            for (const tile of manager.getRenderableIds().map((id) => manager.getTileByID(id))) {
                const { z, x, y } = tile.tileID.canonical;
                if (z !== zoom || !tile.dem) continue;
                places.forEach(([, , column, row], p) => {
                    const [i, j] = [column - x * side, row - y * side];
                    if (i >= 0 && j >= 0 && i < side && j < side) heights[p] = tile.dem.get(i, j);
                });
            }
        }
        return heights;
    }"""
    pixel = WIDTH / 2**zoom / side
    columns, lines = np.floor((x + WIDTH / 2) / pixel), np.floor((WIDTH / 2 - y) / pixel)
    places = np.stack([lng, lat, columns, lines], 1).tolist()
    found = np.array(page.evaluate(decoded, [places, zoom, side]), dtype=float)
    off = np.abs(found - expected[rows, cols])
    checks.expect(bool((off <= STEPS[encoding] / 2 + 1e-3).all()), f"{name}: MapLibre GL has decoded {np.isfinite(found).sum()} heights within {off.max():.4f} m")


def check_faults(checks, browser, folder, root):
    """What is wrong must be a sentence."""
    page = (folder / "index.html").as_uri()
    checks.sentence(browser, page, "opened as a file", "opened as a file")
    checks.sentence(browser, page, "opened as a file, Japanese", "ウェブサーバー", locale="ja-JP")
    with served(folder, has_ranges=False) as address:
        checks.sentence(browser, address, "no range requests", "does not answer range requests")
    broken = root / "broken"
    shutil.copytree(folder, broken)
    with served(broken) as address:
        (broken / "terrain.pmtiles").rename(broken / "moved.pmtiles")
        checks.sentence(browser, address, "one set is missing", "terrain.pmtiles is not in the folder")
        whole = (broken / "contours.pmtiles").read_bytes()
        (broken / "contours.pmtiles").write_bytes(whole[:200])
        checks.sentence(browser, address, "cut off", "contours.pmtiles is damaged")
        (broken / "contours.pmtiles").write_bytes(b"\0" * 1000)
        checks.sentence(browser, address, "no archive", "contours.pmtiles is damaged")
        (broken / "contours.pmtiles").unlink()
        checks.sentence(browser, address, "all sets are missing", "cannot be shown")


def run(args, playwright, root, checks):
    browser = playwright.chromium.launch(executable_path=args.chromium, args=FLAGS)

    def tokosen(*words):
        subprocess.run([args.command, *map(str, words), "-q"], check=True)

    high, side = args.zoom, 512
    truth = {}
    for side in (512, 256):
        truth[side] = root / f"truth_{side}.tif"
        tokosen("dem", args.contours, "--to-crs", "EPSG:3857", "--cell", repr(WIDTH / 2**high / side), "-o", truth[side])
    zooms = [high - 2, high - 1, high, high + 2]

    both = root / "both"
    both.mkdir()
    tokosen("densify", args.contours, "-i", 10, "-o", both / "contours.pmtiles", "--attribution", "Survey & Sons " + EVIL)
    tokosen("dem", args.contours, "--max-zoom", high, "-o", both / "terrain.pmtiles", "--viewer", both / "index.html")
    with served(both) as address:
        with checks.page(browser, address, "both") as page:
            look(checks, page, "both", zooms)
            text = page.inner_text("body")
            checks.expect("Source: Survey & Sons" in text and "harmed" not in text, "both: the source is shown as a text")
            checks.expect(page.evaluate("window.harmed === undefined"), "both: HTML in the source does nothing")
            page.mouse.move(500, 350)
            page.wait_for_function("() => /Height \\d/.test(document.querySelector('.height').value)")
            page.select_option("select", "ft")
            page.mouse.move(505, 350)
            page.wait_for_function("() => /Height \\d+\\.\\d ft/.test(document.querySelector('.height').value)")
            same_heights(checks, page, "both", truth[512], "terrarium", high, 512)
        with checks.page(browser, address, "relief") as page:
            page.wait_for_function(READY, timeout=60000)
            page.get_by_label("3-D terrain").check()
            page.wait_for_timeout(1500)
            look(checks, page, "relief", [high - 1])
            height = page.evaluate("tokosen.map.queryTerrainElevation(tokosen.map.getCenter())")
            checks.expect(bool(height), f"relief: the ground is raised ({height:.0f} m in the middle)")
        with checks.page(browser, address, "japanese", locale="ja-JP") as page:
            look(checks, page, "japanese", [high])
            checks.expect("等高線" in page.inner_text(".panel"), "japanese: the words are Japanese")
    check_faults(checks, browser, both, root)

    lines = root / "lines"
    lines.mkdir()
    evil = lines / "<img src=x onerror=alert(1)> #1 %41&'.pmtiles"
    tokosen("densify", args.contours, "-i", 20, "-o", evil, "--viewer", lines / "index.html")
    with served(lines) as address, checks.page(browser, address, "contours alone") as page:
        page.on("dialog", lambda dialog: checks.expect(False, "a name runs a script"))
        look(checks, page, "contours alone", [high], has_shade=False)

    heights = root / "heights"
    heights.mkdir()
    tokosen("dem", args.contours, "--max-zoom", high, "--tile-size", 256, "--png-encoding", "gsi", "-o", heights / "gsi/{z}/{x}/{y}.webp",
            "--viewer", heights / "index.html")
    with served(heights, has_ranges=False) as address, checks.page(browser, address, "folder", missing_tiles=True) as page:
        look(checks, page, "folder", [high], has_lines=False)
        same_heights(checks, page, "folder", truth[256], "gsi", high, 256)


if __name__ == "__main__":
    args = arguments(__doc__, ("contours", str), ("zoom", int))
    run_checks(args, Checks(args.pictures), run)
