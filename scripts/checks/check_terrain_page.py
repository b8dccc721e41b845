#!/usr/bin/env python3
"""Checks of the page of a terrain, in a browser without a window.

    check_terrain_page.py CONTOURS INTERVAL CELL [--command target/release/tokosen] [--chromium /usr/bin/chromium] [--pictures FOLDER]

Makes a page with new contours at INTERVAL and a height map with cells of CELL, and opens the page from disk. It may be at most 5 MB;
the browser asks for nothing else and reports no error. Heights at the centres of cells and under the pointer must be those of the
height map to a centimetre, the profile and its table to 1 %, area and volume at a level to 1 %. Each control must change what it says;
texts must have the contrast of WCAG AA; all of it must work with keys. A name with HTML must do nothing. A browser without WebGL
must show the flat picture, a damaged page a sentence. The page of a comparison must have the differences of `compare -o` at the
centres of cells and under the pointer, and begin with their colours. --pictures keeps pictures of all of them, also on a phone and on paper.

Needs Chromium and the Python package playwright (which need not bring a browser). Without them, it says so and ends with status
0. Otherwise, exit status 0: all of that holds; 1: some does not.
"""
import csv
import pathlib
import random
import re
import shutil
import subprocess

import numpy as np
import rasterio

from browser import EVIL, FLAGS, Checks, arguments, run_checks

MOST_BYTES = 5_000_000
CONTRAST = """() => {
    const parse = (text) => (text.match(/[\\d.]+/g) || []).map(Number);
    const light = ([r, g, b]) => [r, g, b].map((v) => v / 255).map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
        .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
    const worst = [99, ''];
    for (const element of document.querySelectorAll('.panel *, .key-box *, .readout, .pin, .profile *, .finding')) {
        if (![...element.childNodes].some((node) => node.nodeType === 3 && node.data.trim()) || !element.checkVisibility()) continue;
        let under = element;
        while (under && (parse(getComputedStyle(under).backgroundColor)[3] ?? 1) < 0.9) under = under.parentElement;
        const style = getComputedStyle(element), paper = under ? parse(getComputedStyle(under).backgroundColor) : [255, 255, 255];
        const pair = [light(parse(style.fill && element.namespaceURI.endsWith('svg') ? style.fill : style.color)), light(paper)].sort((a, b) => b - a);
        const ratio = (pair[0] + 0.05) / (pair[1] + 0.05);
        if (ratio < worst[0]) worst.splice(0, 2, ratio, element.textContent.slice(0, 40));
    }
    return worst;
}"""


def bilinear(heights, grid, x, y):
    """Heights of a map between the centres of its cells."""
    u, v = (np.asarray(x) - grid.c) / grid.a - 0.5, (np.asarray(y) - grid.f) / grid.e - 0.5
    c, r = np.floor(u).astype(int), np.floor(v).astype(int)
    inside = (c >= 0) & (r >= 0) & (c < heights.shape[1] - 1) & (r < heights.shape[0] - 1)
    c, r = np.where(inside, c, 0), np.where(inside, r, 0)
    u, v = u - c, v - r
    rows = [heights[r, c] * (1 - u) + heights[r, c + 1] * u, heights[r + 1, c] * (1 - u) + heights[r + 1, c + 1] * u]
    return np.where(inside, rows[0] * (1 - v) + rows[1] * v, np.nan)


def settle(page):
    page.wait_for_timeout(700)


def same_heights(checks, page, heights, grid):
    origin = np.array(page.evaluate("tokosen.data.origin"))
    rows, cols = np.nonzero(np.isfinite(heights))
    chosen = random.Random(1).sample(range(len(rows)), min(2000, len(rows)))
    x, y = grid.c + (cols[chosen] + 0.5) * grid.a, grid.f + (rows[chosen] + 0.5) * grid.e
    found = page.evaluate("places => places.map(([x, y]) => tokosen.data.ground.heightAt(x, y))", (np.stack([x, y], 1) - origin).tolist())
    off = np.abs(np.array(found, dtype=float) - heights[rows[chosen], cols[chosen]])
    checks.expect(bool((off <= 0.01).all()), f"heights at {len(chosen)} centres within {off.max():.4f} m")
    worst, count = 0.0, 0
    for k in range(60):
        at = random.Random(k).randint(330, 690), random.Random(k + 99).randint(220, 560)
        page.mouse.move(*at)
        place = page.evaluate("([x, y]) => tokosen.view.placeAt(x, y)", list(at))
        if not place:
            continue
        # The browser tells the page of a move when it draws next. Panels cover other places.
        page.locator(".readout").filter(has_text=f"{place[0] + origin[0]:.1f} {place[1] + origin[1]:.1f}").wait_for(timeout=30000)
        said = page.inner_text(".readout")
        expected = float(bilinear(heights, grid, place[0] + origin[0], place[1] + origin[1]))
        height = float(re.search(r"Height (-?[\d,.]+)", said)[1].replace(",", ""))
        if np.isfinite(expected):
            worst, count = max(worst, abs(height - expected)), count + 1
    checks.expect(count > 20 and worst <= 0.01, f"heights under the pointer: {count} places within {worst:.4f} m")


def profile(checks, page, heights, grid, keeps):
    page.get_by_role("button", name="Profile").click()
    for at in ((420, 430), (760, 330)):
        page.mouse.click(*at)
        page.wait_for_timeout(200)
    origin = np.array(page.evaluate("tokosen.data.origin"))
    with page.expect_download() as download:
        page.get_by_role("button", name="Save as CSV").click()
    rows = np.array([[float(v or "nan") for v in row] for row in list(csv.reader(open(download.value.path())))[1:]])
    expected = bilinear(heights, grid, rows[:, 1], rows[:, 2])
    known = np.isfinite(expected) & np.isfinite(rows[:, 3])
    off, relief = np.abs(rows[known, 3] - expected[known]).max(), np.ptp(expected[known])
    long = np.hypot(*(rows[-1, 1:3] - rows[0, 1:3]))
    checks.expect(known.sum() > 20 and off <= 0.01 * relief, f"profile: {known.sum()} heights within {100 * off / relief:.2f} % of its relief")
    checks.expect(abs(rows[-1, 0] - long) <= 0.01 * long, f"profile: its length is {rows[-1, 0]:.1f} m of {long:.1f} m")
    keeps("profile")
    page.get_by_role("button", name="Close").click()


def levels(checks, page, heights, grid, keeps):
    known, cell = heights[np.isfinite(heights)], abs(grid.a * grid.e)
    for mode, side in (("flood", -1), ("cut", 1)):
        page.locator("select").nth(1).select_option(mode)
        settle(page)
        level = page.evaluate("tokosen.view.uniforms.level.value")
        found = page.evaluate("([level, side]) => tokosen.data.ground.beyond(level, side)", [level, side])
        off = np.maximum((known - level) * side, 0)
        expected = {"area": (off > 0).sum() * cell, "volume": off.sum() * cell}
        worst = max(abs(found[name] / expected[name] - 1) for name in expected)
        checks.expect(worst <= 0.01, f"{mode}: area and volume within {100 * worst:.3f} %")
        keeps(mode)
    page.locator("select").nth(1).select_option("none")


def controls(checks, page, keeps):
    """Each control changes the picture."""
    def changes(what, act):
        before = page.screenshot()
        act()
        settle(page)
        checks.expect(page.screenshot() != before, f"{what} changes the picture")

    for name in page.locator(".switches span").all_inner_texts():
        box = page.get_by_label(name, exact=True)
        changes(f"the switch {name}", box.uncheck)
        box.check()
    for mode in page.locator("select").first.locator("option").evaluate_all("options => options.map((o) => o.value)")[1:]:
        changes(f"colours {mode}", lambda mode=mode: page.locator("select").first.select_option(mode))
        keeps(mode)
    page.locator("select").first.select_option("byHeight")
    for k, name in enumerate(("Heights times", "Sun from", "Sun above the horizon")):
        changes(name, lambda k=k: (page.locator("input[type=range]").nth(k).focus(), [page.keyboard.press("ArrowRight") for _ in range(4)]))
    page.locator("#terrain").focus()
    for key in ("ArrowLeft", "Shift+ArrowLeft", "ArrowUp", "Shift+ArrowUp", "+", "-", "Home"):
        changes(f"the key {key}", lambda key=key: page.keyboard.press(key))
    changes("the key Tab and Enter: north up", lambda: (page.locator("#terrain").focus(), page.keyboard.press("Shift+ArrowLeft"), page.locator(".north").focus(), page.keyboard.press("Enter")))
    changes("dragging", lambda: (page.mouse.move(600, 400), page.mouse.down(), page.mouse.move(680, 430), page.mouse.up()))
    changes("the wheel", lambda: page.mouse.wheel(0, -300))
    page.get_by_role("button", name="Whole map").click()
    settle(page)
    with page.expect_download() as download:
        page.get_by_role("button", name="Save a picture").click()
    checks.expect(pathlib.Path(download.value.path()).read_bytes()[:4] == b"\x89PNG", "the picture is a PNG")
    findings = page.evaluate("tokosen.data.findings.filter((finding) => finding.place).length")
    if findings:
        page.locator(".findings summary").click()
        button = page.locator(".findings li button").first
        words = button.inner_text()
        button.click()
        settle(page)
        checks.expect(words in page.inner_text("p.finding"), f"a finding shows its sentence: {words[:60]}")
        keeps("finding")
    page.get_by_role("button", name="Profile").click()
    ratio, words = page.evaluate(CONTRAST)
    checks.expect(ratio >= 4.5, f"the least contrast is {ratio:.1f}: {words!r}")


def differences(args, browser, root, checks, keep):
    """The page of a comparison with a plain triangulation has the differences of the raster."""
    tokosen(args, "dem", args.contours, "--cell", args.cell, "--surface", "linear", "-o", root / "linear.tif")
    tokosen(args, "compare", args.contours, root / "linear.tif", "--page", root / "differences.html", "-o", root / "differences.tif")
    with rasterio.open(root / "differences.tif") as source:
        raster, grid = source.read(1, masked=True).filled(np.nan).astype(float), source.transform
    rows, cols = np.nonzero(np.isfinite(raster))
    chosen = random.Random(2).sample(range(len(rows)), min(2000, len(rows)))
    x, y = grid.c + (cols[chosen] + 0.5) * grid.a, grid.f + (rows[chosen] + 0.5) * grid.e
    for name, size, locale in (("differences", (1280, 800), "en-US"), ("differences_phone", (390, 800), "ja-JP")):
        with checks.page(browser, (root / "differences.html").as_uri(), name, locale=locale) as page:
            page.set_viewport_size({"width": size[0], "height": size[1]})
            page.wait_for_selector(".panel", timeout=60000)
            settle(page)
            mode = page.locator("select").first.input_value()
            checks.expect(mode == "byDifference", f"{name}: the colours are {mode}")
            keep(page, name)
            if name != "differences":
                continue
            origin = np.array(page.evaluate("tokosen.data.origin"))
            read = "places => places.map(([x, y]) => tokosen.data.ground.read(tokosen.data.differences, x, y))"
            found = np.array(page.evaluate(read, (np.stack([x, y], 1) - origin).tolist()), dtype=float)
            off = np.abs(found - raster[rows[chosen], cols[chosen]]).max()
            checks.expect(off <= 0.001, f"differences at {len(chosen)} centres within {off:.4f} m")
            page.mouse.move(640, 400)
            page.locator(".readout").filter(has_text="A − B").wait_for(timeout=30000)
            checks.expect(True, f"under the pointer: {page.inner_text('.readout')}")
            worst = page.evaluate("tokosen.data.differences.reduce((most, d) => (Math.abs(d) > most ? Math.abs(d) : most), 0)")
            first = float(page.locator(".findings li").first.text_content().split()[0])
            checks.expect(abs(abs(first) - worst) <= 0.01, f"the first pin has {first} m, the largest difference {worst:.3f} m")


def tokosen(args, *words):
    subprocess.run([args.command, *map(str, words), "-q"], check=True)


def run(args, playwright, root, checks):
    page_file = root / "terrain.html"
    tokosen(args, "mesh", args.contours, "-i", args.interval, "--cell", args.cell, "--uncertainty", "-o", page_file)
    tokosen(args, "dem", args.contours, "--cell", args.cell, "-o", root / "dem.tif")
    with rasterio.open(root / "dem.tif") as source:
        heights, grid = source.read(1, masked=True).filled(np.nan).astype(float), source.transform
    size = page_file.stat().st_size
    checks.expect(size <= MOST_BYTES, f"the page has {size / 1e6:.2f} MB")
    browser = playwright.chromium.launch(executable_path=args.chromium, args=FLAGS)
    address = page_file.as_uri()

    def keep(page, name):
        if checks.pictures:
            settle(page)
            page.screenshot(path=checks.pictures / f"{name}.png")

    with checks.page(browser, address, "desk") as page:
        page.wait_for_selector(".panel", timeout=60000)
        settle(page)
        same_heights(checks, page, heights, grid)
        profile(checks, page, heights, grid, lambda name: keep(page, name))
        levels(checks, page, heights, grid, lambda name: keep(page, name))
        controls(checks, page, lambda name: keep(page, name))
    with checks.page(browser, address, "phone", locale="ja-JP", has_touch=True, is_mobile=True) as page:
        page.set_viewport_size({"width": 390, "height": 800})
        page.wait_for_selector(".panel")
        settle(page)
        page.touchscreen.tap(200, 420)
        page.wait_for_timeout(300)
        checks.expect("標高" in page.evaluate("document.querySelector('.readout').value"), "phone: a tap tells the height, in Japanese")
    with checks.page(browser, address, "print") as page:
        page.wait_for_selector(".panel")
        settle(page)
        paper = page.pdf(prefer_css_page_size=True, print_background=True)
        checks.expect(len(re.findall(rb"/Type\s*/Page\b", paper)) == 1, "printed on one sheet")
        if checks.pictures:
            (checks.pictures / "print.pdf").write_bytes(paper)

    differences(args, browser, root, checks, keep)
    evil = root / EVIL.replace("/", "_")
    evil = evil.with_name(evil.name + pathlib.Path(args.contours).suffix)
    shutil.copy(args.contours, evil)
    tokosen(args, "mesh", evil, "-o", root / "evil.html")
    with checks.page(browser, (root / "evil.html").as_uri(), "evil") as page:
        page.wait_for_selector(".panel")
        checks.expect(page.evaluate("window.harmed === undefined") and "<img" in page.inner_text(".panel h1"), "HTML in a name does nothing")
    damaged = root / "damaged.html"
    damaged.write_text(page_file.read_text().replace('"heights":"', '"heights":"AAAA', 1))
    checks_page(checks, browser, damaged.as_uri(), "damaged", "damaged")
    old = browser.new_context()
    old.add_init_script("delete window.DecompressionStream")
    checks_page(checks, old, address, "an old browser", "too old")
    browser.close()
    browser = playwright.chromium.launch(executable_path=args.chromium, args=["--no-sandbox", "--disable-3d-apis"])
    with checks.page(browser, address, "flat") as page:
        page.wait_for_selector(".panel")
        checks.expect("WebGL" in page.inner_text(".panel"), "without WebGL: the flat picture, and a sentence")
    browser.close()


def checks_page(checks, browser, address, name, words):
    """The page must end in a sentence with these words."""
    page = browser.new_page()
    page.goto(address)
    page.wait_for_selector(".fault")
    text = page.inner_text(".fault")
    checks.expect(words in text, f"{name}: {' '.join(text.split())}")
    page.close()


if __name__ == "__main__":
    args = arguments(__doc__, ("contours", str), ("interval", float), ("cell", float))
    run_checks(args, Checks(args.pictures), run)
