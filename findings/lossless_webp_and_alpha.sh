#!/usr/bin/env bash
# The good guess: a terrain tile (heights in the RGB of an image) saved as lossless WebP comes back with the same RGB, also where
#   alpha is 0 for "no data".
# What really happens: lossless WebP rewrites the RGB of fully transparent pixels to 0. A decoder of terrain tiles that does not
#   look at alpha (MapLibre GL) then reads -10000 m in Mapbox encoding: a sheer drop along every coast that was filled with 0 m.
#   Pillow (unless exact=True), sharp (unless exact: true) and the WEBP driver of GDAL do it. GDAL's own GeoTIFF with WebP
#   compression keeps the RGB.
# Version: Pillow 13.0.0, rasterio 1.4.4 (GDAL 3.10.3), sharp 0.35.5.
# Source: the option `exact` in the documentation of Pillow and of sharp. For the WEBP driver of GDAL we found no word of it.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
python3 -m venv venv
venv/bin/pip install -q pillow==13.0.0 rasterio==1.4.4 numpy==2.4.6
npm install --silent --no-fund --no-audit sharp@0.35.5
cat > sharp.mjs <<'JS'
import sharp from 'sharp';
const pixels = Buffer.alloc(8 * 8 * 4);
for (let i = 0; i < 64; i++) pixels.set([1, 134, 160, 0], i * 4);
for (const options of [{lossless: true}, {lossless: true, exact: true}]) {
  const webp = await sharp(pixels, {raw: {width: 8, height: 8, channels: 4}}).webp(options).toBuffer();
  const [r, g, b] = await sharp(webp).ensureAlpha().raw().toBuffer();
  console.log([r, g, b].join(' '));
}
JS
node sharp.mjs > sharp.txt
venv/bin/python -W ignore - <<'PY'
import io
import json
import sys
import numpy as np
import PIL
import rasterio
from PIL import Image

sharp_version = json.load(open("node_modules/sharp/package.json"))["version"]
print("Pillow", PIL.__version__, "rasterio", rasterio.__version__, "GDAL", rasterio.__gdal_version__, "sharp", sharp_version)
tile = np.zeros((8, 8, 4), "uint8")
tile[...] = (1, 134, 160, 0)  # 0 m in Mapbox encoding, transparent


def metres(rgb):
    r, g, b = (int(v) for v in rgb[:3])
    return round(-10000 + 0.1 * (r * 65536 + g * 256 + b), 1)


def pillow(**options):
    file = io.BytesIO()
    Image.fromarray(tile).save(file, "WEBP", lossless=True, **options)
    return np.array(Image.open(file).convert("RGBA"))[0, 0]


def gdal(name, driver, **options):
    with rasterio.open(name, "w", driver=driver, width=8, height=8, count=4, dtype="uint8", **options) as f:
        f.write(tile.transpose(2, 0, 1))
    with rasterio.open(name) as f:
        return f.read()[:, 0, 0]


lines = [[int(v) for v in line.split()] for line in open("sharp.txt")]
seen = {
    "Pillow": metres(pillow()),
    "Pillow, exact": metres(pillow(exact=True)),
    "sharp": metres(lines[0]),
    "sharp, exact": metres(lines[1]),
    "GDAL, WEBP driver": metres(gdal("a.webp", "WEBP", LOSSLESS="YES")),
    "GDAL, GeoTIFF": metres(gdal("a.tif", "GTiff", compress="webp", webp_lossless="YES")),
}
print("a transparent pixel of 0 m, read without its alpha:", seen)
ok = seen == {
    "Pillow": -10000.0,
    "Pillow, exact": 0.0,
    "sharp": -10000.0,
    "sharp, exact": 0.0,
    "GDAL, WEBP driver": -10000.0,
    "GDAL, GeoTIFF": 0.0,
}
sys.exit(0 if ok else "The behaviour has changed.")
PY
