"""Runs that are killed at random moments: the output is the old or the new one as a whole, and the next run works.

The moments are those of a seeded generator. Half of them lie anywhere in a run, half shortly after the output is first seen
in the hidden folder, because a run spends little time there.
"""
import os
import random
import shutil
import signal
import sqlite3
import subprocess
import tempfile
import time
from pathlib import Path

from hostile_inputs.running import Row, digest, environment_of_tests

LATE = 0.15  # seconds
COMMANDS = {
    "a new layer in a GeoPackage": ("out.gpkg", "densify big.gpkg -i 5 -o out.gpkg -q"),
    "the same layer again": ("out.gpkg", "densify big.gpkg -i 10 -o out.gpkg -q"),
    "a layer in its own input": ("big.gpkg", "densify big.gpkg --layer contours_20m -i 5 -o big.gpkg -q"),
    "a GeoTIFF": ("out.tif", "dem big.gpkg --cell 20 -o out.tif -q"),
    "a drawing": ("out.dxf", "densify big.gpkg -i 10 -o out.dxf -q"),
}


def content(path):
    """What a file holds: its bytes, or the rows of all tables of a database."""
    if not path.exists() or path.suffix != ".gpkg":
        return digest(path)
    db = sqlite3.connect(path)
    sound = db.execute("PRAGMA integrity_check").fetchall()
    names = [name for (name,) in db.execute("SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name")]
    # The last numbers that were given are no data.
    rows = [(name, sorted(map(repr, db.execute(f'SELECT * FROM "{name}"')))) for name in names if name != "sqlite_sequence"]
    db.close()
    return sound, rows


def started(program, folder, command):
    return subprocess.Popen(
        [program, *command.split()], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        env=environment_of_tests(),
    )  # fmt: skip


def finish(child, seconds):
    try:
        said = child.communicate(timeout=seconds)[1].decode(errors="replace")
    except subprocess.TimeoutExpired:
        child.kill()
        child.communicate()
        return None, ""
    return child.returncode, said


def hidden(folder):
    return [path for path in folder.iterdir() if path.name.startswith(".tokosen-")]


def wait_for_output(child, folder, name):
    """Until the output is in the hidden folder, or the run has ended."""
    while child.poll() is None and not any((path / name).exists() for path in hidden(folder)):
        time.sleep(0.0005)


def killed(program, folder, command, name, moment, late):
    child = started(program, folder, command)
    if late:
        wait_for_output(child, folder, name)
    time.sleep(moment)
    if child.poll() is None:
        child.send_signal(signal.SIGKILL)
    return finish(child, 10)[0]


def fault_after(folder, name, old, new, command, program, seconds):
    """What is wrong after a run was killed, and after the next one."""
    # A copy: to open a database takes back what was not finished, and the next run is to do that itself.
    copy = folder / "copy"
    copy.mkdir()
    for path in folder.glob(f"{name}*"):
        shutil.copy(path, copy / path.name)
    found = content(copy / name)
    shutil.rmtree(copy)
    if found not in (old, new):
        return "the output is neither the old nor the new one"
    if found == new and f"densify {name}" in command:
        return None  # The run was over but for its end. The layer is there now, and an input is not replaced unasked.
    for path in hidden(folder):
        lock = path / ".lock"
        if lock.exists():
            os.utime(lock, (time.time() - 600,) * 2)
    status, said = finish(started(program, folder, command), seconds)
    if status != 0:
        return f"the next run ends with {status}: {said.strip()[-80:]}"
    if content(folder / name) != new:
        return "the output of the next run is not that of an undisturbed one"
    left = [path.name for path in hidden(folder) if (path / ".lock").exists()]
    return f"left {left}" if left else None


def prepare(program, folder, sample, name, command):
    """The folder before the run; gives what the output holds before and after an undisturbed run, and its duration."""
    part = f"densify {sample} -i 20 --extent 744000,4017500,747500,4020500 -o big.gpkg -q"
    assert finish(started(program, folder, part), 120)[0] == 0
    first = command.replace("-i 5", "-i 10").replace("--cell 20", "--cell 40")
    if name != "big.gpkg":
        finish(started(program, folder, first), 120)
    old = content(folder / name)
    with tempfile.TemporaryDirectory() as other:
        other = Path(other)
        shutil.copytree(folder, other, dirs_exist_ok=True)
        start = time.monotonic()
        status, said = finish(started(program, other, command), 120)
        assert status == 0, said
        return old, content(other / name), time.monotonic() - start


def rows(program, sample, o):
    each = max(1, o.kills // len(COMMANDS)) if o.kills else 0
    for kind, (name, command) in COMMANDS.items():
        if o.only not in f"kill: {kind}" or not each:
            continue
        moments = random.Random(f"{o.seed} {kind}")
        with tempfile.TemporaryDirectory() as sound:
            sound = Path(sound)
            old, new, duration = prepare(program, sound, sample, name, command)
            for number in range(each):
                late = number % 2 == 1
                moment = moments.uniform(0, LATE if late else duration)
                with tempfile.TemporaryDirectory() as folder:
                    folder = Path(folder)
                    shutil.copytree(sound, folder, dirs_exist_ok=True)
                    start = time.monotonic()
                    status = killed(program, folder, command, name, moment, late)
                    taken = time.monotonic() - start
                    why = fault_after(folder, name, old, new, command, program, o.seconds)
                when = f"{moment:.3f} s" + (" after the output is there" if late else "")
                yield Row(f"kill: {kind}, {when}", why, status, taken, "")
