"""Saved runs (`--run`) that are none, are broken, or ask for what must not be."""
import json
import os

from hostile_inputs.case import Case
from hostile_inputs.maps import collection, hill

DESCRIPTION = "run saved by tokosen"


def saved(**members):
    run = {
        "description": DESCRIPTION, "layout": 1, "version": "0.1.0", "arguments": ["dem", "hill.geojson", "--cell", "5", "-o", "out.tif"],
        "folder": ".", "inputs": [], "chosen": {},
    }  # fmt: skip
    return json.dumps({**run, **members})


def argued(*arguments):
    return saved(arguments=list(arguments))


def sparse(path, size=4 << 30):
    with open(path, "wb") as file:
        file.truncate(size)


TEXTS = {
    "empty": "",
    "no json": "dem hill.geojson",
    "a number": "1e999",
    "deep": "[" * 100_000 + "]" * 100_000,
    "of another program": json.dumps({"description": "run saved by another", "layout": 1}),
    "of no layout": json.dumps({"description": DESCRIPTION}),
    "of a later layout": saved(layout=2),
    "of layout 1e30": saved(layout=1e30),
    "without arguments": argued(),
    "arguments of numbers": saved(arguments=[1, 2, 3]),
    "arguments of help": argued("--help"),
    "arguments of a run": argued("--run", "run.json"),
    "arguments that save over the run": argued("dem", "hill.geojson", "--cell", "5", "-o", "out.tif", "--save-run", "run.json"),
    "arguments with zero bytes": argued("dem", "hill\0.geojson", "--cell", "5", "-o", "out.tif"),
    "a thousand arguments": argued("dem", *["hill.geojson"] * 1_000, "--cell", "5", "-o", "out.tif"),
    "a folder that is missing": saved(folder="/nowhere/at/all"),
    "a folder that is a file": saved(folder="hill.geojson"),
    "a folder that is a device": saved(folder="/dev/null"),
    "inputs that are missing": saved(inputs=[{"file": "gone.gpkg", "bytes": 1, "crc32": "00000000"}]),
    "inputs that are a device": saved(inputs=[{"file": "/dev/zero", "bytes": 1, "crc32": "00000000"}]),
    "inputs that are a folder": saved(inputs=[{"file": ".", "bytes": 1, "crc32": "00000000"}]),
    "inputs of negative size": saved(inputs=[{"file": "hill.geojson", "bytes": -1, "crc32": ""}]),
    "chosen of anything": saved(chosen={"tension": [{}], "": None}),
}
MUST_FAIL = ("device", "missing", "is a file", "no json", "empty", "deep", "another program", "layout", "numbers", "a run", "negative", "are a folder")


def cases():
    def put(text):
        def write(folder):
            (folder / "hill.geojson").write_text(collection(hill()))
            (folder / "run.json").write_text(text)

        return write

    for name, text in TEXTS.items():
        yield Case(f"run: {name}", put(text), "--run run.json", refused=any(words in name for words in MUST_FAIL))

    def fifo(folder):
        os.mkfifo(folder / "run.json")

    def listed(folder):
        put(saved(inputs=[{"file": "pipe.gpkg", "bytes": 1, "crc32": "00000000"}]))(folder)
        os.mkfifo(folder / "pipe.gpkg")

    quick = {"refused": True, "seconds": 10}
    yield Case("run: a pipe", fifo, "--run run.json", says="not an ordinary file", **quick)
    yield Case("run: an input that is a pipe", listed, "--run run.json", says="not an ordinary file", **quick)
    yield Case("run: a device", lambda folder: None, "--run /dev/zero", says="not an ordinary file", **quick)
    yield Case("run: no device", lambda folder: None, "--run /dev/null", says="not an ordinary file", **quick)
    yield Case("run: a folder", lambda folder: (folder / "run.json").mkdir(), "--run run.json", says="is a folder", **quick)
    yield Case("run: 4 GB", lambda folder: sparse(folder / "run.json"), "--run run.json", says="too large", **quick)
    yield Case("run: memory of this machine", lambda folder: None, "--run /proc/kcore", **quick)
