"""Two runs that write layers into one GeoPackage at the same time: both layers are there, or a run says why not."""
import random
import shutil
import sqlite3
import tempfile
import time
from pathlib import Path

from hostile_inputs.kills import finish, hidden, started
from hostile_inputs.running import Row

ROUNDS = 6


def layers(path):
    """The layers of a GeoPackage, each with the number of its rows."""
    db = sqlite3.connect(path)
    sound = db.execute("PRAGMA integrity_check").fetchone()[0]
    names = [name for (name,) in db.execute("SELECT table_name FROM gpkg_contents")]
    counts = {name: db.execute(f'SELECT count(*) FROM "{name}"').fetchone()[0] for name in names}
    db.close()
    return sound, counts


def fault_of(folder, ends, earlier):
    if hidden(folder):
        return "left a hidden folder"
    sound, counts = layers(folder / "out.gpkg")
    if sound != "ok":
        return sound
    wanted = dict(earlier)
    for (status, said), layer in ends:
        if status == 0:
            wanted[layer] = None
        elif status != 1 or "error: " not in said:
            return f"status {status}: {said.strip()[-80:]}"
    missing = [name for name, count in wanted.items() if not counts.get(name) or (count and counts[name] != count)]
    return f"the layers {missing} are missing" if missing else None


def rows(program, sample, o):
    moments = random.Random(o.seed)
    for kind in ("a new file", "a file that exists", "a new file in feet and metres"):
        for number in range(ROUNDS):
            name = f"two runs: {kind}, {number}"
            if o.only not in name:
                continue
            with tempfile.TemporaryDirectory() as folder:
                folder = Path(folder)
                shutil.copy(sample, folder / "big.gpkg")
                earlier = {}
                if "exists" in kind:
                    assert finish(started(program, folder, "regions big.gpkg -o out.gpkg -q"), 120)[0] == 0
                    earlier = layers(folder / "out.gpkg")[1]
                # The layer of the first run is larger, so it starts first.
                feet = " --to-unit ft" if "feet" in kind else ""
                commands = [("densify big.gpkg -i 10 -o out.gpkg -q", "contours_10m"), (f"densify big.gpkg -i 20{feet} -o out.gpkg -q", "contours_20ft" if feet else "contours_20m")]
                start = time.monotonic()
                children = []
                for command, layer in commands:
                    children.append((started(program, folder, command), layer))
                    time.sleep(moments.uniform(0, 0.1))
                ends = [(finish(child, o.seconds), layer) for child, layer in children]
                taken = time.monotonic() - start
                why = fault_of(folder, ends, earlier)
            statuses = [status for (status, _), _ in ends]
            yield Row(name, why, max(statuses, key=lambda s: -1 if s is None else s), taken, "")
