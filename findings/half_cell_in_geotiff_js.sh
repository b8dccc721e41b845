#!/usr/bin/env bash
# The good guess: GDAL and geotiff.js agree on where a GeoTIFF DEM lies. The box that geotiff.js returns is that of rasterio.
# What really happens: for a file whose cells are points (GTRasterTypeGeoKey 2, usual for DEMs), the stored tie point is the centre of
#   the first cell. GDAL takes half a cell off. getBoundingBox and getOrigin of geotiff.js do not, though pixelIsArea() says
#   false: the DEM lies half a cell to the south-east. The same DEM with cells as areas agrees.
# Version: rasterio 1.4.4 (GDAL 3.10.3), geotiff 3.0.5 (npm).
# Source: undocumented for geotiff.js as far as we found. GDAL describes its side in RFC 33.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
python3 -m venv venv
venv/bin/pip install -q rasterio==1.4.4 numpy==2.4.6
npm install --silent --no-fund --no-audit geotiff@3.0.5
cat > box.mjs <<'JS'
import {fromFile} from 'geotiff';
const image = await (await fromFile(process.argv[2])).getImage();
console.log(JSON.stringify([image.getBoundingBox(), image.pixelIsArea()]));
process.exit(0);
JS
venv/bin/python -W ignore - <<'PY'
import json
import subprocess
import sys
import numpy as np
import rasterio
from rasterio.transform import from_origin

npm_version = json.load(open("node_modules/geotiff/package.json"))["version"]
print("rasterio", rasterio.__version__, "GDAL", rasterio.__gdal_version__, "geotiff.js", npm_version)
seen = {}
for kind in ("Area", "Point"):
    name = f"{kind}.tif"
    with rasterio.open(name, "w", driver="GTiff", width=4, height=4, count=1, dtype="float32", crs="EPSG:6677",
                       transform=from_origin(0, 40, 10, 10)) as f:
        f.update_tags(AREA_OR_POINT=kind)
        f.write(np.zeros((4, 4), "float32"), 1)
    with rasterio.open(name) as f:
        ours = list(f.bounds)
    js = subprocess.run(["node", "box.mjs", name], check=True, capture_output=True, text=True).stdout
    theirs, is_area = json.loads(js)
    print(f"{kind}: rasterio {ours}, geotiff.js {theirs}, pixelIsArea {is_area}")
    seen[kind] = ours, theirs, is_area
ok = (
    seen["Area"] == ([0, 0, 40, 40], [0, 0, 40, 40], True)
    and seen["Point"] == ([0, 0, 40, 40], [5, -5, 45, 35], False)
)
sys.exit(0 if ok else "The behaviour has changed.")
PY
