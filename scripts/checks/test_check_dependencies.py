#!/usr/bin/env python3
"""Tests of check_dependencies.py."""
import unittest

from check_dependencies import is_allowed


class Licences(unittest.TestCase):
    def test_one_choice_of_each_part_is_enough(self):
        for good in ("MIT", "MIT/GPL-3.0", "(MIT OR GPL-3.0) AND Zlib", "Apache-2.0 WITH LLVM-exception OR GPL-3.0"):
            self.assertTrue(is_allowed(good), good)

    def test_what_is_not_known_is_not_allowed(self):
        for bad in ("", "GPL-3.0", "MIT AND GPL-3.0", "(GPL-3.0 OR LGPL-2.1) AND MIT"):
            self.assertFalse(is_allowed(bad), bad)


if __name__ == "__main__":
    unittest.main()
