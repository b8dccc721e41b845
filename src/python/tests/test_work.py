"""Progress, Ctrl-C, other threads, forked processes, notebooks, the command."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import tokosen
from conftest import ROOT, SAMPLES

# On a smaller map, steps end before they are told.
LARGE = SAMPLES / "caryville_20m.gpkg"


def test_progress_names_the_steps_and_grows():
    told = []
    tokosen.dem(LARGE, 30, progress=lambda step, share: told.append((step, share)))
    steps = [step for step, _ in told]
    assert "smooth surface" in steps and len(set(steps)) >= 3
    assert all(share is None or 0 <= share <= 1 for _, share in told)


def test_an_exception_of_the_function_stops_the_work(part):
    def stop(step, share):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        tokosen.dem(part, 5, progress=stop)
    with pytest.raises(TypeError, match="progress"):
        tokosen.dem(part, 30, progress="yes")
    # The next call works as ever.
    assert tokosen.dem(tokosen.example(), 20).shape == (30, 28)


def test_bars_of_tqdm(capsys):
    pytest.importorskip("tqdm")
    tokosen.dem(LARGE, 30, progress=True)
    assert "smooth surface" in capsys.readouterr().err


def test_ctrl_c_stops_the_work_soon(part):
    # A job in the background of a shell ignores Ctrl-C, and so does Python there.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    start = time.monotonic()
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        while True:
            tokosen.dem(part, 2)
    timer.join()
    signal.signal(signal.SIGINT, before)
    assert time.monotonic() - start < 20


def test_other_threads_run_meanwhile(part):
    counted = 0
    over = threading.Event()

    def count():
        nonlocal counted
        while not over.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    start = time.monotonic()
    tokosen.dem(part, 10)
    time_of_work = time.monotonic() - start
    over.set()
    thread.join()
    assert counted > 100 * time_of_work


def in_child(queue):
    queue.put(tokosen.dem(tokosen.example(), 20).values)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_forked_process_has_threads_of_its_own():
    wanted = tokosen.dem(tokosen.example(), 20).values
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child = context.Process(target=in_child, args=(queue,))
    child.start()
    assert np.array_equal(queue.get(timeout=60), wanted, equal_nan=True)
    child.join()


def test_objects_show_themselves_in_notebooks():
    terrain = tokosen.Terrain(tokosen.example())
    dem = terrain.dem(cell=10)
    for shown in (terrain, dem, tokosen.compare(terrain, dem), tokosen.check(tokosen.example())):
        text = shown._repr_html_()
        assert text.startswith("<div>") and text.count("<tr>") >= 3
        assert repr(shown).startswith("<")
    pictured = (terrain, dem, tokosen.compare(terrain, dem))
    assert all("data:image/png;base64" in shown._repr_html_() for shown in pictured)


def test_the_command_is_the_program(program):
    assert "densify" in program("--help").stdout
    assert tokosen.__version__ in program("--version").stdout
    assert "error: " in program("dem", "missing.gpkg", "--cell", 10, "-o", "d.tif", status=1).stderr
    program("dem", status=2)


def test_the_lines_of_the_readme_run(tmp_path):
    block = (ROOT / "README.md").read_text().split("```python\n")[1].split("```")[0]
    (tmp_path / "target").mkdir()
    (tmp_path / "samples").symlink_to(SAMPLES)
    done = subprocess.run([sys.executable, "-c", block], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0 and (tmp_path / "target/caryville_dem.tif").exists(), done.stderr


def test_the_import_is_quick_and_needs_numpy_only():
    code = "import sys, tokosen; print(sorted(m for m in sys.modules if m in ('pandas', 'shapely', 'pyproj', 'xarray')))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
