"""GeoPackages that another program holds, or left half written."""
import pathlib
import shutil
import sqlite3

from hostile_inputs.case import DEM, DENSIFY, Case
from hostile_inputs.geopackages import gpkg
from hostile_inputs.maps import collection, hill

LOCKED = "is locked by another program"


class Held:
    """An open transaction on a file."""

    def __init__(self, path, begin):
        self.db = sqlite3.connect(path, isolation_level=None)
        self.db.executescript(begin)

    def close(self):
        self.db.rollback()
        self.db.close()


def held(name, begin):
    def write(folder):
        (folder / "hill.geojson").write_text(collection(hill()))
        gpkg(folder / name, b"")
        return Held(folder / name, begin)

    return write


def half_written(name, mode="delete"):
    """A file whose writer was killed: half of the changes are in it, and the journal beside it has the rest."""

    def write(folder):
        (folder / "hill.geojson").write_text(collection(hill()))
        working = folder.with_name(folder.name + "-working") / name
        working.parent.mkdir()
        gpkg(working, b"", more="CREATE TABLE notes (text TEXT);")
        db = sqlite3.connect(working, isolation_level=None)
        db.executescript(f"PRAGMA journal_mode = {mode}; PRAGMA cache_size = 2; BEGIN;")
        db.executemany("INSERT INTO notes VALUES (?)", [("note " * 50,)] * 3000)
        db.execute("DELETE FROM lines")
        for path in working.parent.iterdir():
            shutil.copy(path, folder / path.name)
        db.close()
        shutil.rmtree(working.parent)

    return write


def is_whole(name):
    """The layer of the other program is as it was before."""

    def look(folder):
        db = sqlite3.connect(pathlib.Path(folder) / name)
        try:
            lines, notes = (db.execute(f"SELECT count(*) FROM {table}").fetchone()[0] for table in ("lines", "notes"))
            sound = db.execute("PRAGMA integrity_check").fetchone()[0]
        except sqlite3.Error as e:
            return f"the layers of the other program are gone: {e}"
        finally:
            db.close()
        if (lines, notes, sound) != (4, 0, "ok"):
            return f"{lines} lines and {notes} notes are there, {sound}"

    return look


def cases():
    out = "densify hill.geojson -i 5 -o out.gpkg"
    for kind, begin in {"BEGIN EXCLUSIVE": "BEGIN EXCLUSIVE;", "an exclusive locking mode": "PRAGMA locking_mode = EXCLUSIVE; BEGIN EXCLUSIVE;"}.items():
        case = Case(f"lock: an output, {kind}", held("out.gpkg", begin), out, refused=True, says=LOCKED, keeps=("out.gpkg",), seconds=40)
        yield case
        yield case._replace(name=f"lock: an output to overwrite, {kind}", command=f"{out} --overwrite")
        for role in ("--points", "--streams", "--breaklines", "--cliffs", "--coast", "--exclude", "--water"):
            command = DEM.format(f"hill.geojson {role} a.gpkg")
            yield Case(f"lock: {role}, {kind}", held("a.gpkg", begin), command, refused=True, says=LOCKED, keeps=("a.gpkg",), seconds=40)
        yield Case(f"lock: an input, {kind}", held("a.gpkg", begin), DENSIFY.format("a.gpkg"), refused=True, says=LOCKED, keeps=("a.gpkg",), seconds=40)
    # Others may read while a program is about to write.
    yield Case("lock: an input, BEGIN IMMEDIATE", held("a.gpkg", "BEGIN IMMEDIATE;"), DENSIFY.format("a.gpkg"), keeps=("a.gpkg",))
    yield Case("lock: an output, BEGIN IMMEDIATE", held("out.gpkg", "BEGIN IMMEDIATE;"), out, refused=True, says=LOCKED, keeps=("out.gpkg",))
    yield Case("lock: an output that is read", held("out.gpkg", "BEGIN; SELECT count(*) FROM lines;"), out)
    for mode in ("delete", "wal", "truncate", "persist"):
        yield Case(f"lock: a half-written output, {mode}", half_written("out.gpkg", mode), out, look=is_whole("out.gpkg"))
        yield Case(f"lock: a half-written output to overwrite, {mode}", half_written("out.gpkg", mode), f"{out} --overwrite", look=is_whole("out.gpkg"))
        yield Case(f"lock: a half-written input, {mode}", half_written("a.gpkg", mode), DENSIFY.format("a.gpkg"), look=is_whole("a.gpkg"))
