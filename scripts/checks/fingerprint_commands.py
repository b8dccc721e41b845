"""The commands that fingerprint.py runs, and the small maps that it draws for them.

Only the standard library is used. The maps are the same on every machine: numbers are rounded, because the last digit of
a sine may differ.
"""
import json
import math
import pathlib
import shlex
import sqlite3
import subprocess
import zipfile

CELLS = 500_000  # of a grid over a map of a folder

# Paths are relative to the folder of a command.
REAL, TRUTH = "../samples/caryville_20m.gpkg", "../samples/caryville_20m_truth.tif"
HILL, FAULTY = "../drawn/hill.geojson", "../drawn/faulty.geojson"
FEATURES = "--points ../drawn/spots.geojson --water ../drawn/lakes.geojson --sea 0"
LINES = "--streams ../drawn/streams.geojson --breaklines ../drawn/edges.geojson"
CNTR, DEM5A = "../drawn/FG-GML-543745-Cntr.zip", "../drawn/FG-GML-5437-45-44-DEM5A.xml"

# Name and command. Commands joined by && run one after the other in one folder.
COMMANDS = {
    "densify gpkg preview": f"densify {REAL} -i 5 -o a.gpkg --preview a.png",
    "densify several intervals, dem": f"densify {REAL} -i 10,5 -o a.gpkg --dem a.tif --cell 20",
    "densify skeleton surface": f"densify {REAL} --surface skeleton -i 5 -o a.gpkg --dem a.tif --like {TRUTH}",
    "densify linear surface": f"densify {REAL} --surface linear -i 5 -o a.gpkg --dem a.tif --cell 30",
    "densify uncertainty": f"densify {REAL} --uncertainty -i 10 -o a.gpkg --dem a.exr --cell 30 --preview a.png",
    "densify fit": f"densify {REAL} --fit 3 -i 10 -o a.gpkg",
    "densify sample": f"densify {REAL} --sample 0.5 -i 10 -o a.gpkg",
    "densify fit and sample": f"densify {HILL} --fit 2 --sample 0.3 -i 5 -o a.gpkg",
    "densify frame bbox": f"densify {REAL} --frame bbox -i 10 -o a.gpkg",
    "densify frame polygon": f"densify {REAL} --frame ../drawn/sheet.geojson -i 10 -o a.gpkg --dem a.tif --cell 30",
    "densify compare": f"densify {REAL} -i 10 -o a.gpkg --compare {TRUTH} --report a.html",
    "densify levels and index": f"densify {HILL} --levels 12.5,13,41 -o a.gpkg"
                                f" && densify {HILL} -i 4 --base 1 --index 3 -o b.gpkg",
    "densify formats": " && ".join(f"densify {HILL} -i 5,2 -o a.{end}"
                                   for end in ("geojson", "shp", "fgb", "dxf")),
    "densify reads formats": f"densify {HILL} -i 5 -o a.shp && densify a.shp -i 2 -o b.fgb && densify b.fgb -i 2 -o c.dxf"
                             " && densify c.dxf --crs EPSG:6678 -i 2 -o d.gpkg"
                             " && densify d.gpkg --layer contours_2m -a elev -i 1 -o e.gpkg",
    "densify water, sea and spots": f"densify {HILL} {FEATURES} -i 2 -o a.gpkg --dem a.tif --cell 5 --preview a.png",
    "densify degrees": "densify ../drawn/degrees.geojson -i 5 -o a.geojson && densify ../drawn/degrees.geojson -i 5 -o b.gpkg"
                       " --to-crs EPSG:6678 --work-crs EPSG:32654 --points ../drawn/spots.geojson",
    "densify feet": "densify ../drawn/feet.geojson --unit us-ft -i 1 -o a.gpkg",
    "densify gsi": f"densify {CNTR} -i 5 -o a.gpkg --compare {DEM5A} --report a.html --water ../drawn/FG-GML-543745-WA.xml -v",
    "densify repair": " && ".join(f"densify {FAULTY} --repair {how} -i 5 -o {how}.gpkg" for how in ("safe", "all")),
    "densify part and labels": f"densify {REAL} -i 5 --extent 745000,4018000,749000,4021000 --labels -o a.gpkg --preview a.png"
                               f" && densify {REAL} -i 10 --clip ../drawn/sheet.geojson --labels=40 -o a.dxf",
    "densify sheets": f"densify {REAL} -i 20 --extent 744000,4015000,749000,4025000 -o west.shp"
                      f" && densify {REAL} -i 20 --extent 749000,4015000,755000,4025000 -o east.shp"
                      " && densify west.shp east.shp -i 10 -o a.gpkg",
    "densify coarser": f"densify {REAL} -i 100 -o a.gpkg && densify {REAL} -i 100 --keep-input -o b.gpkg",
    "dem cell, verbose": f"dem {REAL} --cell 10 -o a.tif -v",
    "dem like": f"dem {REAL} --like {TRUTH} -o a.tif --preview a.png",
    "dem degrees": f"dem {REAL} --cell-degrees 1s -o a.tif && dem ../drawn/degrees.geojson --cell 5 -o b.tif",
    "dem in another system": f"dem {REAL} --to-crs EPSG:3857 --cell 20 --uncertainty --cog -o a.tif"
                             f" && densify {HILL} -i 5 --to-crs EPSG:3857 -o b.gpkg --dem b.tif --cell 20",
    "dem uncertainty": f"dem {REAL} --cell 20 --uncertainty -o a.tif",
    "dem tension and noise": f"dem {REAL} --cell 30 --tension 1 --noise 0.5 -o a.tif",
    "dem skeleton surface": f"dem {REAL} --surface skeleton --resolution 2 --uncertainty --cell 30 -o a.tif",
    "dem linear surface": f"dem {REAL} --surface linear --uncertainty --cell 30 -o a.tif",
    "dem formats": " && ".join(f"dem {HILL} --cell 20 -o a.{end}" for end in ("exr", "png", "asc", "xyz"))
                   + "".join(f" && dem {HILL} --cell 20 --png-encoding {code} -o {code}.png"
                             for code in ("gsi", "terrarium", "mapbox")) +
                   f" && dem {HILL} --cell 20 --uncertainty -o errors.exr",
    "dem water, sea and spots": f"dem {HILL} {FEATURES} --cell 5 -o a.tif --uncertainty && "
                                f"dem {HILL} {FEATURES} --surface skeleton --cell 5 --frame bbox -o b.tif",
    "dem streams and break lines": f"dem {HILL} {LINES} --cell 5 -o a.tif --diagnostics a.gpkg && "
                                   f"dem {FAULTY} {LINES} --cell 5 -o b.tif && dem {HILL} {LINES} --to-crs EPSG:3857 --cell 8 -o c.tif",
    "densify streams and break lines": f"densify {HILL} {LINES} --points ../drawn/spots.geojson -i 2 -o a.gpkg",
    "dem gsi": f"dem {CNTR} --like {DEM5A} -o a.tif",
    "dem repair": f"dem {FAULTY} --repair all --cell 5 -o a.tif -v",
    "dem quiet": f"dem {HILL} --cell 10 -o a.tif -q",
    "contour": f"contour {TRUTH} -i 10 --labels -o a.gpkg --preview a.png && contour {TRUTH} -i 20,5 --smooth 60 -o b.geojson"
               f" && contour {DEM5A} -i 1 --to-crs EPSG:6677 -o c.fgb",
    "derive dem": f"derive {TRUTH} --slope a.tif --aspect a.asc --hillshade a.png --steep a.gpkg --steep-angle 20",
    "derive contours": f"derive {REAL} --cell 20 --slope a.exr --hillshade b.tif --steep a.geojson",
    "derive light": f"derive {TRUTH} --hillshade a.tif --multidirectional --cog && "
                    f"derive {TRUTH} --hillshade b.png --azimuth 30 --altitude 60 --z-factor 2",
    "derive gsi": f"derive {DEM5A} --slope a.tif --aspect b.png --steep a.shp --steep-angle 3 --steep-height 1",
    "derive flow": f"derive {TRUTH} --flow-direction a.tif --flow-accumulation b.tif --catchments a.gpkg && "
                   f"derive {TRUTH} --outlet 752685,4024000 --catchments c.gpkg --stream-lines d.shp --threshold 500000 && "
                   f"derive {TRUTH} --flow-accumulation e.tif --accumulation-unit m2",
    "derive flood": f"derive {TRUTH} --flood a.tif --flood-level 320 && "
                    f"derive {TRUTH} --flood b.geojson --flood-level +3 --threshold 500000",
    "mesh glb preview": f"mesh {REAL} -o a.glb --preview a.png",
    "mesh surfaces and base": f"mesh {REAL} --surface skeleton --base 0 -o a.ply && mesh {HILL} --surface linear -o a.obj",
    "mesh water and spots": f"mesh {HILL} {FEATURES} -o a.ply",
    "compare report": f"compare {REAL} {TRUTH} --report a.html --sigma 5 -o a.tif",
    "compare json": f"compare {REAL} {TRUTH} --json --surface skeleton",
    "compare two maps": f"compare {REAL} {REAL} --cell 30 --json && compare {HILL} ../drawn/degrees.geojson --cell 20",
    "compare formats": " && ".join(f"dem {HILL} --cell 20 -o a.{end} && compare a.{end} {HILL} --points ../drawn/spots.geojson"
                                   for end in ("exr", "png", "asc")),
    "compare gsi": f"compare {CNTR} {DEM5A} --json",
    "check sound": f"check {REAL} && check {REAL} --json --strict",
    "check faults": f"check {FAULTY} -v --points ../drawn/spots.geojson -o a.gpkg && check {FAULTY} --json"
                    f" && check {FAULTY} -o a.geojson",
    "check repair": " && ".join(f"check {FAULTY} --repair {how} --points ../drawn/spots.geojson -o {how}.gpkg"
                                for how in ("safe", "all")) + f" && check {FAULTY} --repair all -o all.geojson",
    "check gsi": f"check {CNTR} --json",
    "regions preview": f"regions {REAL} -o a.gpkg --preview a.png",
    "regions formats": " && ".join(f"regions {HILL} {FEATURES} -o a.{end}" for end in ("geojson", "shp", "fgb", "dxf")),
    "regions figures": " && ".join(f"regions ../samples/fig{name}.geojson -o {name}.geojson" for name in (
        "1a_one_to_one", "1c_many_convolutions", "1e_three_branches", "1f_nested", "5cd_three_branches_basin")),
    "skeleton layers": f"skeleton {REAL} -o a.gpkg --triangles --curve-mesh --preview a.png",
    "skeleton formats": " && ".join(f"skeleton {HILL} {FEATURES} --resolution 0.7 -o a.{end}"
                                    for end in ("geojson", "shp", "fgb", "dxf")),
    "skeleton figures": " && ".join(f"skeleton ../samples/fig{name}.geojson -o {name}.geojson --triangles" for name in (
        "1b_one_convolution", "1d_two_branches_one_convolution", "2_triangles", "3a_spur", "3b_three_arms",
        "5ab_two_branches_ridges_canyon", "6_ridge")),
    "help": "--version && --help && " + " && ".join(f"{verb} --help" for verb in (
        "densify", "dem", "derive", "mesh", "compare", "check", "regions", "skeleton", "plan", "work", "join")),
}

# Commands that have to stop, with their exit status.
REFUSED = {
    "check strict": (1, f"check {FAULTY} --strict"),
    "densify repair none": (1, f"densify {FAULTY} --repair none -i 5 -o a.gpkg"),
    "dem strict": (1, f"dem {FAULTY} --strict --cell 5 -o a.tif"),
    "no such file": (1, "densify none.gpkg -i 5 -o a.gpkg"),
    "no elevation": (1, "dem ../drawn/sheet.geojson --cell 5 -o a.tif"),
    "no such layer": (1, f"dem {REAL} --layer roads --cell 5 -o a.tif"),
    "no overlap": (1, f"dem {HILL} --like {TRUTH} -o a.tif"),
    "no polygon": (1, f"dem {HILL} --frame {HILL} --cell 5 -o a.tif"),
    "usage: no coordinate system": (2, "dem ../drawn/unknown.geojson --cell-degrees 1s -o a.tif"),
    "usage: no interval": (2, f"densify {HILL} -o a.gpkg"),
    "usage: no grid": (2, f"dem {HILL} -o a.tif"),
    "usage: format": (2, f"mesh {HILL} -o a.tif"),
    "usage: output is input": (2, f"dem {HILL} --like a.tif -o a.tif"),
    "usage: contradiction": (2, f"derive {TRUTH} --crs EPSG:6678 --slope a.tif"),
    "usage: value": (2, f"dem {HILL} --tension -1 --cell 5 -o a.tif"),
    "usage: sea": (2, f"dem {HILL} --sea 5 --cell 5 -o a.tif"),
    "usage: unknown option": (2, "dem --wrong"),
}


# ---- drawn maps


def ring(x, y, radius, swell=0.12):
    """A closed line about a point, with three spurs."""
    turns = [2 * math.pi * k / 60 for k in range(60)]
    reach = [radius * (1 + swell * math.cos(3 * a)) for a in turns]
    points = [(x + r * math.cos(a), y + r * math.sin(a)) for a, r in zip(turns, reach)]
    return points + points[:1]


def hill():
    """Lines of an island with two tops, one of them with a hollow, as elevation and points in metres."""
    lines = [(0, ring(0, 0, 1000)), (10, ring(0, 0, 850)), (20, ring(0, 0, 700)), (30, ring(0, 0, 560))]
    lines += [(level, ring(-230, 0, radius)) for level, radius in ((40, 200), (50, 130), (60, 70))]
    return lines + [(level, ring(240, 40, radius)) for level, radius in ((40, 210), (50, 150), (50, 80), (40, 40))]


def faulty():
    """The lines of the hill with faults of most kinds."""
    lines = [(level, list(points)) for level, points in hill()]
    lines[2] = (90, lines[2][1])  # a wrong elevation
    lines[1] = (10, lines[1][1][12:] + lines[1][1][1:10])  # a gap
    spike = lines[3][1]
    spike[20:20] = [spike[19], (spike[19][0] - 40, spike[19][1] + 9), spike[19]]
    lines[8][1][5] = (600, 300)  # strays across its neighbours
    lines[0][1][-1] = (lines[0][1][0][0] + 0.004, lines[0][1][0][1])  # a ring that is not quite closed
    lines.append(lines[7])  # twice
    lines.append((500, [(-1100, 3), (-800, 5)]))  # across others
    lines.append((None, [(0, -400), (50, -380)]))  # no elevation
    lines.append((30, [(10, 10)]))  # a point
    return lines[:5] + lines[6:]  # a level is missing


def geojson(path, features, epsg):
    """Writes features, each a geometry's type, its coordinates and its elevation."""
    crs = {"crs": {"type": "name", "properties": {"name": f"urn:ogc:def:crs:EPSG::{epsg}"}}} if epsg else {}
    rows = [{"type": "Feature", "properties": {} if z is None else {"elev": z}, "geometry": {"type": kind, "coordinates": at}}
            for kind, at, z in features]
    path.write_text(json.dumps({"type": "FeatureCollection", **crs, "features": rows}), encoding="utf-8")


def draw(folder):
    """Writes all drawn maps."""
    # The last digits of sines are not the same everywhere, hence the rounding.
    plane = lambda points: [(round(x - 12000, 3), round(y + 34000, 3)) for x, y in points]
    feet = lambda points: [(round(3 * x + 990000, 2), round(3 * y + 200000, 2)) for x, y in points]
    degrees = lambda points: [(round(140.7 + x / 90000, 9), round(40.3 + y / 111000, 9)) for x, y in points]
    lines = lambda bring, rows: [("LineString", bring(points), level) for level, points in rows]
    geojson(folder / "hill.geojson", lines(plane, hill()), 6678)
    geojson(folder / "faulty.geojson", lines(plane, faulty()), 6678)
    geojson(folder / "feet.geojson", lines(feet, hill()), 2263)
    geojson(folder / "unknown.geojson", lines(feet, hill()), 999999)
    solid = [("LineString", [(*p, level) for p in degrees(points)], None) for level, points in hill()]
    geojson(folder / "degrees.geojson", solid, None)
    spots = [(-230, 0, 64.5), (240, 40, 36), (20, 5, 33.5), (0, 620, 99), (150, -780, 14.25)]
    geojson(folder / "spots.geojson", [("Point", plane([(x, y)])[0], z) for x, y, z in spots], 6678)
    lakes = [([ring(0, -775, 50, 0), ring(5, -775, 15, 0)[::-1]], 14), ([ring(240, 40, 18)], None), ([ring(0, 700, 40)], None)]
    geojson(folder / "lakes.geojson", [("Polygon", [plane(r) for r in rings], z) for rings, z in lakes], 6678)
    # Two streams in the valleys of the hill, one of them drawn uphill, and one across a slope; an edge with heights.
    way = lambda turn, radii: [(r * math.cos(math.radians(turn)), r * math.sin(math.radians(turn))) for r in radii]
    streams = [way(60, range(520, 1001, 40)), way(182, range(960, 500, -40)), [(900, 100), (600, 500), (100, 760)]]
    geojson(folder / "streams.geojson", lines(plane, [(None, points) for points in streams]), 6678)
    edge = [(*p, z) for p, z in zip(plane(way(120, (600, 680, 760, 840))), (28.5, 22.25, 15, 12))]
    geojson(folder / "edges.geojson", [("LineString", edge, None)], 6678)
    sheet = [(746000, 4016500), (753500, 4017000), (754000, 4022000), (749000, 4024000), (745500, 4021000), (746000, 4016500)]
    geojson(folder / "sheet.geojson", [("Polygon", [sheet], None)], 32616)
    gsi(folder)


def gsi(folder):
    """Writes the hill at two fifths of its size, its spot heights, a lake and a height map as 基盤地図情報."""
    place = lambda x, y: f"{36.370833333 + 0.4 * y / 111000:.9f} {137.68125 + 0.4 * x / 90000:.9f}"
    listed = lambda points: "<gml:posList>" + "\n".join(place(x, y) for x, y in points) + "</gml:posList>"
    curve = lambda points: (
        f"<gml:segments><gml:LineStringSegment>{listed(points)}</gml:LineStringSegment></gml:segments></gml:Curve>")
    system = 'srsName="fguuid:jgd2011.bl"'
    dataset = lambda members: (
        '<?xml version="1.0" encoding="UTF-8"?>\n<Dataset xmlns="http://fgd.gsi.go.jp/spec/2008/FGD_GMLSchema" '
        f'xmlns:gml="http://www.opengis.net/gml/3.2" gml:id="D">\n{members}\n</Dataset>\n')
    contours = "".join(
        f'<Cntr gml:id="C{i}"><fid>{i}</fid><loc><gml:Curve gml:id="g{i}" {system}>{curve(points)}</loc>'
        f"<type>{'凹地等高線' if i > 8 else '一般等高線'}</type><alti>{level}</alti></Cntr>\n"
        for i, (level, points) in enumerate(hill()))
    spot = (f'<ElevPt gml:id="E"><fid>e</fid><pos><gml:Point gml:id="p" {system}><gml:pos>{place(-230, 0)}</gml:pos>'
            "</gml:Point></pos><type>標高点（測点）</type><alti>64.5</alti></ElevPt>")
    with zipfile.ZipFile(folder / pathlib.Path(CNTR).name, "w") as archive:
        archive.writestr("FG-GML-543745-Cntr-20160401-0001.xml", dataset(contours))
        archive.writestr("FG-GML-543745-ElevPt-20160401-0001.xml", dataset(spot))
    lake = (f'<WA gml:id="w"><fid>w</fid><area><gml:Surface gml:id="s" {system}><gml:patches><gml:PolygonPatch>'
            f'<gml:exterior><gml:Ring><gml:curveMember><gml:Curve gml:id="r">{curve(ring(240, 40, 20))}</gml:curveMember>'
            "</gml:Ring></gml:exterior></gml:PolygonPatch></gml:patches></gml:Surface></area><type>湖池</type></WA>")
    (folder / "FG-GML-543745-WA.xml").write_text(dataset(lake), encoding="utf-8")
    # Metres from the middle at full size.
    reach = lambda row, column: math.hypot((column - 112) * 12.5, (row - 74.5) * 15.4)
    cells = [60 * (1 - reach(row, column) / 1000) for row in range(150) for column in range(225)]
    tuples = "".join(f"地表面,{z:.2f}\n" if z > -20 else "データなし,-9999.\n" for z in cells[3:])
    (folder / pathlib.Path(DEM5A).name).write_text(dataset(
        '<DEM gml:id="M"><fid>m</fid><lfSpanFr gml:id="a"><gml:timePosition>2016-10-01</gml:timePosition></lfSpanFr>'
        '<type>5mメッシュ（標高）</type><mesh>54374544</mesh><coverage gml:id="b"><gml:boundedBy>'
        f"<gml:Envelope {system}><gml:lowerCorner>36.366666667 137.675</gml:lowerCorner>"
        "<gml:upperCorner>36.375 137.6875</gml:upperCorner>"
        '</gml:Envelope></gml:boundedBy><gml:gridDomain><gml:Grid dimension="2" gml:id="c"><gml:limits><gml:GridEnvelope>'
        "<gml:low>0 0</gml:low><gml:high>224 149</gml:high></gml:GridEnvelope></gml:limits>"
        "<gml:axisLabels>x y</gml:axisLabels></gml:Grid></gml:gridDomain>"
        '<gml:rangeSet><gml:DataBlock><gml:rangeParameters><gml:QuantityList uom="DEM構成点"/></gml:rangeParameters>'
        f"<gml:tupleList>\n{tuples}</gml:tupleList></gml:DataBlock></gml:rangeSet><gml:coverageFunction><gml:GridFunction>"
        '<gml:sequenceRule order="+x-y">Linear</gml:sequenceRule><gml:startPoint>3 0</gml:startPoint></gml:GridFunction>'
        "</gml:coverageFunction></coverage></DEM>"), encoding="utf-8")


# ---- maps of a folder


def extent(path):
    """Width and height of the box around a map, in its own units, and whether those are degrees."""
    if path.suffix == ".gpkg":
        with sqlite3.connect(f"{path.as_uri()}?mode=ro", uri=True) as db:
            boxes = db.execute("SELECT min_x, min_y, max_x, max_y FROM gpkg_contents WHERE data_type = 'features'").fetchall()
    else:
        boxes = []
        features = json.loads(path.read_text(encoding="utf-8"))["features"]
        stack = [feature["geometry"]["coordinates"] for feature in features if feature["geometry"]]
        while stack:
            at = stack.pop()
            if at and isinstance(at[0], list):
                stack.extend(at)
            elif at:
                boxes.append((*at[:2], *at[:2]))
    west, south, east, north = (pick(column) for pick, column in zip((min, min, max, max), zip(*boxes)))
    return east - west, north - south, max(map(abs, (west, south, east, north))) <= 360


def of_map(path, program, limit):
    """The main commands for one map."""
    width, height, degrees = extent(path)
    cell = float(f"{math.sqrt(width * height / CELLS) * (100_000 if degrees else 1):.2g}")
    told = subprocess.run([program, "check", path, "--json"], capture_output=True, stdin=subprocess.DEVNULL, timeout=limit)
    step = (json.loads(told.stdout or "{}").get("interval") or 20) / 2
    here, name = shlex.quote(f"../maps/{path.name}"), path.stem
    commands = {
        f"{name} dem": f"dem {here} --cell {cell:g} --uncertainty -o a.tif",
        f"{name} densify": f"densify {here} -i {step:g} -o a.gpkg",
        f"{name} check": f"check {here} --json",
        f"{name} skeleton": f"skeleton {here} -o a.gpkg",
        f"{name} regions": f"regions {here} -o a.gpkg",
    }
    published = path.with_suffix(".tif")
    if published.exists():
        there = shlex.quote(f"../maps/{published.name}")
        commands[f"{name} compare"] = f"compare {here} {there} --report a.html"
        commands[f"{name} like"] = f"dem {here} --like {there} -o a.tif"
    return commands
