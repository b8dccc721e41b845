#!/usr/bin/env python3
"""Shows that the zip of the QGIS plugin is complete, the same each time, and of the version of the program.

QGIS itself is not needed. The tests with QGIS are those of src/qgis/tests/run.py.
"""
import ast
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import zipfile

import make_qgis_plugin

OLDEST_PYTHON = (3, 8)  # of QGIS 3.22


class Zip(unittest.TestCase):
    def setUp(self):
        held = tempfile.TemporaryDirectory()
        self.addCleanup(held.cleanup)
        self.folder = pathlib.Path(held.name)

    def make(self, name, *more):
        path = self.folder / name
        script = pathlib.Path(make_qgis_plugin.__file__)
        subprocess.run([sys.executable, script, "-o", path, *more], check=True, capture_output=True)
        return path

    def test_same_bytes_each_time(self):
        self.assertEqual(self.make("one.zip").read_bytes(), self.make("two.zip").read_bytes())

    def test_nothing_but_the_plugin(self):
        with zipfile.ZipFile(self.make("plugin.zip")) as archive:
            names = archive.namelist()
        self.assertEqual([name for name in names if not name.startswith("tokosen/") or "__pycache__" in name], [])
        sources = {f"tokosen/{file.relative_to(make_qgis_plugin.PLUGIN).as_posix()}" for file in files_of_the_plugin()}
        self.assertEqual(sources - set(names), set())

    def test_version(self):
        with zipfile.ZipFile(self.make("plugin.zip")) as archive:
            metadata = archive.read("tokosen/metadata.txt").decode()
        cargo = (make_qgis_plugin.ROOT / "Cargo.toml").read_text(encoding="utf-8")
        version = re.search(r'^version = "(.+)"', cargo, re.MULTILINE).group(1)
        self.assertEqual(re.findall("^version=(.*)$", metadata, re.MULTILINE), [version])

    def test_program(self):
        program = self.folder / "tokosen"
        program.write_bytes(b"a program")
        with zipfile.ZipFile(self.make("plugin.zip", "--program", program)) as archive:
            entry = archive.getinfo("tokosen/bin/tokosen")
            self.assertEqual(archive.read(entry), b"a program")
            self.assertEqual(entry.external_attr >> 16 & 0o777, 0o755)

    def test_sources_fit_the_oldest_python(self):
        sources = [file for file in files_of_the_plugin() if file.suffix == ".py"]
        self.assertGreater(len(sources), 10)
        for file in sources:
            ast.parse(file.read_text(encoding="utf-8"), str(file), feature_version=OLDEST_PYTHON)


def files_of_the_plugin():
    return [
        file for file in make_qgis_plugin.PLUGIN.rglob("*") if file.is_file() and "__pycache__" not in file.parts
    ]


if __name__ == "__main__":
    unittest.main()
