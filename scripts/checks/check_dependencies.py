#!/usr/bin/env python3
"""Licences and sources of all crates in Cargo.lock.

    check_dependencies.py [--list]

Each crate must come from crates.io, and its licence must allow programs under MIT or Apache-2.0 to include it. --list prints
the crates by licence. Exit status 0: all may be used; 1: some may not.
"""
import argparse
import collections
import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).parents[2]
CRATES_IO = "registry+https://github.com/rust-lang/crates.io-index"
# The two last are licences of fonts that pictures are drawn with.
ALLOWED = {
    "0BSD", "Apache-2.0", "Apache-2.0 WITH LLVM-exception", "BSD-2-Clause", "BSD-3-Clause", "CC0-1.0", "ISC", "MIT", "Unicode-3.0",
    "Unlicense", "Zlib", "OFL-1.1", "Ubuntu-font-1.0",
}


def is_allowed(expression):
    """Whether one choice of each part is allowed. Choices that contain several licences at once are not understood: no."""
    parts = expression.replace("/", " OR ").split(" AND ")
    return all(any(choice.strip() in ALLOWED for choice in part.strip(" ()").split(" OR ")) for part in parts)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--list", action="store_true", help="print the crates by licence")
    args = parser.parse_args()
    command = ["cargo", "metadata", "--format-version", "1", "--locked", "--manifest-path", str(ROOT / "Cargo.toml")]
    packages = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["packages"]
    crates = [package for package in packages if package["source"]]
    if args.list:
        by_licence = collections.defaultdict(list)
        for crate in crates:
            by_licence[crate["license"] or "none is stated"].append(crate["name"])
        for licence, names in sorted(by_licence.items()):
            print(f"{licence}: {', '.join(names)}")
    faults = [f"{c['name']} {c['version']} comes from {c['source']}" for c in crates if c["source"] != CRATES_IO]
    faults += [
        f"{c['name']} {c['version']} has the licence {c['license']}" for c in crates if not is_allowed(c["license"] or "")
    ]
    for fault in faults:
        print(fault, file=sys.stderr)
    print(f"{len(crates)} crates, {len(faults)} that may not be used")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
