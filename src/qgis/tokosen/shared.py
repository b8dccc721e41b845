"""Options that several tools have."""
from .options import (
    ANY,
    LINES,
    POINTS,
    POLYGONS,
    choice,
    crs,
    distance,
    extent,
    field,
    file_output,
    layer,
    layers,
    number,
    raster,
    text,
    vector_output,
    yes,
)

PICTURE = "PNG files (*.png)"
PAGE = "HTML files (*.html)"
TABLE = "CSV files (*.csv)"
PAPER = "PDF files (*.pdf);;SVG files (*.svg)"
CHART = "SVG files (*.svg);;PNG files (*.png)"

INPUT = layer("", "Contour lines", LINES, name="INPUT", optional=False)
ELEVATION = field(
    "--elevation-field",
    "Elevation field",
    "INPUT",
    help="The field that holds the elevation. If it is empty, a field with a usual name is used (elev, height, ...), "
    "otherwise the z coordinate.",
)
CONTOURS = [INPUT, ELEVATION]

POINTS_WITH_HEIGHT = layer(
    "--points", "Spot heights", POINTS, help="The surface passes through these points. They have a height field, or z."
)
SIGMA = number(
    "--points-sigma",
    "Standard error of the spot heights",
    advanced=True,
    help="The surface then comes near the points instead of passing through them. A field named sigma gives each point its own.",
)
EXCLUDE = layers(
    "--exclude",
    "Leave out contours inside these polygons",
    POLYGONS,
    advanced=True,
    help="Contours and spot heights inside the polygons do not count, for instance of a quarry. The surface bridges the hole.",
)
CLIFFS = layers("--cliffs", "Cliffs", LINES, advanced=True, help="Lines across which the surface may jump.")
COAST = layer(
    "--coast",
    "Coast",
    ANY,
    advanced=True,
    help="Lines of the coast, or polygons of land or sea. The sea becomes level.",
)
COAST_LEVEL = number(
    "--coast",
    "Elevation of the contours that are the coast",
    name="COAST_LEVEL",
    unless=["COAST"],
    advanced=True,
    help="Use it where contours are the coast, for instance those at 0.",
)
UNIT = choice(
    "--unit",
    "Unit of the elevations",
    [("", "That of the layer, otherwise metres"), ("m", "Metres"), ("ft", "International feet"), ("us-ft", "US survey feet")],
    advanced=True,
)
PLANE_UNIT = choice(
    "--plane-unit",
    "Unit of x and y of contours without a coordinate reference system",
    [
        ("", "That of the drawing, otherwise metres"),
        ("m", "Metres"),
        ("ft", "International feet"),
        ("us-ft", "US survey feet"),
    ],
    advanced=True,
    help="The result comes back in this unit. Contours with a coordinate reference system have its unit.",
)
DEPTHS = yes("--depths", "Read depths as negative elevations", advanced=True)
WORK_CRS = crs(
    "--work-crs",
    "Projected system to work in",
    advanced=True,
    help="A system in metres. If it is empty, that of the contours is used; for degrees and feet, the zone of the map.",
)
SNAP = distance(
    "--snap", "Join line ends up to this distance", default=0.01, advanced=True, help="Ends of lines of one elevation are joined."
)
REPAIR = choice(
    "--repair",
    "Repair of the contours",
    [
        ("safe", "Safe: what cannot change the meaning of the map"),
        ("none", "None: stop if anything needs repair"),
        ("all", "All: also elevations, gaps and stray vertices"),
    ],
    advanced=True,
)
STRICT = yes("--strict", "Stop if there is an error or a warning about the contours", advanced=True)
FIT = distance(
    "--fit",
    "Smooth the contours within this tolerance",
    advanced=True,
    help="The vertices of the contours are then not kept.",
)
SAMPLE = number(
    "--sample",
    "Add vertices to the contours: spacing by distance",
    advanced=True,
    help="Vertices are added until their spacing is at most this share of the distance to the nearest other contour. It is "
    "below 1. The vertices of the contours stay.",
)

WATER = layer(
    "--water",
    "Lakes",
    POLYGONS,
    help="Polygons that are level, at their elevation field or z, otherwise at the height of their shore. Holes are islands.",
)
SEA = number(
    "--sea",
    "Level of the sea",
    advanced=True,
    help="Ground that reaches down only to contours of this level becomes level sea.",
)
STREAMS = layers(
    "--streams",
    "Streams",
    ANY,
    help="Lines of rivers and streams, or polygons of wide rivers. The surface falls along them. Contours count more.",
)
STREAM_TOLERANCE = distance(
    "--stream-tolerance",
    "Move streams up to this distance into the bends of contours",
    advanced=True,
    help="If it is empty, a quarter of the mean spacing of the contours.",
)
BREAK_LINES = layers(
    "--breaklines",
    "Break lines",
    ANY,
    help="Lines along which the ground bends sharply, such as edges of ditches. Lines with z give heights. A field kind = "
    "ridge, valley or edge says how the ground bends.",
)
SINKS = layers(
    "--sinks",
    "Sinks, where water may stay",
    ANY,
    advanced=True,
    help="Points or polygons, for instance in karst or quarries. A point keeps the pit that holds it, a polygon all inside.",
)
DRAIN = choice(
    "--drain",
    "Pits that get a way out",
    [("safe", "Pits that no contour speaks for"), ("none", "None: pits stay"), ("all", "All, except in sinks and in water")],
    advanced=True,
)
FRAME = choice(
    "--frame",
    "Outer border",
    [
        ("auto", "Convex hull, or an outline of the contours where these fill less than a third of it"),
        ("hull", "Convex hull of the contours"),
        ("bbox", "Bounding box of the contours"),
    ],
    unless=["FRAME_LAYER"],
    advanced=True,
)
FRAME_LAYER = layer("--frame", "Polygon as outer border", POLYGONS, name="FRAME_LAYER", advanced=True)
NO_EXTEND = yes("--no-extend", "No heights in the polygon outside the convex hull of the contours", advanced=True)
SURFACE_KIND = choice(
    "--surface",
    "Surface",
    [
        ("spline", "Smooth"),
        ("skeleton", "Plane triangles with ridge and canyon lines"),
        ("linear", "Plane triangles of the contours alone"),
    ],
    advanced=True,
)
RESOLUTION = number(
    "--resolution", "Resolution w: a larger value gives fewer ridge and canyon lines", default=1, advanced=True
)
TENSION = number(
    "--tension",
    "Tension of the smooth surface",
    advanced=True,
    help="0 is minimum curvature; 10 and more is nearly plane triangles. If it is empty, it is chosen from the contours.",
)
NOISE = number(
    "--noise",
    "Noise of the contours",
    advanced=True,
    help="0 for smooth contours, 1 for those with jitter. If it is empty, it is chosen from the contours.",
)

EXTENT = extent("--extent", "Extent", help="Only this part of the map is written. The contours around it still count.")
CLIP = layer(
    "--clip",
    "Clip to polygons",
    POLYGONS,
    advanced=True,
    help="Only the part inside is written. The contours around it still count.",
)

CELL_DEGREES = text(
    "--cell-degrees",
    "Cell size in degrees, instead of metres",
    advanced=True,
    help="The height map is then in degrees. Seconds have an s: 0.4s.",
)
LIKE = raster(
    "--like",
    "Height map with the same grid",
    help="Extent, cells and coordinate reference system are those of this height map. The cell size is then not used.",
)
BASE = raster(
    "--base",
    "Height map for the ground around the contours",
    advanced=True,
    help="Heights outside the contours come from it, without a step at the border.",
)
BASE_FADE = distance(
    "--base-fade",
    "Distance at which the correction of that height map fades out",
    advanced=True,
    help="If it is empty, 12 times the mean spacing of the contours. With 0 that height map stays as it is.",
)
COG = yes("--cog", "Write GeoTIFF as Cloud Optimized GeoTIFF", advanced=True)
UNCERTAINTY = yes(
    "--uncertainty",
    "Estimate standard errors",
    help="The errors are learnt on hidden contours. A height map gets them as a second band; new contours get the fields "
    "err_v, err_h and inferred.",
)

ATTRIBUTION = text(
    "--attribution", "Source of the data, for map tiles", advanced=True, help="Map tiles (.pmtiles, .mbtiles) state it, and maps show it."
)
VIEWER = file_output(
    "--viewer",
    "Page that shows map tiles",
    PAGE,
    advanced=True,
    help="A page in the folder of the tiles (.pmtiles). It shows them in a browser, from any web server that answers range requests.",
)
ZOOMS = text(
    "--zooms",
    "Intervals of map tiles by zoom",
    advanced=True,
    help="For contours as map tiles (.pmtiles, .mbtiles): 10:100,12:20,14:5 shows 100 m from zoom 10, and 5 m at zoom 14, the highest. "
    "If it is empty, each zoom has an interval whose lines are two pixels apart on steep slopes.",
)
TERRAIN_TILES = [
    number(
        "--max-zoom",
        "Highest zoom of terrain tiles",
        whole=True,
        advanced=True,
        help="For a height map as terrain tiles (.pmtiles, .mbtiles). Their pixels are then the cells.",
    ),
    choice("--tile-size", "Pixels of a terrain tile's side", [("512", "512"), ("256", "256")], advanced=True),
    choice(
        "--tile-image",
        "How terrain tiles are stored",
        [("png", "PNG"), ("webp", "WebP without losses, which is smaller")],
        advanced=True,
    ),
    choice(
        "--png-encoding",
        "Encoding of heights as colours",
        [
            ("", "16-bit grey in a PNG, Terrarium in terrain tiles"),
            ("terrarium", "Terrarium: steps of 1/256 m"),
            ("mapbox", "Mapbox: steps of 0.1 m"),
            ("gsi", "GSI: steps of 0.01 m"),
        ],
        advanced=True,
    ),
]

INDEX = number(
    "--index", "Every Nth level is an index contour", default=5, whole=True, advanced=True, help="0 for no index contours."
)
INTERVAL = number("--interval", "Contour interval", proposed=5, unless=["LEVELS"])
FOR_MAP = [
    text(
        "--supplementary",
        "Steps of supplementary contours: half of the interval, or half and a quarter",
        advanced=True,
        help="For instance 2.5 or 2.5,1.25 with an interval of 5. They are drawn only where the ground needs them. The field kind then "
        "tells the kinds of contours apart, and the style draws them differently.",
    ),
    number(
        "--supplementary-spacing",
        "Supplementary contours where the others are so far apart, metres",
        advanced=True,
        help="If it is empty, 15 mm on a map of the scale, or 37.5 times the interval.",
    ),
    number(
        "--scale",
        "Scale of the map, 1 :",
        advanced=True,
        help="All lines are simplified for it, also those of the input, and rings below 1 mm are left out.",
    ),
    yes("--thin", "Leave out intermediate contours on steep slopes at that scale", advanced=True),
]
LEVELS = text(
    "--levels", "Elevations instead of an interval", advanced=True, help="Separated by commas, for instance 12.5,13."
)
LEVEL_BASE = number(
    "--base-level", "Elevation from which the levels count", default=0, unless=["LEVELS"], advanced=True
)
LABELS = yes(
    "--labels",
    "Also write labels of index contours",
    advanced=True,
    help="A GeoPackage gets a layer labels, a DXF gets texts. The style of the result has labels without this option.",
)
BANDS = vector_output(
    "--bands",
    "Areas between the lines",
    POLYGONS,
    name="BANDS",
    optional=True,
    style="bands",
    help="Polygons with the levels below and above. Where they meet, they have the vertices of the lines.",
)
TO_CRS = crs(
    "--to-crs",
    "Coordinate reference system of the result",
    advanced=True,
    help="If it is empty, that of the input. The vertices of the input then keep their coordinates exactly.",
)
TO_UNIT = choice(
    "--to-unit",
    "Unit of the heights in the result",
    [("m", "Metres"), ("ft", "International feet"), ("us-ft", "US survey feet")],
    advanced=True,
    help="Heights in other options of this tool are then in this unit too.",
)
TO_DEPTHS = yes(
    "--to-depths",
    "Also write depths, positive downwards",
    advanced=True,
    help="The field depth, beside elev. Areas between the lines get depth_from, depth_to and depth_mid.",
)

HEIGHT_SIGMA = number(
    "--sigma",
    "Standard error of the heights of height maps [m]",
    advanced=True,
    help="If it is empty, the errors that the file has beside its heights.",
)

PREVIEW = file_output("--preview", "Picture of the result", PICTURE, advanced=True)
SHIFT = [
    text(
        "--vertical-shift",
        "File with a grid of shifts between height systems",
        advanced=True,
        help="Its values are added to the heights of the height map (of two, of A): .gtx, .tif in degrees, .isg, or .par of the Geospatial Information Authority of Japan.",
    ),
    yes("--vertical-shift-inverse", "Take the values of the grid off the heights instead", advanced=True),
]
DIAGNOSTICS = vector_output(
    "--diagnostics",
    "Diagnostics",
    ANY,
    name="DIAGNOSTICS",
    optional=True,
    advanced=True,
    layer="conflicts",
    others=("streams", "breaklines", "sinks"),
    style="findings",
    help="A GeoPackage with the streams and break lines as they are used, the pits that stay, and the places where lines, "
    "lakes and spot heights contradict the contours.",
)

CLEANING = [UNIT, PLANE_UNIT, DEPTHS, WORK_CRS, SNAP, REPAIR, STRICT, FIT, SAMPLE]
PART = [EXTENT, CLIP]
# What belongs to the contours themselves, also where no surface is made.
OF_CONTOURS = [CLIFFS, COAST, COAST_LEVEL, SEA, EXCLUDE]
# What shapes the surface, first the lines and areas of a map.
TERRAIN = [
    POINTS_WITH_HEIGHT, STREAMS, WATER, BREAK_LINES,
    SIGMA, *OF_CONTOURS, STREAM_TOLERANCE, SINKS, DRAIN,
]
SURFACE = [SURFACE_KIND, FRAME, FRAME_LAYER, NO_EXTEND, RESOLUTION, TENSION, NOISE]
