#!/usr/bin/env python3
"""Builds wheels of the Python package.

    build_wheels.py [--target TRIPLE] [--zig] [--profile PROFILE] [-o FOLDER]

Without arguments: a wheel for this machine, with full optimisation, in target/wheels. It runs on Linux with a C library as new as
that of this machine, and newer ones. --zig makes it run on older ones too (manylinux 2014), with the C compiler of zig.

For another machine, its target must be installed (`rustup target add TRIPLE`):

    aarch64-unknown-linux-gnu    Linux on ARM: --zig
    x86_64-pc-windows-msvc       Windows; maturin fetches the Windows SDK with xwin
    universal2-apple-darwin      macOS, both processors: on a Mac, or elsewhere --zig with SDKROOT naming a macOS SDK

The wheel for this machine is what CI builds and tests (--profile dev). The others are built with the same commands of maturin, on
machines that have these targets. They were not run when this was written.

maturin is installed in an environment of its own, target/maturin.
"""
import argparse
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
MATURIN = "maturin==1.16.0"
ZIG = "ziglang==0.15.1"


def environment(packages):
    """An environment with maturin; gives the folder of its programs."""
    folder = ROOT / "target" / "maturin"
    programs = folder / ("Scripts" if sys.platform == "win32" else "bin")
    python = programs / "python"
    if not python.with_suffix(".exe" if sys.platform == "win32" else "").exists():
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    subprocess.run([python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *packages], check=True)
    return programs


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--target", help="the machine that the wheel is for")
    parser.add_argument("--zig", action="store_true", help="link with zig, for older C libraries and other machines")
    parser.add_argument("--profile", default="release", help="the profile of cargo (release)")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=ROOT / "target" / "wheels")
    arguments = parser.parse_args()
    programs = environment([MATURIN, ZIG] if arguments.zig else [MATURIN])
    command = [programs / "maturin", "build", "--locked", "--profile", arguments.profile, "--out", arguments.output]
    command += ["--manifest-path", ROOT / "src" / "python" / "Cargo.toml"]
    if arguments.target:
        command += ["--target", arguments.target]
    if arguments.zig:
        command += ["--zig", "--compatibility", "manylinux2014"]
    elif arguments.profile == "dev":
        # Such a wheel is tested on this machine only.
        command += ["--compatibility", "linux"]
    done = subprocess.run(list(map(str, command)), env=with_path(programs))
    sys.exit(done.returncode)


def with_path(programs):
    """The environment variables, with the programs of maturin's environment first: it calls zig by its name."""
    return {**os.environ, "PATH": f"{programs}{os.pathsep}{os.environ.get('PATH', '')}"}


if __name__ == "__main__":
    main()
