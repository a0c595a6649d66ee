# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""CONTRIBUTING's lists of files match the commits that it names, and stay short."""

import re
import shutil
import subprocess
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
MOST = {"A runtime parameter": 5, "A metric": 3, "A live measure": 4, "A scenario key": 6, "An event": 1,
        "A report section": 3, "A message": 4, "A constraint": 6, "A view": 4}
# Without tests and documents, which every change has, where a section does not count them.
WITHOUT_TESTS = ("A runtime parameter", "A metric", "A live measure", "A scenario key", "An event", "A report section",
                 "A message")


def sections():
    """(title, text) of each section below "How to add"."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").split("## How to add")[1]
    parts = re.split(r"^### (.+)$", text, flags=re.M)
    return list(zip(parts[1::2], parts[2::2]))


def listed(text):
    return {path for row in re.findall(r"^\| (`.+?) \|", text, re.M) for path in re.findall(r"`([^`]+)`", row)}


def git(*arguments):
    done = subprocess.run(["git", "-C", str(ROOT), *arguments], capture_output=True, text=True)
    return done.stdout if done.returncode == 0 else ""


def why_no_history():
    """Reason why this tree's commits are not available; empty if they are."""
    if shutil.which("git") is None:
        return "there is no git here"
    top = git("rev-parse", "--show-toplevel").strip()
    if not top or Path(top).resolve() != ROOT:  # an archive may lie inside another project's clone
        return "this tree is no clone that git reads"
    if git("rev-parse", "--is-shallow-repository").strip() == "true":
        return "this clone is shallow: its oldest commit shows every file"
    return ""


def renamed_since(commit):
    """Files of a commit that have been renamed since: {then: now}."""
    now = {}
    for line in git("log", "--reverse", "--format=", "--name-status", "--find-renames=30%", "--diff-filter=R",
                    f"{commit}..HEAD").splitlines():
        _, old, new = line.split("\t")
        for then in [name for name, current in now.items() if current == old] or [old]:
            now[then] = new
    return now


class Contributing(unittest.TestCase):
    def test_every_listed_file_exists(self):
        found = sections()
        self.assertGreaterEqual(len(found), len(MOST) + 1)
        for title, text in found:
            self.assertTrue(listed(text), title)
            for path in listed(text):
                self.assertTrue((ROOT / path).is_file(), f"{title}: {path}")

    def test_lists_are_short(self):
        lists = dict(sections())
        for title, most in MOST.items():
            self.assertLessEqual(len(listed(lists[title])), most, title)

    def test_lists_match_their_commits(self):
        if why := why_no_history():
            self.skipTest(why)
        for title, text in sections():
            quoted = re.search(r'Commit\s+"([^"]+)"', text)
            if not quoted:
                continue
            commits = git("log", "--format=%H", "--fixed-strings", "--grep", quoted[1]).split()
            if not commits:
                self.skipTest("the history does not reach back to these commits")
            names = git("show", "--format=", "--name-only", commits[-1]).split()
            renamed = renamed_since(commits[-1])
            names = [renamed.get(name, name) for name in names]
            kept = {name for name in names if not name.startswith("docs/")
                    and not (title in WITHOUT_TESTS and name.startswith("tests/"))}
            self.assertEqual(kept, listed(text), title)


if __name__ == "__main__":
    unittest.main()
