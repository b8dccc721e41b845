"""Runs the program on a hostile input, and judges the run."""
import hashlib
import os
import resource
import stat
import subprocess
import tempfile
import time
from pathlib import Path
from typing import NamedTuple


class Outcome(NamedTuple):
    status: int | None  # None: it took too long
    said: str
    seconds: float


class Row(NamedTuple):
    """A line of the table."""

    name: str
    fault: str | None
    status: int | None
    seconds: float
    said: str


def limited(gigabytes, file_size=None):
    """Sets the limits in the process that becomes the program."""

    def limit():
        size = int(gigabytes * 2**30)
        resource.setrlimit(resource.RLIMIT_AS, (size, size))
        if file_size is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (file_size, file_size))

    return limit


def run(program, folder, command, seconds, gigabytes, file_size=None):
    started = time.monotonic()
    child = subprocess.Popen(
        [program, *command.split()], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        preexec_fn=limited(gigabytes, file_size),
    )  # fmt: skip
    try:
        said = child.communicate(timeout=seconds)[1].decode(errors="replace")
    except subprocess.TimeoutExpired:
        child.kill()
        child.communicate()
        return Outcome(None, "", seconds)
    return Outcome(child.returncode, said, time.monotonic() - started)


def state(path):
    """What changes if a file is written or replaced. The file is not opened: that would end locks on it."""
    meta = path.lstat()
    return stat.S_IFMT(meta.st_mode), meta.st_size, meta.st_mtime_ns, meta.st_ino


def states(folder):
    return {path.name: state(path) for path in folder.iterdir()}


def fault_of(outcome, case, before, after):
    """Why a run is bad; None if it is not."""
    status, said = outcome.status, outcome.said
    changed = {name for name in after if after[name] != before.get(name)}
    outputs = {name for name in changed if name.startswith("out.")}
    left = {name for name in after if name not in before} - outputs
    if status is None:
        return "took too long"
    if status < 0:
        return f"ended by signal {-status}"
    if status not in (0, 1, 2) or "panicked" in said:
        return f"status {status}: {said.strip()[-80:]}"
    if status and not said.strip().splitlines()[-1:]:
        return "failed without a message"
    if status and "error: " not in said:
        return "failed without an error"
    if status == 0 and case.refused:
        return "was not refused"
    if status == 0 and not outputs and " out." in case.command:
        return "succeeded without an output"
    if status and outputs:
        return f"failed, but wrote {', '.join(sorted(outputs))}"
    if status and case.says not in said:
        return f"does not say {case.says!r}: {said.strip().splitlines()[-1][-90:]}"
    lost = [name for name in case.keeps if before.get(name) != after.get(name)]
    if lost:
        return f"changed {', '.join(lost)}"
    return f"left {', '.join(sorted(left))}" if left else None


def row_of(program, case, seconds, gigabytes):
    """Runs a case in a folder of its own."""
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        held = case.write(folder)
        before = states(folder)
        outcome = run(program, folder, case.command, case.seconds or seconds, gigabytes, case.file_size)
        why = fault_of(outcome, case, before, states(folder)) or case.look(folder)
        if hasattr(held, "close"):
            held.close()
    return Row(case.name, why, outcome.status, outcome.seconds, outcome.said)


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.exists() else None


def environment_of_tests():
    """Few threads, so that a run that is to be killed lasts a while."""
    return {**os.environ, "RAYON_NUM_THREADS": "1"}
