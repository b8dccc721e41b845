"""Values of options that are out of any proportion."""
from hostile_inputs.case import Case
from hostile_inputs.maps import collection, hill, putter

OPTIONS = [
    "dem hill.geojson --cell 0 -o out.tif", "dem hill.geojson --cell -5 -o out.tif", "dem hill.geojson --cell nan -o out.tif",
    "dem hill.geojson --cell inf -o out.tif", "dem hill.geojson --cell 1e-300 -o out.tif",
    "densify hill.geojson -i 0 -o out.gpkg", "densify hill.geojson -i 1e-300 -o out.gpkg", "densify hill.geojson -i nan -o out.gpkg",
    "densify hill.geojson -i 1e300 -o out.gpkg", "densify hill.geojson --levels 1e308 -o out.gpkg",
    "densify hill.geojson -i 5 --base 1e308 -o out.gpkg", "densify hill.geojson -i 5 --snap 1e300 -o out.gpkg",
    "densify hill.geojson -i 5 --fit 1e300 -o out.gpkg", "densify hill.geojson -i 5 --fit 1e-300 -o out.gpkg",
    "densify hill.geojson -i 5 --sample 1e-9 -o out.gpkg", "densify hill.geojson -i 5 --simplify 1e300 -o out.gpkg",
    "densify hill.geojson -i 5 --tension 1e300 -o out.gpkg", "densify hill.geojson -i 5 --sea 1e308 -o out.gpkg",
    "densify hill.geojson -i 5 --crs EPSG:2193 --to-crs EPSG:27700 -o out.gpkg", "densify hill.geojson -i 5 --crs (((( -o out.gpkg",
    "densify hill.geojson -i 5 --threads 1024 -o out.gpkg", "densify hill.geojson -i 5 --points hill.geojson -o out.gpkg",
    "densify hill.geojson -i 5 --water hill.geojson -o out.gpkg", "densify hill.geojson -i 5 --frame hill.geojson -o out.gpkg",
    "densify hill.geojson -i 5 --streams hill.geojson --stream-tolerance 1e300 -o out.gpkg",
    "densify hill.geojson -i 5 --streams hill.geojson --stream-tolerance 0 -o out.gpkg",
    "dem hill.geojson --cell 5 --drain all --sinks hill.geojson -o out.tif", "dem hill.geojson --cell 5 --points-sigma 1 -o out.tif",
    "dem hill.geojson --cell 5 --coast 1e308 -o out.tif", "dem hill.geojson --cell 5 --coast nan -o out.tif",
    "dem hill.geojson --cell 5 --base hill.geojson -o out.tif", "--run hill.geojson", "dem hill.geojson --cell 5 --save-run . -o out.tif",
    "skeleton hill.geojson --resolution 1e300 -o out.gpkg", "mesh hill.geojson --base 1e300 -o out.glb",
]  # fmt: skip


def cases():
    for command in OPTIONS:
        yield Case(f"options: {command}", putter(hill=collection(hill())), command)
