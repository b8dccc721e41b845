"""Runs tokosen on a map, and counts what does not hold."""
import subprocess

import numpy as np

from . import checks

COLUMNS = [
    "moved", "crossings", "band", "holes", "spots", "lake", "sheets", "rises", "coast", "base", "threads", "warned", "failed",
]  # fmt: skip
SECONDS = 300


def run(program, folder, *command):
    """The exit status. What a run without success said is kept in its folder."""
    command = [str(c) for c in command]
    done = subprocess.run([str(program), *command, "-q"], cwd=folder, capture_output=True, text=True, timeout=SECONDS, check=False)
    if done.returncode:
        with (folder / "said.txt").open("a") as said:
            said.write(f"tokosen {' '.join(command)}\n{done.stderr}\n")
    return done.returncode


def from_parent(folder, words):
    """Words of a command that runs in a folder inside this one."""
    return [f"../{word}" if (folder / word).exists() else word for word in map(str, words)]


def counted(program, folder, found):
    counts = dict.fromkeys(COLUMNS, 0)
    lines, levels, inputs = found.lines, found.levels, found.inputs
    spacing = found.ground.interval
    for step in range(found.steps):
        spacing /= 2.0
        name = f"out{step}.gpkg"
        command = ["densify", *from_parent(folder, [*inputs, *found.options]), "-i", repr(spacing * found.unit), "-o", name]
        if step == 0:
            command += ["--dem", "out.tif", "--like", "../ground.tif"]
        for threads in (1, 2) if step == 0 else (2,):
            made = folder / f"threads{threads}"
            made.mkdir(exist_ok=True)
            status = run(program, made, *command, "--threads", threads, *(["--strict"] if threads == 1 else []))
            # With --strict, a warning ends the run with status 1.
            if status == 1 and threads == 1:
                counts["warned"] += 1
                status = run(program, made, *command, "--threads", threads)
            if status:
                counts["failed"] += 1
                return counts
        out_lines, out_levels = checks.read_lines(folder / "threads2" / name)
        out_levels = in_unit(found, out_levels)
        counts["moved"] += checks.moved(lines, levels, out_lines, out_levels, found.original if step == 0 else None)
        counts["crossings"] += checks.crossings(out_lines, out_levels) + checks.loops(out_lines)
        if step == 0:
            counts["threads"] += unlike_files(folder)
            counts["failed"] += sum(run(program, folder, *command) != 0 for command in found.runs)
            if counts["failed"]:
                return counts
            count_heights(counts, folder, found)
        lines, levels, inputs = out_lines, out_levels, [f"threads2/{name}"]
    return counts


def in_unit(found, levels):
    """Levels in the unit of the ground, those of the input exactly."""
    if found.unit == 1.0:
        return levels
    levels = levels / found.unit
    given = np.round(levels / found.ground.interval) * found.ground.interval
    return np.where(np.abs(levels - given) < checks.SHARE * found.ground.interval, given, levels)


def unlike_files(folder):
    names = [path.name for path in (folder / "threads2").iterdir() if path.name != "said.txt"]
    return sum((folder / "threads1" / name).read_bytes() != (folder / "threads2" / name).read_bytes() for name in names)


def count_heights(counts, folder, found):
    z = checks.read_heights(folder / "threads2" / "out.tif") / found.unit
    counts["band"] += checks.out_of_band(found, z)
    counts["holes"] += checks.holes(found, z)
    counts["spots"] += checks.spots_missed(found, z)
    counts["lake"] += checks.below_lake(found, z)
    for column, check in found.checks.items():
        counts[column] += check(found, folder, z)
