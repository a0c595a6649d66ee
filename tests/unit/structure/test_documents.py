# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""The documents keep the rules, and the checker notices each way of breaking them."""

import tempfile
import unittest
from pathlib import Path

import documents
import structure

WORDS = "word " * documents.LONGEST_SENTENCE


def violations(files):
    """What the checker says of a tree made of {path: text}."""
    with tempfile.TemporaryDirectory() as folder:
        for path, text in files.items():
            file = Path(folder, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        return documents.check(folder)


class ThisTree(unittest.TestCase):
    def test_these_documents_keep_the_rules(self):
        found = documents.check(structure.HERE.parents[2])
        self.assertEqual(found, [], "\n" + "\n".join(found))

    def test_these_documents_are_really_read(self):
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

    def test_a_long_page_is_found(self):
        page = "A line.\n\n" * (documents.LONGEST_PAGE // 2)
        self.assertEqual(violations({"docs/a.md": page}), [])
        self.only({"docs/a.md": page + "One more.\n"}, "docs/a.md:1: has 131 lines")

    def test_a_long_sentence_is_found_in_paragraphs_and_lists(self):
        self.assertEqual(violations({"docs/a.md": f"{WORDS}. {WORDS}.\n"}), [])
        for line, text in ((1, f"{WORDS}more.\n"), (3, f"Short.\n\n- {WORDS.replace(' ', chr(10) + '  ', 1)}more.\n"),
                           (2, f"- Short.\n- {WORDS}[more](https://example.org).\n")):
            with self.subTest(text=text):
                self.only({"docs/a.md": text}, f"docs/a.md:{line}: has a sentence of 41 words")

    def test_code_tables_headings_and_decisions_may_be_long(self):
        for text in (f"```\n{WORDS}more\n```\n", f"| {WORDS} | more |\n", f"# {WORDS}more\n",
                     f"A formula:\n\n    {WORDS}more\n"):
            with self.subTest(text=text):
                self.assertEqual(violations({"docs/a.md": text}), [])
        self.assertEqual(violations({"docs/decisions/a.md": f"{WORDS}more.\n" * 200}), [])

    def test_links_that_lead_nowhere_are_found(self):
        pages = {"docs/b/c.md": "# What fails, then?\n", "README.md": "See [c](docs/b/c.md#what-fails-then).\n"}
        self.assertEqual(violations(pages), [])
        self.only({**pages, "docs/a.md": "See [c](c.md).\n"}, "docs/a.md:1: links to c.md")
        self.only({**pages, "docs/a.md": "\nSee [c](b/c.md#what-holds).\n"}, "docs/a.md:2: links to b/c.md#what-holds")
        self.only({**pages, "docs/decisions/a.md": "See [c](../c.md).\n"}, "docs/decisions/a.md:1: links to")

    def test_pages_that_a_source_names_and_nobody_wrote_are_found(self):
        self.assertEqual(violations({"docs/a.md": "A.\n", "server/a.cpp": "// See docs/a.md.\n"}), [])
        self.only({"docs/a.md": "A.\n", "server/a.cpp": "\n// See docs/b.md.\n"}, "server/a.cpp:2: names docs/b.md")


if __name__ == "__main__":
    unittest.main()
