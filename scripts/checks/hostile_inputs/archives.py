"""Archives, documents and folders of the base map of Japan that are none."""
import zipfile

from hostile_inputs.case import DENSIFY, Case


def bomb(path):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("FG-GML-1-Cntr.xml", b"<" + b" " * 200_000_000)


ENTITIES = '<!DOCTYPE a [<!ENTITY a "aaaaaaaaaa">' + "".join(f'<!ENTITY a{k} "{("&a" + str(k - 1) + ";") * 10}">' for k in range(1, 10)) + "]><Dataset>&a9;</Dataset>"
ARCHIVES = {
    "no zip": ("a.zip", lambda p: p.write_text("hello")),
    "an empty zip": ("a.zip", lambda p: zipfile.ZipFile(p, "w").close()),
    "a bomb": ("a.zip", bomb),
    "a name that leads out": ("a.zip", lambda p: zipfile.ZipFile(p, "w").writestr("../../../tmp/FG-GML-1-Cntr.xml", "<a/>")),
    "entities": ("a.xml", lambda p: p.write_text(ENTITIES)),
    "deep elements": ("a.xml", lambda p: p.write_text("<a>" * 200_000)),
    "a folder of nothing": ("folder", lambda p: p.mkdir()),
}


def cases():
    for name, (file, write) in ARCHIVES.items():
        yield Case(f"gsi: {name}", lambda folder, file=file, write=write: write(folder / file), DENSIFY.format(file))
