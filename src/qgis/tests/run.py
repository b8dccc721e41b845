#!/usr/bin/env python3
"""Tests the QGIS plugin with the QGIS that is installed, in a fresh profile and without a screen.

    run.py                                  # with target/release/tokosen, otherwise target/debug/tokosen
    run.py --program PATH

Without QGIS nothing is tested; this is said, and is no failure.
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent.parent
# The modules of tests, by process. The first installs the plugin for all.
PARTS = [["commands"], ["parameters", "layers", "running", "looks"]]
BUILDS = [ROOT / "target" / build / "tokosen" for build in ("release", "debug")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, help="the program tokosen")
    args = parser.parse_args()
    # Debian's qgis_process is a script that passes an option which the program does not know.
    process = shutil.which("qgis_process.bin") or shutil.which("qgis_process")
    python = python_of_qgis()
    if not process or not python:
        print("QGIS is not installed: skipped")
        return 0
    program = args.program or next((build for build in BUILDS if build.is_file()), None)
    if not program or not program.is_file():
        sys.exit("the program tokosen is not built; name it with --program")
    with tempfile.TemporaryDirectory(prefix="qgis_test_") as folder:
        environment = prepared(pathlib.Path(folder), process, python, program.resolve())
        runs = [[python, "-m", "unittest", "-v", *part] for part in PARTS]
        failed = [run for run in runs if subprocess.run(run, cwd=HERE, env=environment).returncode != 0]
    return 1 if failed else 0


def python_of_qgis():
    """A Python that has the modules of QGIS; None if there is none."""
    for python in (sys.executable, "/usr/bin/python3", shutil.which("python3")):
        if python and subprocess.run([python, "-c", "import qgis.core"], capture_output=True).returncode == 0:
            return python
    return None


def prepared(folder, process, python, program):
    """Makes the folders of a fresh user of QGIS. Returns the environment that the tests run in."""
    home, runtime, programs, work = (folder / name for name in ("home", "runtime", "programs", "work"))
    for made in (home, runtime, programs, work):
        made.mkdir(mode=0o700)
    (programs / "tokosen").symlink_to(program)
    # QGIS may write to a GeoPackage that it only reads.
    samples = shutil.copytree(ROOT / "samples", folder / "samples", ignore=shutil.ignore_patterns("*.png"))
    outside = [part for part in os.environ["PATH"].split(os.pathsep) if not (pathlib.Path(part) / "tokosen").is_file()]
    return {
        **os.environ,
        "HOME": str(home),
        "XDG_RUNTIME_DIR": str(runtime),
        "TMPDIR": str(work),
        "QT_QPA_PLATFORM": "offscreen",
        "CPL_LOG": os.devnull,
        "PYTHONDONTWRITEBYTECODE": "1",
        "PYTHONWARNINGS": "ignore",
        "QGIS_CUSTOM_CONFIG_PATH": str(folder / "profile"),
        # QGIS takes the modules of the first python3 there.
        "PATH": os.pathsep.join([os.path.dirname(python), *outside]),
        "TEST_PROGRAMS": str(programs),
        "TEST_SAMPLES": str(samples),
        "TEST_QGIS_PROCESS": process,
    }


if __name__ == "__main__":
    sys.exit(main())
