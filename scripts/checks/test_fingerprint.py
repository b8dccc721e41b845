#!/usr/bin/env python3
"""Shows that fingerprint.py masks what differs from run to run and finds every change of a program that is made here.

    test_fingerprint.py
"""
import contextlib
import io
import json
import os
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

import fingerprint
import fingerprint_commands

# Writes a file, and says where it is, how it was called and how long it took.
PROGRAM = """#!{python} -S
import os, sys, time
arguments, threads = sys.argv[1:-2], sys.argv[-1]
if arguments[:1] == ["check"]:
    print('{{"interval": 20}}')
    sys.exit()
with open("a.txt", "w") as file:
    file.write(" ".join(arguments) + {more})
print("height 12.5 m\\nin", os.getcwd())
print(f"time       {{time.time():.6f}} s (reading {{time.time():.6f}})")
print("read by", {path!r}, file=sys.stderr)
sys.exit(2 if "--wrong" in arguments else 0)
"""


class Masks(unittest.TestCase):
    def test_times_and_paths(self):
        text = "x 1.50\ntime       0.12 s (reading 0.10, writing 0.02)\n/t/f-1/3-2/a /t/f-1/drawn /p/tokosen\n  time 1.5\n"
        self.assertEqual(fingerprint.masked(text, pathlib.Path("/t/f-1/3-2"), pathlib.Path("/p/tokosen")),
                         "x 1.50\ntime       # s (reading #, writing #)\nFOLDER/a TEMPORARY/drawn PROGRAM\n  time 1.5\n")


class Drawn(unittest.TestCase):
    def test_same_each_time(self):
        with tempfile.TemporaryDirectory() as a, tempfile.TemporaryDirectory() as b:
            both = [pathlib.Path(a), pathlib.Path(b)]
            for folder in both:
                fingerprint_commands.draw(folder)
            names = sorted(path.name for path in both[0].iterdir())
            self.assertEqual(len(names), 13)
            for name in names:
                if not name.endswith(".zip"):
                    self.assertEqual(*((folder / name).read_bytes() for folder in both))


class Extent(unittest.TestCase):
    def test_geojson(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "a.geojson"
            lines = [("LineString", [(10, 500), (40, 900, 7)], 1), ("MultiLineString", [[(-20, 600), (0, 0)]], 2)]
            fingerprint_commands.geojson(path, lines, 6678)
            self.assertEqual(fingerprint_commands.extent(path), (60, 900, False))

    def test_geopackage(self):
        self.assertEqual(fingerprint_commands.extent(fingerprint.ROOT / "samples" / "caryville_20m.gpkg"), (10470, 8970, False))


@unittest.skipIf(os.name == "nt", "the program of this test is a script")
class Changes(unittest.TestCase):
    def setUp(self):
        held = tempfile.TemporaryDirectory()
        self.addCleanup(held.cleanup)
        self.folder = pathlib.Path(held.name)
        for name, value in (("COMMANDS", {"plain": "dem x -o a.txt", "two": "mesh && mesh more"}),
                            ("REFUSED", {"refused": (2, "dem --wrong")})):
            patch = mock.patch.object(fingerprint_commands, name, value)
            patch.start()
            self.addCleanup(patch.stop)
        self.program = self.write()

    def write(self, old="", new="", name="tokosen", more="''"):
        """A program, with a part of its text replaced."""
        path = self.folder / name
        text = PROGRAM.format(python=sys.executable, path=str(path), more=more)
        path.write_text(text.replace(old, new) if old else text)
        path.chmod(0o755)
        return path

    def call(self, verb, *options, program=None):
        """Exit status and what is printed."""
        record = ["-o" if verb == "record" else "-r", str(self.folder / "record.json")]
        said = io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            status = fingerprint.main([verb, *record, "--program", str(program or self.program), *options])
        return status, said.getvalue()

    def test_nothing_differs(self):
        self.assertEqual(self.call("record"), (0, "recorded 3 commands, 3 files\n"))
        self.assertEqual(self.call("check"), (0, "3 commands, 3 files: all as recorded\n"))
        self.assertEqual(self.call("check", program=self.write(name="other"))[0], 0)
        self.assertEqual(self.call("check", "--only", "plain"),
                         (0, "1 commands, 1 files: all as recorded; 2 commands of the record were not run\n"))

    def test_each_change_is_found(self):
        self.call("record")
        for old, new, words in [
            ('" ".join', '"  ".join', ["plain: a.txt differs\n", "two: a.txt differs\n"]),
            ('"a.txt"', '"b.txt"', ["plain: a.txt is missing\n", "plain: b.txt is new\n"]),
            ("height 12.5", "height 12.6",
             ["plain: stdout differs\n    @@ -1 +1 @@\n    -height 12.5 m\n    +height 12.6 m\n"]),
            ("read by", "read with", ["plain: stderr differs\n"]),
            ("(2 if", "(1 if", ["refused: status was [2], is [1]", "refused: exit status [1], not [2]"]),
            ("(reading", "(writing", ["plain: stdout differs"]),
        ]:
            with self.subTest(new):
                status, said = self.call("check", program=self.write(old, new, "other"))
                self.assertEqual(status, 1)
                for word in words:
                    self.assertIn(word, said)

    def test_a_change_of_wording_may_be_allowed(self):
        self.call("record")
        self.assertEqual(self.call("check", "--texts-may-differ", program=self.write("height", "elevation", "other"))[0], 0)
        self.assertEqual(self.call("check", "--texts-may-differ", program=self.write("12.5", "12.6", "other"))[0], 1)

    def test_threads_that_matter_leave_no_record(self):
        status, said = self.call("record", program=self.write(name="other", more="threads"))
        self.assertEqual(status, 1)
        self.assertIn("1 and 2 threads: plain: a.txt differs\n", said)
        self.assertFalse((self.folder / "record.json").exists())

    def test_a_part_of_the_record_is_replaced(self):
        self.call("record")
        other = self.write("height 12.5", "height 12.6", "other")
        self.assertEqual(self.call("record", "--only", "plain", program=other)[0], 0)
        found = json.loads((self.folder / "record.json").read_text())
        self.assertEqual([found[name]["stdout"].split()[1] for name in ("plain", "two")], ["12.6", "12.5"])

    def test_further_maps(self):
        maps = self.folder / "maps"
        maps.mkdir()
        fingerprint_commands.geojson(maps / "a b.geojson", [("LineString", [(0, 0), (2000, 1000)], 1)], 6678)
        (maps / "a b.tif").write_text("")
        self.assertEqual(self.call("record", "--maps", str(maps)), (0, "recorded 10 commands, 9 files\n"))
        found = json.loads((self.folder / "record.json").read_text())
        self.assertEqual(found["a b dem"]["steps"], "dem '../maps/a b.geojson' --cell 2 --uncertainty -o a.tif")
        self.assertEqual(found["a b densify"]["steps"], "densify '../maps/a b.geojson' -i 10 -o a.gpkg")
        self.assertIn("7 commands of the record were not run", self.call("check")[1])

    def test_what_cannot_be_run(self):
        self.assertEqual(self.call("check")[0], 2)
        self.assertEqual(self.call("record", program="no_such_program")[0], 2)
        self.assertEqual(self.call("record", "--only", "nothing has this name")[0], 2)
        self.assertEqual(self.call("record", "--maps", "no_such_folder")[0], 2)


if __name__ == "__main__":
    unittest.main()
