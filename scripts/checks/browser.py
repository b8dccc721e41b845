"""A browser without a window, for the checks of pages."""
import argparse
import contextlib
import pathlib
import shutil
import sys
import tempfile

FLAGS = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--enable-unsafe-swiftshader", "--use-gl=angle", "--use-angle=swiftshader"]
# A name or a source that does harm where a page takes it for HTML.
EVIL = "<img src=x onerror=\"window.harmed=1\"><script>window.harmed=1</script>"


class Checks:
    """Counts what does not hold."""

    def __init__(self, pictures):
        self.failures, self.pictures = 0, pictures

    def expect(self, holds, what):
        print("ok  " if holds else "FAIL", what, flush=True)
        self.failures += not holds

    @contextlib.contextmanager
    def page(self, browser, address, name, missing_tiles=False, **options):
        """A page, of which all errors and all requests to elsewhere are faults."""
        context = browser.new_context(viewport={"width": 900, "height": 700}, **options)
        page, errors, elsewhere = context.new_page(), [], []
        page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("request", lambda request: None if request.url.startswith((address, "data:", "blob:")) else elsewhere.append(request.url))
        page.goto(address)
        yield page
        if self.pictures:
            page.screenshot(path=self.pictures / f"{name}.png")
        # The browser itself reports tiles of a folder that are not there. That is how they are left out.
        errors = [error for error in errors if not (missing_tiles and "404" in error)]
        self.expect(not errors, f"{name}: no error in the console {errors[:3] or ''}")
        self.expect(not elsewhere, f"{name}: nothing is asked of other places {elsewhere[:3] or ''}")
        context.close()

    def sentence(self, browser, address, name, words, **options):
        """The page must end in a sentence with these words."""
        context = browser.new_context(viewport={"width": 900, "height": 700}, **options)
        page = context.new_page()
        page.goto(address)
        page.wait_for_selector(".faults")
        text = page.inner_text(".faults")
        if self.pictures:
            page.screenshot(path=self.pictures / f"{name}.png")
        self.expect(words in text, f"{name}: {' '.join(text.split())[:150]}")
        context.close()


def arguments(description, *inputs):
    """The arguments of a check: its inputs, each a name and a type, the program, the browser, and where pictures are kept."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, kind in inputs:
        parser.add_argument(name, type=kind)
    parser.add_argument("--command", default="target/release/tokosen")
    parser.add_argument("--chromium", default=next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None))
    parser.add_argument("--pictures", type=pathlib.Path)
    return parser.parse_args()


def run_checks(args, checks, run):
    """Runs `run(args, playwright, folder, checks)`, and ends with its exit status. `checks` counts its faults in `failures`."""
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        sync_playwright = None
    if not (args.chromium and sync_playwright):
        print(f"skipped: {'the Python package playwright' if args.chromium else 'Chromium'} is not installed")
        sys.exit(0)
    if args.pictures:
        args.pictures.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as root, sync_playwright() as playwright:
        run(args, playwright, pathlib.Path(root), checks)
    print(f"{checks.failures} faults")
    sys.exit(1 if checks.failures else 0)
