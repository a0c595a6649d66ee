# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""The documents follow the rules, and the checker detects each violation."""

import tempfile
import unittest
from pathlib import Path

import documents
import structure


def violations(files):
    """The checker's output for a tree made of {path: text}."""
    with tempfile.TemporaryDirectory() as folder:
        for path, text in files.items():
            file = Path(folder, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        return documents.check(folder)


class ThisTree(unittest.TestCase):
    def test_documents_follow_the_rules(self):
        found = documents.check(structure.HERE.parents[2])
        self.assertEqual(found, [], "\n" + "\n".join(found))

    def test_documents_are_actually_read(self):
        root = structure.HERE.parents[2]
        read = {page.relative_to(root).as_posix() for page in documents.pages(root)}
        self.assertLessEqual({"README.md", "docs/architecture.md", "docs/solver/README.md", "docs/decisions/README.md"},
                             read)
        named = {(source.as_posix(), name) for source, _, name in documents.named_pages(root)}
        self.assertIn(("server/metrics/metrics.hpp", "docs/metrics.md"), named)


class Pages(unittest.TestCase):
    def only(self, files, expected):
        found = violations(files)
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith(expected), found)

    def test_broken_links_are_detected(self):
        pages = {"docs/b/c.md": "# What fails, then?\n", "README.md": "See [c](docs/b/c.md#what-fails-then).\n"}
        self.assertEqual(violations(pages), [])
        self.only({**pages, "docs/a.md": "See [c](c.md).\n"}, "docs/a.md:1: links to c.md")
        self.only({**pages, "docs/a.md": "\nSee [c](b/c.md#what-holds).\n"}, "docs/a.md:2: links to b/c.md#what-holds")
        self.only({**pages, "docs/decisions/a.md": "See [c](../c.md).\n"}, "docs/decisions/a.md:1: links to")

    def test_references_to_missing_pages_are_detected(self):
        self.assertEqual(violations({"docs/a.md": "A.\n", "server/a.cpp": "// See docs/a.md.\n"}), [])
        self.only({"docs/a.md": "A.\n", "server/a.cpp": "\n// See docs/b.md.\n"}, "server/a.cpp:2: names docs/b.md")


if __name__ == "__main__":
    unittest.main()
