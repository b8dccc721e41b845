"""Points as text (CSV, TSV, XYZ) that are broken or wild."""
from hostile_inputs.case import DEM, Case
from hostile_inputs.maps import collection, hill

GOOD = "x,y,z\n1,2,31\n3,4,32\n"
TABLES = {
    "empty": "",
    "a head alone": "x,y,z\n",
    "zero bytes": "x,y,z\n1,2,\0\n",
    "utf-16": GOOD.encode("utf-16"),
    "byte order mark": "\ufeff" + GOOD,
    "shift jis": "経度,緯度,標高\n139.1,35.2,31\n".encode("shift_jis"),
    "not utf-8": b"x,y,z,n\xff\xfeme\n1,2,31,\xff\n",
    "carriage returns alone": GOOD.replace("\n", "\r"),
    "no end of the line": GOOD[:-1],
    "names twice": "x,y,z,z,x\n1,2,31,99,7\n",
    "no names known": "a,b,c\n1,2,31\n",
    "no names and two columns": "1,2\n3,4\n",
    "no names and four columns": "1,2,31,5\n3,4,32,6\n",
    "rows of other lengths": "x,y,z\n1,2\n3,4,32,5,6\n,,\n\n7,8,33\n",
    "quotes that do not end": 'x,y,z\n"1,2,31\n3,4,32\n',
    "quotes with lines in them": 'x,y,z,text\n1,2,31,"a\nb, c"\n3,4,32,"d ""e"" f"\n',
    "decimal commas": "x;y;z\n1,5;2,5;31,5\n3;4;32\n",
    "thousands": "x;y;z\n1 000;2'000;31\n",
    "numbers of words": "x,y,z\none,two,three\n",
    "numbers out of range": "x,y,z\n1e400,2,31\n1,-1e400,31\n1,2,1e400\n",
    "NaN and infinity": "x,y,z\nNaN,2,31\n1,inf,31\n1,2,-Infinity\n",
    "hexadecimal": "x,y,z\n0x10,0x20,0x30\n",
    "one line of a megabyte": "x,y,z\n" + "1" * 1_000_000 + ",2,31\n",
    "a hundred thousand columns": ",".join(["x", "y", "z"] + [f"c{k}" for k in range(100_000)]) + "\n" + "1," * 100_002 + "1\n",
    "comments alone": "# x,y,z\n" * 1000,
    "a formula": "x,y,z\n=1+1,=cmd|'/c calc'!A0,31\n",
    "a hundred thousand rows at one place": "x,y,z\n" + "3,4,33\n" * 100_000,
    "sigma out of range": "x,y,z,sigma\n1,2,31,-5\n3,4,32,1e400\n5,6,33,\n",
}  # fmt: skip
ENDINGS = ("csv", "tsv", "xyz", "txt")


def cases():
    for number, (name, text) in enumerate(TABLES.items()):
        data = text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass")
        for ending in dict.fromkeys(("csv", ENDINGS[number % 4])):

            def write(folder, data=data, ending=ending):
                (folder / "hill.geojson").write_text(collection(hill()))
                (folder / f"spots.{ending}").write_bytes(data.replace(b",", b"\t") if ending == "tsv" else data)

            yield Case(f"{ending}: {name}", write, DEM.format(f"hill.geojson --points spots.{ending} --points-sigma 0.1"))
