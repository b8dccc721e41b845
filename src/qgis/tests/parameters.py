"""The parameters beside the options of the program. Started by run.py."""
import re
import subprocess
import unittest

import inside  # noqa: F401, it loads QGIS and the plugin
from installed import TOKOSEN

# Importable after the module inside.
from tokosen.verbs import VERBS  # noqa: E402

# Options that are no parameters. The plugin sets some of them itself; the guide names the others.
LEFT_OUT = {
    "crs", "layer", "extent-crs", "help", "quiet", "verbose", "overwrite", "progress", "json", "threads", "save-run",
    "paper", "scale", "title", "source",
    "font", "for", "size", "stac",
}
LEFT_OUT_OF = {
    "densify": {"dem", "page", "cell", "cell-degrees", "like", "cog", "compare", "report", "png-encoding", "max-zoom", "tile-size", "tile-image"},
    "check": {"strict"},
    "skeleton": {"triangles", "curve-mesh"},
}



class Options(unittest.TestCase):
    """The parameters are options of the program that is tested, and none of its options is forgotten."""

    def test_flags(self):
        for verb in VERBS:
            with self.subTest(verb.command):
                help_ = subprocess.run([TOKOSEN, verb.command, "--help"], capture_output=True, text=True).stdout
                known = set(re.findall(r"^ +(?:-\w, )?--([\w-]+)", help_, re.MULTILINE))
                flags = {option.flag[2:] for option in verb.options if option.flag}
                self.assertEqual(flags - known, set())
                self.assertEqual(known - flags - LEFT_OUT, LEFT_OUT_OF.get(verb.command, set()))
                names = [option.name for option in verb.options]
                self.assertEqual(len(names), len(set(names)))

    def test_help(self):
        for verb in VERBS:
            algorithm = verb()
            self.assertGreater(len(algorithm.shortHelpString()), 100)
            self.assertTrue(algorithm.tags())
