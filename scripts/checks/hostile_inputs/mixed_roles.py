"""One file in several roles that contradict each other, and all roles at once."""
from hostile_inputs.case import DEM, DENSIFY, Case
from hostile_inputs.maps import collection, hill, line, point, polygon, putter, ring

CROSS = [line([[-99, 0, 50], [99, 0, -50]], elev=15), line([[0, -99, 0], [0, 99, 40]], elev=25)]
MIXED = [*hill(), *CROSS, point(3, 4, elev=7), polygon(ring(45), elev=12)]
LINE_ROLES = ("--streams", "--breaklines", "--cliffs", "--coast", "--sinks")
AREA_ROLES = ("--water", "--exclude", "--frame", "--clip", "--sinks", "--coast", "--streams")
COMMANDS = {
    "contours as everything": "a.geojson " + " ".join(f"{role} a.geojson" for role in LINE_ROLES),
    "lines as all kinds of lines": "a.geojson " + " ".join(f"{role} cross.geojson" for role in LINE_ROLES),
    "areas as all kinds of areas": "a.geojson " + " ".join(f"{role} areas.geojson" for role in AREA_ROLES),
    "a mixture as everything": "mixed.geojson --points mixed.geojson " + " ".join(f"{role} mixed.geojson" for role in dict.fromkeys(LINE_ROLES + AREA_ROLES)),
    "a stream that is a cliff": "a.geojson --streams cross.geojson --cliffs cross.geojson",
    "a stream that is a break line with other heights": "a.geojson --streams cross.geojson --breaklines cross.geojson",
    "a cliff that is a coast": "a.geojson --cliffs a.geojson --coast a.geojson --frame bbox",
    "a lake that is left out": "a.geojson --water areas.geojson --exclude areas.geojson",
    "a lake that is a sink": "a.geojson --water areas.geojson --sinks areas.geojson --drain all",
    "a frame that is left out": "a.geojson --frame areas.geojson --exclude areas.geojson",
    "a part that is left out": "a.geojson --clip areas.geojson --exclude areas.geojson",
    "a part outside the frame": "a.geojson --frame areas.geojson --extent -99,-99,-80,-80",
    "a river area that is a lake": "a.geojson --streams areas.geojson --water areas.geojson",
    "a coast above all contours": "a.geojson --coast areas.geojson --sea 0",
    "a sea and a coast": "a.geojson --sea 0 --coast 0 --frame bbox",
    "break lines twice": "a.geojson --breaklines cross.geojson --breaklines cross.geojson",
    "the contours twice": "a.geojson a.geojson",
    "spot heights of contours": "a.geojson --points a.geojson --points-sigma 1e-9",
    "several roles in feet and metres": "a.geojson --unit ft --breaklines cross.geojson --water areas.geojson --to-unit us-ft",
}  # fmt: skip


def cases():
    write = putter(a=collection(hill()), cross=collection(CROSS), areas=collection([polygon(ring(45), elev=12)]), mixed=collection(MIXED))
    for name, inputs in COMMANDS.items():
        yield Case(f"mixed: {name}", write, DENSIFY.format(inputs))
        yield Case(f"mixed, dem: {name}", write, DEM.format(f"{inputs} --uncertainty"))
        if "--clip" not in inputs and "--extent" not in inputs and "--frame" not in inputs and "--sinks" not in inputs:
            yield Case(f"mixed, check: {name}", write, f"check {inputs} -o out.gpkg")
