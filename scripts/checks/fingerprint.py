#!/usr/bin/env python3
"""Shows whether a change of the program changes any of its results.

    fingerprint.py record [-o RECORD] [--program TOKOSEN] [--maps FOLDER] [--only NAME] [--jobs N]
    fingerprint.py check  [-r RECORD] [--program TOKOSEN] [--maps FOLDER] [--only NAME] [--jobs N] [--texts-may-differ]

`record` runs a list of commands (fingerprint_commands.py) on samples/ and on small drawn maps that it writes itself. It
notes the exit status, the text on stdout and stderr, and the SHA-256 of every file that a command writes. `check` runs
them again and prints a line per difference from the record, for a text with the lines that differ. Build the program
before each.

Each command runs in an empty temporary folder, once with `--threads 1` and once with `--threads 2`. Both runs must give the
same. A command that ends with another exit status than the list states is a failure too, also in `record`, which then
writes nothing. In texts the seconds of the line "time", the temporary folder and the path of the program are masked.

Files are hashed as they are. The program writes no date and no random number to any format, and GeoPackages get a fixed
`last_change`. Only another version of a library that writes files, such as SQLite or zlib, may change bytes alone.

With --maps, each contour map of a folder (.gpkg, .geojson) goes through the main commands, on a grid of about half a
million cells and with new contours at half the vertical interval. A NAME.tif beside NAME.gpkg is the published height map.
It is compared with the contours, and a height map is made on its grid.

--texts-may-differ is for a change of wording: of stdout and stderr only the numbers are compared, in whatever order.
--only takes the commands with NAME in their name; `record` then keeps the others as they are in the record.

Exit status 0: nothing differs; 1: something does; 2: it could not run.
"""
import argparse
import concurrent.futures
import difflib
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

import fingerprint_commands as commands

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "target" / "release" / "tokosen"
RECORD = ROOT / "target" / "fingerprint.json"
LIMIT = 300  # seconds for one command


# ---- running


def masked(text, folder, program):
    """A text without what differs from run to run."""
    for path, word in ((folder, "FOLDER"), (folder.parent, "TEMPORARY"), (program, "PROGRAM")):
        for form in {str(path), os.path.realpath(path)}:
            text = text.replace(form, word)
    return re.sub(r"^time .*$", lambda line: re.sub(r"\d+\.\d+", "#", line[0]), text, flags=re.M)


def run(root, number, steps, threads, program):
    """The results of the commands of one entry: exit statuses, texts, hashes of files."""
    folder = root / f"{number}-{threads}"
    folder.mkdir()
    out = {"steps": steps, "status": [], "stdout": "", "stderr": "", "files": {}}
    # The user's settings and the width of the terminal must not matter.
    environment = {k: v for k, v in os.environ.items() if k != "COLUMNS" and not k.startswith(("RUST", "RAYON"))}
    for step in steps.split(" && "):
        try:
            # Called by its usual name, which it states in its help.
            told = subprocess.run(["tokosen", *shlex.split(step), "--threads", str(threads)], executable=program, cwd=folder,
                                  stdin=subprocess.DEVNULL, capture_output=True, env=environment, timeout=LIMIT)
        except subprocess.TimeoutExpired:
            out["status"].append(f"none after {LIMIT} s")
            break
        out["status"].append(told.returncode)
        for stream in ("stdout", "stderr"):
            out[stream] += masked(getattr(told, stream).decode(errors="replace"), folder, program)
    for path in sorted(p for p in folder.rglob("*") if p.is_file()):
        out["files"][path.relative_to(folder).as_posix()] = hashlib.sha256(path.read_bytes()).hexdigest()
        path.unlink()
    return out


def run_all(args):
    """The results of every command with one thread, and a line per failure."""
    listed = {name: (0, steps) for name, steps in commands.COMMANDS.items()} | commands.REFUSED
    with tempfile.TemporaryDirectory(prefix="fingerprint-") as held:
        root = pathlib.Path(held)
        (root / "drawn").mkdir()
        commands.draw(root / "drawn")
        (root / "samples").symlink_to(ROOT / "samples")
        if args.maps:
            (root / "maps").symlink_to(args.maps.resolve())
            for path in sorted(p for p in args.maps.iterdir() if p.suffix in (".gpkg", ".geojson")):
                listed |= {name: (0, steps) for name, steps in commands.of_map(path.resolve(), args.program, LIMIT).items()}
        chosen = [(name, *entry) for name, entry in listed.items() if args.only in name]
        with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
            runs = [[pool.submit(run, root, i, steps, threads, args.program) for threads in (1, 2)]
                    for i, (_, _, steps) in enumerate(chosen)]
            found, failures = {}, []
            for (name, status, steps), pair in zip(chosen, runs):
                one, two = (future.result() for future in pair)
                found[name] = one
                wanted = [0] * steps.count(" && ") + [status]
                if one["status"] != wanted:
                    failures.append(f"{name}: exit status {one['status']}, not {wanted}\n{indented(one['stderr'])}")
                failures += [f"1 and 2 threads: {line}" for line in differences(name, one, two, False)]
    return found, failures


# ---- comparing


def indented(text):
    return "\n".join("    " + line for line in text.splitlines())


def numbers(text):
    return sorted(re.findall(r"\d[\d.]*", text))


def differences(name, was, now, texts_may_differ):
    """A line for each thing that differs between two runs of a command, for a text with the lines that differ."""
    out = [f"{name}: {what} was {was[what]}, is {now[what]}" for what in ("steps", "status") if was[what] != now[what]]
    for file in sorted(was["files"].keys() | now["files"].keys()):
        old, new = was["files"].get(file), now["files"].get(file)
        if old != new:
            out.append(f"{name}: {file} {'is new' if old is None else 'is missing' if new is None else 'differs'}")
    for stream in ("stdout", "stderr"):
        old, new = was[stream], now[stream]
        if (numbers(old) != numbers(new)) if texts_may_differ else old != new:
            lines = difflib.unified_diff(old.splitlines(), new.splitlines(), lineterm="", n=0)
            out.append(f"{name}: {stream} differs\n{indented(chr(10).join(list(lines)[2:]))}")
    return out


def count(found):
    return f"{len(found)} commands, {sum(len(one['files']) for one in found.values())} files"


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    for verb, letter in (("record", "-o"), ("check", "-r")):
        options = verbs.add_parser(verb)
        options.add_argument(letter, dest="record", type=pathlib.Path, default=RECORD, help="(%(default)s)")
        options.add_argument("--program", type=pathlib.Path, default=PROGRAM, metavar="TOKOSEN", help="(%(default)s)")
        options.add_argument("--maps", type=pathlib.Path, metavar="FOLDER", help="further contour maps")
        options.add_argument("--only", default="", metavar="NAME", help="commands with this in their name")
        options.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="commands at a time (%(default)s)")
    options.add_argument("--texts-may-differ", action="store_true", help="compare files and the numbers in texts")
    args = parser.parse_args(arguments)
    args.program = args.program.resolve()
    if not os.access(args.program, os.X_OK):
        return trouble(f"{args.program}: no such program; build it with `cargo build --release`, or name it with --program")
    if args.maps and not args.maps.is_dir():
        return trouble(f"{args.maps}: no such folder")
    known = {}
    if args.verb == "check" or args.only and args.record.exists():
        try:
            known = json.loads(args.record.read_text(encoding="utf-8"))
        except (OSError, ValueError) as e:
            return trouble(f"{args.record}: {e}")
    found, failures = run_all(args)
    if not found:
        return trouble(f"no command has {args.only!r} in its name")
    if args.verb == "check":
        for name, now in found.items():
            was = known.get(name)
            failures += differences(name, was, now, args.texts_may_differ) if was else [f"{name}: not in the record"]
    print("".join(line + "\n" for line in failures), end="")
    if failures:
        print(f"{len(failures)} differences and failures among {count(found)}")
        return 1
    if args.verb == "record":
        args.record.parent.mkdir(parents=True, exist_ok=True)
        args.record.write_text(json.dumps(known | found, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        print(f"recorded {count(found)}")
    else:
        left = len(known.keys() - found.keys())
        print(f"{count(found)}: all as recorded" + (f"; {left} commands of the record were not run" if left else ""))
    return 0


def trouble(message):
    print(f"error: {message}", file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main())
