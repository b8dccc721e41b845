#!/usr/bin/env python3
"""Fetches the libraries of the map page: MapLibre GL, and the reader of PMTiles.

    make_viewer_libraries.py

Writes src/draw/viewer/vendor from the packages of the npm registry, in the versions that stand here. The files are those of the
packages, but for the line that names a source map, and their licences in one file. npm is needed; nothing else is installed.
"""
import json
import pathlib
import re
import subprocess
import sys
import tarfile
import tempfile

VENDOR = pathlib.Path(__file__).resolve().parents[2] / "src" / "draw" / "viewer" / "vendor"
# Version 5 of MapLibre GL is one script; from 6 on, its worker is a second one, with most of the first in it.
PACKAGES = {
    "maplibre-gl": ("5.24.1", ["dist/maplibre-gl.js", "dist/maplibre-gl.css"], "LICENSE.txt"),
    "pmtiles": ("4.5.0", ["dist/pmtiles.js"], None),
    # Is inside pmtiles.js.
    "fflate": ("0.8.2", [], "LICENSE"),
}
# The package of pmtiles names its licence, BSD-3-Clause, and has no file with it.
BSD_3_CLAUSE = """Copyright 2021 Protomaps LLC

Redistribution and use in source and binary forms, with or without modification, are permitted provided that the following
conditions are met:

1. Redistributions of source code must retain the above copyright notice, this list of conditions and the following disclaimer.

2. Redistributions in binary form must reproduce the above copyright notice, this list of conditions and the following disclaimer
in the documentation and/or other materials provided with the distribution.

3. Neither the name of the copyright holder nor the names of its contributors may be used to endorse or promote products derived
from this software without specific prior written permission.

THIS SOFTWARE IS PROVIDED BY THE COPYRIGHT HOLDERS AND CONTRIBUTORS "AS IS" AND ANY EXPRESS OR IMPLIED WARRANTIES, INCLUDING, BUT
NOT LIMITED TO, THE IMPLIED WARRANTIES OF MERCHANTABILITY AND FITNESS FOR A PARTICULAR PURPOSE ARE DISCLAIMED. IN NO EVENT SHALL
THE COPYRIGHT HOLDER OR CONTRIBUTORS BE LIABLE FOR ANY DIRECT, INDIRECT, INCIDENTAL, SPECIAL, EXEMPLARY, OR CONSEQUENTIAL DAMAGES
(INCLUDING, BUT NOT LIMITED TO, PROCUREMENT OF SUBSTITUTE GOODS OR SERVICES; LOSS OF USE, DATA, OR PROFITS; OR BUSINESS
INTERRUPTION) HOWEVER CAUSED AND ON ANY THEORY OF LIABILITY, WHETHER IN CONTRACT, STRICT LIABILITY, OR TORT (INCLUDING NEGLIGENCE
OR OTHERWISE) ARISING IN ANY WAY OUT OF THE USE OF THIS SOFTWARE, EVEN IF ADVISED OF THE POSSIBILITY OF SUCH DAMAGE."""
SOURCE_MAP = re.compile(rb"\n//# sourceMappingURL=\S+\s*$")


def main():
    VENDOR.mkdir(parents=True, exist_ok=True)
    licences = []
    with tempfile.TemporaryDirectory() as folder:
        for name, (version, files, licence) in PACKAGES.items():
            command = ["npm", "pack", f"{name}@{version}", "--json", "--pack-destination", folder]
            packed = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
            packed = packed[0] if isinstance(packed, list) else next(iter(packed.values()))
            with tarfile.open(pathlib.Path(folder) / packed["filename"]) as archive:
                inside = {member.name.split("/", 1)[1]: member for member in archive.getmembers() if "/" in member.name}
                for path in files:
                    content = archive.extractfile(inside[path]).read()
                    check(path, content)
                    (VENDOR / pathlib.Path(path).name).write_bytes(SOURCE_MAP.sub(b"\n", content))
                text = archive.extractfile(inside[licence]).read().decode().strip() if licence else BSD_3_CLAUSE
            licences.append(f"{name} {version}\n\n{text}\n")
            print(f"{name} {version} {packed['integrity']}")
    (VENDOR / "LICENSES.txt").write_text(("\n" + "-" * 78 + "\n\n").join(licences), encoding="utf-8")


def check(path, content):
    """Refuses what cannot stand inside a page as it is."""
    for end in (b"</script", b"<!--", b"</style"):
        if end in content.lower():
            sys.exit(f"{path} has {end.decode()}, which would end its place in a page")


if __name__ == "__main__":
    sys.exit(main())
