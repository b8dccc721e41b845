#!/usr/bin/env python3
"""Makes the zip of the QGIS plugin. The same files give the same bytes.

    make_qgis_plugin.py                                    # target/tokosen_qgis.zip
    make_qgis_plugin.py --program target/release/tokosen   # with the program in it, for one operating system
"""
import argparse
import pathlib
import re
import sys
import tomllib
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PLUGIN = ROOT / "src" / "qgis" / "tokosen"
KINDS = {".py", ".svg", ".txt"}
TIME = (1980, 1, 1, 0, 0, 0)  # the first that a zip can hold


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, help="the program to put into the plugin")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=ROOT / "target" / "tokosen_qgis.zip")
    args = parser.parse_args()
    if args.program and not args.program.is_file():
        sys.exit(f"{args.program}: no such file")
    args.output.parent.mkdir(parents=True, exist_ok=True)
    write(args.output, version(), args.program)
    print(args.output)


def write(path, version, program):
    with zipfile.ZipFile(path, "w") as archive:
        for file in sorted(file for file in PLUGIN.rglob("*") if file.suffix in KINDS):
            content = file.read_bytes()
            if file.name == "metadata.txt":
                content = with_version(content, version)
            add(archive, f"tokosen/{file.relative_to(PLUGIN).as_posix()}", content, 0o644)
        for name in ("LICENSE-APACHE", "LICENSE-MIT"):
            add(archive, f"tokosen/{name}", (ROOT / name).read_bytes(), 0o644)
        if program:
            name = "tokosen.exe" if program.suffix == ".exe" else "tokosen"
            add(archive, f"tokosen/bin/{name}", program.read_bytes(), 0o755)


def add(archive, name, content, mode):
    entry = zipfile.ZipInfo(name, TIME)
    entry.create_system = 3  # Unix, so that the mode counts
    entry.external_attr = (0o100000 | mode) << 16
    entry.compress_type = zipfile.ZIP_DEFLATED
    archive.writestr(entry, content, compresslevel=9)


def version():
    """The version in Cargo.toml."""
    return tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]["version"]


def with_version(metadata, version):
    replaced, count = re.subn(rb"^version=.*$", f"version={version}".encode(), metadata, flags=re.MULTILINE)
    if count != 1:
        sys.exit(f"metadata.txt has {count} lines with the version")
    return replaced


if __name__ == "__main__":
    main()
