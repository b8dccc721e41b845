"""The plugin in the profile of the test, and the programs of the test."""
import os
import pathlib
import subprocess
import sys
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent.parent
SAMPLES = pathlib.Path(os.environ["TEST_SAMPLES"])
CONTOURS = SAMPLES / "caryville_20m.gpkg"
HEIGHTS = SAMPLES / "caryville_20m_truth.tif"
NESTED = SAMPLES / "fig1f_nested.geojson"
PROGRAMS = os.environ["TEST_PROGRAMS"]
TOKOSEN = os.path.join(PROGRAMS, "tokosen")
PLUGINS = pathlib.Path(os.environ["QGIS_CUSTOM_CONFIG_PATH"], "profiles", "default", "python", "plugins")


def make_zip(path, *more):
    subprocess.run(
        [sys.executable, ROOT / "scripts" / "make" / "make_qgis_plugin.py", "-o", path, *more], check=True, capture_output=True
    )
    return path


def install(path):
    """Unpacks a plugin as QGIS does: without the permissions of its files."""
    PLUGINS.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path) as archive:
        archive.extractall(PLUGINS)


def command(*arguments):
    """Runs the program as a user would."""
    subprocess.run([TOKOSEN, *map(str, arguments)], check=True, capture_output=True)
