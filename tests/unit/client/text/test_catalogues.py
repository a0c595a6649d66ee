#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""The message catalogues are complete: every text of client and report, in every language, with its fields for numbers."""

import re
import subprocess
import unittest
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[4]
CATALOGUES = sorted((ROOT / "client/text/po").glob("*.po"))
CPP_KEYWORDS = ("translate", "translate_format", "translatable", "text_of")
LITERALS = re.compile(r'(?:"(?:[^"\\\n]|\\.)*"(?:\s*(?://[^\n]*\n\s*)*)?)+')
LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
FIELD = re.compile(r"\{(\d*)((?::[^{}]*)?)\}")


def unescaped(text):
    return text.replace('\\"', '"').replace("\\n", "\n").replace("\\\\", "\\")


def entries(text):
    """(original, translation, flags) of a catalogue's text, without its header."""
    for block in re.split(r"\n\s*\n", text):
        lines = [line for line in block.splitlines() if not line.startswith("#") or line.startswith("#,")]
        flags = " ".join(line for line in lines if line.startswith("#,"))
        joined = "\n".join(line for line in lines if not line.startswith("#"))
        found = re.fullmatch(r"msgid ((?:\".*\"\s*)+)msgstr ((?:\".*\"\s*)+)", joined)
        if found:
            original, translation = ("".join(map(unescaped, LITERAL.findall(part))) for part in found.groups())
            if original:
                yield original, translation, flags


@cache
def catalogue(path):
    return list(entries(path.read_text()))


def extracted(language, keywords, files):
    """The texts that xgettext finds."""
    done = subprocess.run(["xgettext", f"--language={language}", "--from-code=UTF-8", "--keyword", "--output=-",
                           *(f"--keyword={word}" for word in keywords), *map(str, files)],
                          capture_output=True, text=True, check=True, cwd=ROOT)
    return {original for original, _, _ in entries(done.stdout)}


@cache
def texts_of_sources():
    cpp = sorted(path for suffix in ("cpp", "hpp") for path in (ROOT / "client").rglob(f"*.{suffix}"))
    return (extracted("C++", CPP_KEYWORDS, cpp)
            | extracted("JavaScript", ("t",), sorted((ROOT / "client/review/page").glob("*.js"))))


@cache
def literals():
    """All string literals of the sources whose texts are translated, adjacent ones joined, and texts of data files."""
    out = set()
    for folder in ("client", "common/model", "common/device", "common/session",
                   "server"):
        for suffix in ("cpp", "hpp", "js"):
            for path in (ROOT / folder).rglob(f"*.{suffix}"):
                for found in LITERALS.findall(path.read_text()):
                    out.add("".join(map(unescaped, LITERAL.findall(found))))
    for path in (ROOT / "deploy/data").rglob("*.yaml"):
        out.add(path.stem)
        out |= {text.replace("''", "'") for text in re.findall(r"^description: '?(.*?)'?$", path.read_text(), re.M)}
    return out


def fields(text):
    """Each field's argument and format, sorted; unnumbered ones count from 0."""
    return sorted((int(number) if number else i, form) for i, (number, form) in enumerate(FIELD.findall(text)))


class Catalogues(unittest.TestCase):
    def test_every_text_is_in_every_catalogue(self):
        self.assertEqual([path.stem for path in CATALOGUES], ["de", "es", "fr", "vi"])
        texts = texts_of_sources()
        self.assertGreater(len(texts), 200)
        for path in CATALOGUES:
            known = {original for original, _, _ in catalogue(path)}
            self.assertEqual(sorted(texts - known), [], f"{path.name} lacks these texts")

    def test_every_entry_is_translated_once(self):
        for path in CATALOGUES:
            originals = [original for original, _, _ in catalogue(path)]
            self.assertEqual(len(originals), len(set(originals)), path.name)
            bad = [original for original, translation, flags in catalogue(path) if not translation or "fuzzy" in flags]
            self.assertEqual(bad, [], f"{path.name}: without a translation, or fuzzy")

    def test_no_entry_is_obsolete(self):
        used = literals() | texts_of_sources()
        for path in CATALOGUES:
            obsolete = [original for original, _, _ in catalogue(path) if original not in used]
            self.assertEqual(obsolete, [], f"{path.name}: nothing shows these texts")

    def test_fields_are_those_of_the_original(self):
        for path in CATALOGUES:
            for original, translation, _ in catalogue(path):
                self.assertEqual(fields(translation), fields(original), f"{path.name}: {original}")

    def test_spaces_at_the_ends_are_kept(self):
        for path in CATALOGUES:
            for original, translation, _ in catalogue(path):
                self.assertEqual(translation.endswith(" "), original.endswith(" "), f"{path.name}: '{original}'")

    def test_outcomes_of_the_server_are_known(self):
        source = (ROOT / "server/metrics/outcome_tracker.cpp").read_text()
        sentences = {re.sub(r"\{[^}]*\}", "{}", "".join(map(unescaped, LITERAL.findall(found)))).removeprefix("; ")
                     for found in LITERALS.findall(source)}
        sentences = {one for one in sentences if one.count(" ") >= 2 and not one.startswith(("common/", "server/"))}
        self.assertGreater(len(sentences), 8)
        known = {part for original, _, _ in catalogue(CATALOGUES[0]) for part in (original, original.removeprefix("{}; "))}
        self.assertEqual(sorted(sentences - known), [])


class Reading(unittest.TestCase):
    """The helpers see what they claim to see."""

    def test_fuzzy_and_empty_entries_are_seen(self):
        text = '#, fuzzy\nmsgid "a"\nmsgstr "b"\n\nmsgid ""\n"c "\n"d"\nmsgstr ""\n'
        self.assertEqual(list(entries(text)), [("a", "b", "#, fuzzy"), ("c d", "", "")])

    def test_fields_may_change_their_order(self):
        self.assertEqual(fields("{1} of {0:.1f}"), fields("{0:.1f} in {1}"))
        self.assertNotEqual(fields("{} s"), fields("{:.1f} s"))


if __name__ == "__main__":
    unittest.main()
