#!/usr/bin/env python3
"""Bundles the library of the page of a terrain: the parts of three.js that the page uses.

    make_page_library.py

Writes src/draw/terrain_page/vendor with npm and esbuild, in the versions that stand here: one script, without what the page does
not use, and the licence. The page finds the parts in the object THREE.
"""
import pathlib
import subprocess
import sys
import tempfile

VENDOR = pathlib.Path(__file__).resolve().parents[2] / "src" / "draw" / "terrain_page" / "vendor"
THREE, ESBUILD = "0.187.0", "0.28.2"
PARTS = {
    "three": """BufferAttribute BufferGeometry Color DataTexture DoubleSide FloatType GLSL3 Group LinearFilter Mesh PerspectiveCamera
        PlaneGeometry RedFormat RGBAFormat Scene ShaderMaterial UnsignedByteType Vector2 Vector3 WebGLRenderer""",
    "three/addons/controls/MapControls.js": "MapControls",
    "three/addons/lines/LineMaterial.js": "LineMaterial",
    "three/addons/lines/LineSegments2.js": "LineSegments2",
    "three/addons/lines/LineSegmentsGeometry.js": "LineSegmentsGeometry",
}


def main():
    VENDOR.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        subprocess.run(["npm", "install", "--silent", "--prefix", folder, f"three@{THREE}", f"esbuild@{ESBUILD}"], check=True)
        entry, bundle = folder / "entry.js", folder / "three.js"
        entry.write_text("".join(f"export {{ {', '.join(parts.split())} }} from '{module}';\n" for module, parts in PARTS.items()))
        subprocess.run(
            [folder / "node_modules/.bin/esbuild", entry, "--bundle", "--minify", "--format=iife", "--global-name=THREE", "--legal-comments=none",
             "--charset=ascii", "--target=es2020", "--log-level=warning", f"--outfile={bundle}"], check=True)
        script = bundle.read_text()
        licence = (folder / "node_modules/three/LICENSE").read_text().strip()
    for end in ("</script", "<!--", "</style"):
        if end in script.lower():
            sys.exit(f"three.js has {end}, which would end its place in a page")
    (VENDOR / "three.js").write_text(script)
    (VENDOR / "LICENSES.txt").write_text(f"three {THREE}\n\n{licence}\n")
    print(f"three {THREE}: {len(script)} bytes")


if __name__ == "__main__":
    sys.exit(main())
