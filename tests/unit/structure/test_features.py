# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Every test that docs/features.md names as evidence exists."""

import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]


def tests_of_programs():
    """Suite.Test of googletest."""
    found = set()
    for file in (ROOT / "tests").rglob("*.cpp"):
        text = file.read_text(encoding="utf-8")
        found |= {f"{suite}.{name}" for suite, name in re.findall(r"^(?:TEST|TEST_F|TEST_P)\((\w+),\s*(\w+)\)", text, re.M)}
    return found


def tests_of_scripts():
    """name.test of the lists in CMake; methods without their test_."""
    found = set()
    for listing in (ROOT / "tests").rglob("CMakeLists.txt"):
        for name, file in re.findall(r"eti_python_test\((\w+) (\S+\.py)", listing.read_text(encoding="utf-8")):
            text = (listing.parent / file).read_text(encoding="utf-8")
            found |= {f"{name}.{test}" for test in re.findall(r"def test_(\w+)\(", text)}
    return found


class Features(unittest.TestCase):
    def test_every_proof_exists(self):
        page = (ROOT / "docs" / "features.md").read_text(encoding="utf-8")
        named = set(re.findall(r"`(\w+\.\w+)`", page))
        self.assertGreater(len(named), 25)
        self.assertEqual(sorted(named - tests_of_programs() - tests_of_scripts()), [])

    def test_every_feature_has_a_proof(self):
        page = (ROOT / "docs" / "features.md").read_text(encoding="utf-8")
        rows = [line for line in page.splitlines() if line.startswith("| ") and not line.startswith("| the paper")
                and not line.startswith("| here")]
        self.assertGreater(len(rows), 20)
        for row in rows:
            self.assertRegex(row.rsplit("|", 2)[1], r"`\w+\.\w+`", row)


if __name__ == "__main__":
    unittest.main()
