"""Inputs and outputs that are no ordinary files: pipes, devices, sockets, folders, links; and disks that are full."""
import os
import socket
import subprocess

from hostile_inputs.case import DEM, DENSIFY, Case
from hostile_inputs.drawings import DXF_HILL, dxf
from hostile_inputs.maps import collection, hill
from hostile_inputs.rasters import ASC
from hostile_inputs.run_files import sparse
from hostile_inputs.shapefiles import GOOD, shapefile

QUICK = {"refused": True, "seconds": 20}
# A file in each role, and the command that reads it.
READ = {
    "a.geojson": DENSIFY.format("a.geojson"),
    "a.gpkg": DENSIFY.format("a.gpkg"),
    "a.fgb": DENSIFY.format("a.fgb"),
    "a.dxf": DENSIFY.format("a.dxf"),
    "a.shp": DENSIFY.format("a.shp"),
    "a.xml": DENSIFY.format("a.xml"),
    "a.zip": DENSIFY.format("a.zip"),
    "b.zip": "derive b.zip --slope out.tif",
    "a.tif": "derive a.tif --slope out.tif",
    "a.exr": "contour a.exr -i 5 -o out.gpkg",
    "a.png": "derive a.png --slope out.tif",
    "a.asc": "contour a.asc -i 5 -o out.gpkg",
    "spots.csv": DEM.format("hill.geojson --points spots.csv"),
    "spots.gpkg": DEM.format("hill.geojson --points spots.gpkg"),
    "rivers.gpkg": DEM.format("hill.geojson --streams rivers.gpkg"),
    "edges.dxf": DEM.format("hill.geojson --breaklines edges.dxf"),
    "cliffs.shp": DEM.format("hill.geojson --cliffs cliffs.shp"),
    "coast.fgb": DEM.format("hill.geojson --coast coast.fgb"),
    "quarry.geojson": DEM.format("hill.geojson --exclude quarry.geojson"),
    "sinks.geojson": DEM.format("hill.geojson --sinks sinks.geojson"),
    "base.tif": DEM.format("hill.geojson --base base.tif"),
    "like.tif": "dem hill.geojson --like like.tif -o out.tif",
    "like.asc": "dem hill.geojson --like like.asc -o out.tif",
    "truth.tif": "compare hill.geojson truth.tif -o out.tif",
}
# Files beside an input that are read with it.
BESIDE = {
    "a.dbf": DENSIFY.format("a.shp"), "a.shx": DENSIFY.format("a.shp"), "a.prj": DENSIFY.format("a.shp"), "a.cpg": DENSIFY.format("a.shp"),
    "b.prj": "derive b.asc --slope out.tif", "b.asc.aux.xml": "derive b.asc --slope out.tif",
}  # fmt: skip
WRITTEN = {
    "out.gpkg": "densify hill.geojson -i 5 -o out.gpkg",
    "out.geojson": "densify hill.geojson -i 5 -o out.geojson",
    "out.fgb": "densify hill.geojson -i 5 -o out.fgb",
    "out.dxf": "densify hill.geojson -i 5 -o out.dxf",
    "out.shp": "densify hill.geojson -i 5 -o out.shp",
    "out.dbf": "densify hill.geojson -i 5 -o out.shp",
    "out.tif": DEM.format("hill.geojson"),
    "out.asc": "dem hill.geojson --cell 5 -o out.asc",
    "out.exr": "dem hill.geojson --cell 5 -o out.exr",
    "out.xyz": "dem hill.geojson --cell 5 -o out.xyz",
    "out.png": "derive hill.geojson --cell 5 --hillshade out.png",
    "out.html": "compare hill.geojson b.asc --report out.html",
    "out.json": "check hill.geojson --save-run out.json",
    "out.glb": "mesh hill.geojson -o out.glb",
    "out.diagnostics.gpkg": DEM.format("hill.geojson --diagnostics out.diagnostics.gpkg"),
    "out.preview.png": DEM.format("hill.geojson --preview out.preview.png"),
}


def base(folder):
    """Inputs that are sound."""
    (folder / "hill.geojson").write_text(collection(hill()))
    (folder / "b.asc").write_text(ASC.format(40, 40, 5, "15 " * 1600))
    shapefile(folder / "a.shp", shapes=GOOD)


def pipe(path):
    os.mkfifo(path)


def a_socket(path):
    held = socket.socket(socket.AF_UNIX)
    # The path of a socket is short.
    where = os.open(path.parent, os.O_RDONLY)
    held.bind(f"/proc/self/fd/{where}/{path.name}")
    os.close(where)
    return held


def endless(path):
    os.symlink("/dev/zero", path)


def circle(path):
    os.symlink(path.name, path)


def nowhere(path):
    os.symlink("/nowhere/at/all", path)


def protected(path):
    path.write_text("earlier")
    path.chmod(0o444)


def with_one(make, name):
    def write(folder):
        base(folder)
        (folder / name).unlink(missing_ok=True)
        return make(folder / name)

    return write


def full_disk(name):
    """A disk with little room, in which there is a file of that name. None if that is not allowed here."""

    def write(folder):
        base(folder)
        disk = folder / "disk"
        disk.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=8k", "tmpfs", disk], capture_output=True).returncode == 0
        (disk / name).write_text("earlier")

        class Disk:
            def close(self):
                if mounted:
                    subprocess.run(["umount", disk], check=True)

        return Disk()

    return write


def is_mountable():
    """Whether this user may mount a disk."""
    found = subprocess.run(["unshare", "-m", "true"], capture_output=True).returncode == 0
    return found and os.geteuid() == 0


def earlier_alone(name):
    def look(folder):
        names = [path.name for path in (folder / "disk").iterdir()]
        if names != [name] or (folder / "disk" / name).read_text() != "earlier":
            return f"the disk has {names}"

    return look


def cases():
    for name, command in {**READ, **BESIDE}.items():
        yield Case(f"place: a pipe, {name}", with_one(pipe, name), command, says="not an ordinary file", **QUICK)
        yield Case(f"place: a device, {name}", with_one(endless, name), command, says="not an ordinary file", **QUICK)
    for name, command in READ.items():
        yield Case(f"place: a socket, {name}", with_one(a_socket, name), command, says="not an ordinary file", **QUICK)
        yield Case(f"place: a link to itself, {name}", with_one(circle, name), command, **QUICK)
        yield Case(f"place: 4 GB of zeros, {name}", with_one(sparse, name), command, refused=True)
        yield Case(f"place: a folder, {name}", with_one(lambda path: path.mkdir(), name), command, **QUICK)
    for name, command in BESIDE.items():
        yield Case(f"place: 4 GB of zeros, {name}", with_one(sparse, name), command)
    for name, command in WRITTEN.items():
        for kind, make in {"a pipe": pipe, "a device": endless, "a socket": a_socket}.items():
            for overwrite in ("", " --overwrite"):
                case = Case(f"place: written to {kind}, {name}{overwrite}", with_one(make, name), command + overwrite, keeps=(name,), **QUICK)
                yield case._replace(says="not an ordinary file")
        folder = with_one(lambda path: path.mkdir(), name)
        yield Case(f"place: written to a folder, {name}", folder, f"{command} --overwrite", says="is a folder", keeps=(name,), **QUICK)
        yield Case(f"place: written to a protected file, {name}", with_one(protected, name), f"{command} --overwrite", says="write-protected", keeps=(name,), **QUICK)
        yield Case(f"place: written to a link to nowhere, {name}", with_one(nowhere, name), f"{command} --overwrite")
        full = Case(f"place: a file of 100 bytes at most, {name}", base, f"{command} --overwrite", file_size=100, refused=True)
        yield full
        if is_mountable() and name not in ("out.dbf", "out.json"):  # a run file is smaller than the disk
            moved = command.replace(" out.", " disk/out.") + " --overwrite"
            yield Case(f"place: a full disk, {name}", full_disk(name), moved, refused=True, look=earlier_alone(name))
    yield Case("place: written to a folder that is missing", base, "densify hill.geojson -i 5 -o gone/out.gpkg", **QUICK)
    yield Case("place: written to a name of 300 letters", base, f"densify hill.geojson -i 5 -o out.{'a' * 300}.gpkg", **QUICK)
    yield Case("place: written below a file", base, "densify hill.geojson -i 5 -o b.asc/out.gpkg", **QUICK)
    yield Case("place: written over a sound input", base, "dem b.asc --cell 5 -o b.asc --overwrite", keeps=("b.asc",), **QUICK)
    drawn = lambda folder: (folder / "a.dxf").write_text(dxf(DXF_HILL))  # noqa: E731
    yield Case("place: written over the drawing that is read", drawn, "densify a.dxf -i 5 -o a.dxf --overwrite", keeps=("a.dxf",), **QUICK)
    yield Case("place: a hidden folder with a pipe for a lock", abandoned, DENSIFY.format("hill.geojson"), seconds=20)


def abandoned(folder):
    base(folder)
    (folder / ".tokosen-abc").mkdir()
    os.mkfifo(folder / ".tokosen-abc" / ".lock")
    os.utime(folder / ".tokosen-abc" / ".lock", (0, 0))
