"""Finds the program tokosen and runs it: its progress, findings and errors become those of Processing."""
import contextlib
import json
import os
import pathlib
import queue
import shlex
import shutil
import subprocess
import sys
import sysconfig
import threading

from processing.core.ProcessingConfig import ProcessingConfig
from qgis.core import QgsProcessingException

SETTING = "TOKOSEN_PROGRAM"
NAME = "tokosen.exe" if os.name == "nt" else "tokosen"
BUNDLED = pathlib.Path(__file__).parent / "bin" / NAME
NOT_FOUND = (
    "The program tokosen was not found. Install it with pip or cargo, or name it in "
    "Settings > Options > Processing > Providers > tokosen."
)
# Time between two looks at the cancel button, and how long a cancelled program may take to remove its files [s].
TICK = 0.1
PATIENCE = 10


def find():
    """Path of the program. Raises a QgsProcessingException that says what to do if there is none."""
    named = ProcessingConfig.getSetting(SETTING)
    if named:
        if os.path.isfile(named):
            return named
        raise QgsProcessingException(f"The setting of the provider names the program {named}, which is not there.")
    if BUNDLED.is_file():
        # The plugin manager unpacks files without their permission to run.
        if not os.access(BUNDLED, os.X_OK):
            with contextlib.suppress(OSError):
                BUNDLED.chmod(0o755)
        return str(BUNDLED)
    found = shutil.which("tokosen", path=os.pathsep.join(folders()))
    if not found:
        raise QgsProcessingException(NOT_FOUND)
    return found


def folders():
    """Where the program may be, in this order."""
    user_scheme = "nt_user" if os.name == "nt" else "posix_user"
    home = pathlib.Path.home()
    return [
        # Where pip writes programs: beside QGIS's Python, and for the user.
        sysconfig.get_path("scripts"),
        os.path.join(sys.prefix, "Scripts" if os.name == "nt" else "bin"),
        sysconfig.get_path("scripts", user_scheme),
        *os.environ.get("PATH", os.defpath).split(os.pathsep),
        # A program that is started from a desktop may have a shorter PATH than a shell.
        str(home / ".cargo" / "bin"),
        str(home / ".local" / "bin"),
        "/usr/local/bin",
        "/opt/homebrew/bin",
    ]


def command_line(arguments):
    """The command as it could be typed into a shell."""
    line = ["tokosen", *arguments]
    return subprocess.list2cmdline(line) if os.name == "nt" else " ".join(map(shlex.quote, line))


def run(program, arguments, feedback):
    """Runs the program to its end, and returns its summary; None if the user cancelled.

    Raises a QgsProcessingException with the program's own sentence if it fails.
    """
    process = start([program, *arguments, "--progress", "json"])
    summary, told = [], queue.Queue()
    readers = [
        threading.Thread(target=lambda: summary.append(process.stdout.read()), daemon=True),
        threading.Thread(target=pass_on, args=(process.stderr, told), daemon=True),
    ]
    for reader in readers:
        reader.start()
    try:
        lines = follow(told, feedback)
        if lines is None:
            return None
        status = process.wait()
    finally:
        stop(process)
        for reader in readers:
            reader.join()
        process.stdout.close()
        process.stderr.close()
    findings, error = split(lines)
    for finding in findings:
        feedback.pushWarning(finding)
    if "unexpected argument '--progress'" in error:
        raise QgsProcessingException(f"The program {program} is too old for this plugin. Install a newer one.")
    if status != 0:
        raise QgsProcessingException(error or f"The program tokosen ended with status {status} and said nothing.")
    return "".join(summary).rstrip()


def start(line):
    try:
        return subprocess.Popen(
            line,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            errors="replace",
            # On Windows, no console window opens.
            creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
        )
    except OSError as error:
        raise QgsProcessingException(f"The program {line[0]} cannot be started: {error}")


def pass_on(stream, told):
    """Puts the lines of a stream into a queue, and None at its end."""
    for line in stream:
        told.put(line.rstrip("\n"))
    told.put(None)


def follow(told, feedback):
    """Shows the progress until the program closes its standard error. Returns its other lines; None if cancelled."""
    lines, last_step, share = [], "", 0.0
    while not feedback.isCanceled():
        try:
            line = told.get(timeout=TICK)
        except queue.Empty:
            continue
        if line is None:
            return lines
        progress = progress_of(line)
        if progress is None:
            lines.append(line)
            continue
        share = max(share, progress["progress"])
        feedback.setProgress(100 * share)
        step = progress.get("step")
        if step and step != last_step:
            feedback.setProgressText(step[0].upper() + step[1:])
            last_step = step
    return None


def progress_of(line):
    """The progress that a line states; None if it is no such line."""
    if not line.startswith('{"progress"'):
        return None
    try:
        return json.loads(line)
    except ValueError:
        return None


def split(lines):
    """Findings, each with its indented lines, and the text of the error; that of wrong usage ends at an empty line."""
    findings, error = [], None
    for line in lines:
        if error is not None:
            error.append(line)
        elif line.startswith("error: "):
            error = [line[len("error: "):]]
        elif line.startswith(" ") and findings:
            findings[-1] += "\n" + line
        elif line.strip():
            findings.append(line)
    return findings, "\n".join(error or []).split("\n\n")[0].strip()


def stop(process):
    """Ends the program if it runs. On Unix it removes its unfinished files first."""
    if process.poll() is not None:
        return
    process.terminate()
    try:
        process.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
