# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Rules for the documentation: links lead somewhere, and pages that sources name exist.

Usage: documents.py [ROOT]. Prints one line per violation, FILE:LINE: what, and what to do.
"""

import os
import re
import sys
from pathlib import Path

import structure

# What a page of docs/ says where it names another one in a source, a script or a message.
NAMED_PAGE = re.compile(r"\bdocs/[\w/.-]*\w\.(?:md|svg|csv|png)\b")


def pages(root):
    """All documents: README and docs/, decisions included."""
    return sorted([*Path(root).glob("*.md"), *Path(root).glob("docs/**/*.md")])


def without_code(text):
    """The page with the same lines, those of code blocks empty."""
    lines, inside = [""], False
    for line in text.splitlines():
        fence = line.lstrip().startswith("```")
        indented = line.startswith("    ") and not lines[-1]
        lines.append("" if inside or fence or indented else line)
        inside ^= fence
    return lines[1:]


def anchors(text):
    """Names of a page's headings as links spell them."""
    headings = [re.sub(r"\]\([^)]*\)", "", line.lstrip("# ")) for line in without_code(text) if line.startswith("#")]
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def broken_links(page, text):
    """Links of a page within the repository that lead nowhere, as (line number, link)."""
    for number, line in enumerate(without_code(text), 1):
        for link in re.findall(r"\]\(([^)\s]+)\)", line):
            if re.match(r"[a-z]+:", link):
                continue
            file, _, anchor = link.partition("#")
            target = page.parent / file if file else page
            if not target.exists() or anchor and anchor not in anchors(target.read_text()):
                yield number, link


def check_page(page, text):
    """Violations within one document as (line number, text)."""
    for number, link in broken_links(page, text):
        yield number, f"links to {link}, which is not there; mend the link or the heading"


def named_pages(root):
    """Files of docs/ that sources and scripts name, as (source, line number, name)."""
    suffixes = structure.SOURCES | {".yaml", ".txt"}
    for folder, subfolders, names in os.walk(root):
        subfolders[:] = sorted(d for d in subfolders if d not in structure.NOT_SOURCE)
        if Path(folder).resolve() == structure.HERE:      # its tests name pages of made-up trees
            continue
        for source in sorted(Path(folder, name) for name in names if Path(name).suffix in suffixes):
            for number, line in enumerate(source.read_text(errors="replace").splitlines(), 1):
                for name in NAMED_PAGE.findall(line):
                    yield source.relative_to(root), number, name


def check(root):
    """All violations under `root`, one string each."""
    found = [f"{page.relative_to(root)}:{number}: {text}" for page in pages(root)
             for number, text in check_page(page, page.read_text())]
    return found + [f"{source}:{number}: names {name}, which is not there; name the page that says it now"
                    for source, number, name in named_pages(root) if not (Path(root) / name).exists()]


if __name__ == "__main__":
    violations = check(Path(sys.argv[1]) if len(sys.argv) > 1 else structure.HERE.parents[2])
    print(*violations, sep="\n", end="\n" if violations else "")
    sys.exit(1 if violations else 0)
