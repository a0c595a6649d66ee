# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Test names are short statements in standard terms: a suite is a noun, a test says what holds. Pages are plain English."""

import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
LONGEST_TEST = 45    # letters of a GoogleTest name, without its suite
LONGEST_METHOD = 50  # letters of a unittest method, without test_
# Words of clauses without antecedent and of personified code; the field has a term for each.
BANNED = {"anew", "heed", "heeds", "mend", "mends", "nobody", "told", "whoever", "whose"}
BANNED_IN_PAGES = re.compile(r"\b(anew|nobody|whoever)\b", re.IGNORECASE)


def words_of(name):
    """Lower-case words of a CamelCase or snake_case name."""
    return re.findall(r"[a-z0-9]+", re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower())


def faults_of(name, longest):
    if len(name) > longest:
        yield f"has {len(name)} letters; at most {longest}"
    for word in BANNED & set(words_of(name)):
        yield f"says '{word}'; use the field's term"


def compiled_tests(text):
    """(suite, test) of GoogleTest macros."""
    return re.findall(r"^(?:TYPED_)?TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\)", text, re.MULTILINE)


def faults(files):
    """One string for each fault in files, given as {path: text}."""
    found = []
    for path, text in files.items():
        if path.endswith(".py"):
            found += [f"{path}: test_{name} {fault}" for name in re.findall(r"def test_(\w+)\(", text)
                      for fault in faults_of(name, LONGEST_METHOD)]
            continue
        for suite, name in compiled_tests(text):
            found += [f"{path}: {suite}.{name} {fault}" for fault in faults_of(name, LONGEST_TEST)]
            if re.match(r"(A|An|The)[A-Z]", suite):
                found.append(f"{path}: suite {suite} begins with an article; name it by a noun")
    return found


class Names(unittest.TestCase):
    def test_tree_follows_the_rules(self):
        files = {str(path.relative_to(ROOT)): path.read_text(encoding="utf-8")
                 for path in (ROOT / "tests").rglob("*") if path.suffix in (".cpp", ".py")}
        self.assertGreater(sum(len(compiled_tests(text)) for text in files.values()), 1000)
        self.assertEqual(faults(files), [])

    def test_pages_use_plain_english(self):
        pages = [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")]
        self.assertGreater(len(pages), 50)
        self.assertEqual([f"{page.relative_to(ROOT)}: '{word}'" for page in pages
                          for word in BANNED_IN_PAGES.findall(page.read_text(encoding="utf-8"))], [])

    def test_faults_are_detected(self):
        self.assertEqual(faults({"a.cpp": "TEST(Lamp, IsOccluded) {}", "b.py": "def test_lamp_is_occluded(self):"}), [])
        for name, text in (("a.cpp", f"TEST(Lamp, {'A' * 46}) {{}}"), ("a.cpp", "TEST_F(ALamp, IsOccluded) {}"),
                           ("a.cpp", "TEST(Lamp, WakesNobody) {}"), ("b.py", f"def test_{'a' * 51}(self):"),
                           ("b.py", "def test_lamp_is_" + "drawn_anew(self):")):
            with self.subTest(text=text):
                self.assertEqual(len(faults({name: text})), 1)


if __name__ == "__main__":
    unittest.main()
