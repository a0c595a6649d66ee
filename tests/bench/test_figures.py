# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""deploy/figures.sh makes every figure that the documents show, and the same drawing from the same tables."""

import importlib.util
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CHARTS = Path("docs/charts")
FIGURE = re.compile(r"\]\(([^)\s]+\.(?:svg|png))\)")
DRAWN_BY = re.compile(r"Matplotlib v([\d.]+)")

# Matplotlib writes coordinates, some hundreds of points, with six decimals. Processors and NumPy's choice of
# instructions differ in a double's last digits, 1e-13 of them; so a coordinate may be rounded to the next decimal, and no
# further. The second half is that of comparing two decimal numbers as doubles.
ONE_DECIMAL = 1.5e-6
NUMBER = re.compile(r"(?<![\w#.-])-?\d+(?:\.\d+)?(?:e-?\d+)?(?!\w)")
# Hashes of what is drawn, coordinates included.
NAME = re.compile(r"\b[a-z][0-9a-f]{10}\b")


def documents():
    return [*ROOT.glob("*.md"), *(page for page in ROOT.glob("docs/**/*.md") if "decisions" not in page.parts)]


def figures_of(page):
    """The figures that a page shows or links to, by their paths in the repository."""
    return {(page.parent / link).resolve().relative_to(ROOT).as_posix() for link in FIGURE.findall(page.read_text())}


def shape_and_numbers(drawing):
    """An SVG's text without its numbers, its names replaced by when each comes first; and the numbers."""
    order = {}
    text = NAME.sub(lambda found: f"#{order.setdefault(found[0], len(order))}", drawing)
    return NUMBER.sub("N", text), [float(number) for number in NUMBER.findall(text)]


def are_one_drawing(one, other):
    """Whether two SVGs show the same: to the byte, or but for the last decimal of coordinates."""
    if one == other:
        return True
    (shape, numbers), (other_shape, other_numbers) = shape_and_numbers(one), shape_and_numbers(other)
    return shape == other_shape and all(abs(a - b) <= ONE_DECIMAL for a, b in zip(numbers, other_numbers, strict=True))


class Figures(unittest.TestCase):
    def setUp(self):
        """A tree with the script, what draws, and the published tables and figures."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        for part in ("deploy", "docs/charts", "tests/bench"):
            shutil.copytree(ROOT / part, self.root / part, ignore=shutil.ignore_patterns("__pycache__"))
        (self.root / "server/scene").mkdir(parents=True)
        for file in ("docs/stamps.py", "server/scene/physics_version.hpp"):
            shutil.copy(ROOT / file, self.root / file)
        (self.root / "docs/pictures").mkdir()

    def program(self, name, body):
        """Puts a script in the place of a program."""
        file = self.root / "build/release/bin" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"#!/bin/sh\n{body}\n")
        file.chmod(0o755)

    def physics(self, state):
        """A server whose canonical run ends in this state."""
        self.program("eti-server", f"""echo '{{"state_hash": "{state}"}}'""")

    def claims(self, hold):
        """In place of what the pages say of the tables."""
        (self.root / "tests/bench/check_tables.py").write_text(f"class Calibration():\n    pass\n\n\nexit({0 if hold else 1})\n")

    def figures(self, *options):
        return subprocess.run([self.root / "deploy/figures.sh", "--no-install", "--no-build", *options],
                              capture_output=True, text=True)

    def bench(self, body):
        """Puts a script in the place of eti-bench; $folder is what follows --out."""
        self.program("eti-bench", f"for folder; do :; done\n{body}")

    def needs_drawing(self):
        if importlib.util.find_spec("matplotlib") is None:
            self.skipTest("python3-matplotlib is missing; deploy/setup.sh installs it")

    def test_quick_run_redraws_published_charts(self):
        self.needs_drawing()
        import matplotlib
        published = {file.name: file.read_text() for file in (ROOT / CHARTS).glob("*.svg")}
        versions = {DRAWN_BY.search(text)[1] for text in published.values()}
        if versions != {matplotlib.__version__}:
            self.skipTest(f"the charts were drawn by Matplotlib {versions}, here is {matplotlib.__version__}")
        for file in (self.root / CHARTS).glob("*.svg"):
            file.unlink()
        done = self.figures("--quick")
        self.assertEqual(done.returncode, 0, done.stderr)
        drawn = {file.name: file.read_text() for file in (self.root / CHARTS).glob("*.svg")}
        self.assertEqual(set(drawn), set(published))
        differing = sorted(name for name in drawn if not are_one_drawing(drawn[name], published[name]))
        self.assertEqual(differing, [], "Remedy: deploy/figures.sh --quick, and look at what changed")
        self.assertIn("drawing", done.stderr)

    def test_drawing_comparison_detects_differences(self):
        drawing = (ROOT / CHARTS / "haptics-laws.svg").read_text()
        moved = NUMBER.search(drawing, drawing.index("axes_1"))
        for by, same in ((0, True), (1e-6, True), (-1e-6, True), (2e-6, False), (1, False)):
            number = f"{float(moved[0]) + by:.6f}"
            other = drawing[:moved.start()] + number + drawing[moved.end():]
            self.assertEqual(are_one_drawing(drawing, other), same, by)
        name = NAME.search(drawing)[0]
        self.assertTrue(are_one_drawing(drawing, drawing.replace(name, "m0123456789")))
        self.assertFalse(are_one_drawing(drawing, drawing.replace(name, "m0123456789", 1)), "what it names is gone")
        self.assertFalse(are_one_drawing(drawing, drawing.replace("#1f77b4", "#1f77b5")), "another colour")
        self.assertFalse(are_one_drawing(drawing, drawing.replace("0.8", "0.8 1", 1)))

    def test_every_documented_figure_is_generated(self):
        done = self.figures("--list")
        self.assertEqual(done.returncode, 0, done.stderr)
        # Pictures of an earlier version are kept for comparison.
        made = set(done.stdout.split()) | {file.relative_to(ROOT).as_posix()
                                           for file in ROOT.glob("docs/pictures/before/*.png")}
        shown = set().union(*map(figures_of, documents()))
        self.assertGreater(len(shown), 20)
        self.assertEqual(shown - made, set())
        self.assertEqual({name for name in made if not (ROOT / name).exists()}, set())
        self.assertEqual({file.relative_to(ROOT).as_posix() for suffix in ("svg", "png")
                          for file in ROOT.glob(f"docs/**/*.{suffix}")} - made, set())

    def test_pages_with_figures_name_the_command(self):
        for page in documents():
            if re.search(r"!\[[^\]]*\]\([^)]*\)", page.read_text()):
                self.assertIn("deploy/figures.sh", page.read_text(), page.relative_to(ROOT))

    def test_measured_part_replaces_its_tables_and_charts(self):
        self.needs_drawing()
        table = self.root / CHARTS / "calibration.csv"
        lines = table.read_text().splitlines(keepends=True)
        measured = self.root / "measured.csv"
        measured.write_text("".join(lines[:41]))
        self.bench(f'cp {measured} "$folder/calibration.csv"')
        self.physics("0123456789abcdef")
        self.claims(hold=True)
        page = self.root / "docs" / "page.md"
        page.write_text("# Calibration\n\n<!-- measured: calibration -->\n\nText.\n")
        before = (self.root / CHARTS / "calibration.svg").read_bytes()
        done = self.figures("--only", "calibration")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("measuring (two minutes)", done.stderr)
        self.assertEqual(table.read_text(), measured.read_text())
        self.assertNotEqual((self.root / CHARTS / "calibration.svg").read_bytes(), before)
        self.assertIn("by `deploy/figures.sh --only calibration`", page.read_text())
        self.assertIn("physics version 01234567", page.read_text())
        self.assertNotIn("Stale", page.read_text())
        # Another physics: the page says so, and the part is measured again.
        self.physics("fedcba9876543210")
        stamps = [sys.executable, "-B", self.root / "docs/stamps.py"]
        self.assertEqual(subprocess.run([*stamps, "--check"], stdout=subprocess.DEVNULL).returncode, 1)
        subprocess.run([*stamps, "--update"], check=True)
        self.assertEqual(subprocess.run([*stamps, "--check"], stdout=subprocess.DEVNULL).returncode, 0)
        self.assertIn("**Stale:** measured with physics version 01234567, current is fedcba98", page.read_text())
        done = self.figures("--stale", "--only", "calibration")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("Stale", page.read_text())
        done = self.figures("--stale", "--only", "calibration")
        self.assertIn("Every table belongs to the current physics version", done.stderr)

    def test_tables_that_contradict_the_pages_are_reported(self):
        self.needs_drawing()
        self.bench(f'cp "{ROOT / CHARTS / "calibration.csv"}" "$folder/calibration.csv"')
        self.physics("0123456789abcdef")
        self.claims(hold=False)
        done = self.figures("--only", "calibration")
        self.assertEqual(done.returncode, 1)
        self.assertIn("the pages contradict the new tables", done.stderr)

    def test_stale_parts_are_listed_cheapest_first(self):
        self.physics("0123456789abcdef")
        done = self.figures("--stale", "--list")
        self.assertEqual(done.returncode, 0, done.stderr)
        listed = done.stdout.splitlines()
        self.assertEqual((listed[0], listed[-1]), ("calibration  two minutes", "score        half an hour"))
        self.program("eti-server", "echo no patient >&2; exit 1")
        done = self.figures("--stale", "--list")
        self.assertEqual(done.returncode, 1)
        self.assertIn("no patient", done.stderr)

    def test_failed_part_keeps_published_files(self):
        self.bench('echo half > "$folder/calibration.csv"; exit 1')
        done = self.figures("--only", "calibration")
        self.assertEqual(done.returncode, 1)
        self.assertIn("calibration failed", done.stderr)
        for file in (self.root / CHARTS).glob("calibration.*"):
            self.assertEqual(file.read_bytes(), (ROOT / CHARTS / file.name).read_bytes(), file.name)

    def test_pictures_come_from_best_view_of_demo(self):
        demo = self.root / "demo-1/observer"
        demo.mkdir(parents=True)
        views = ("laryngoscope", "section", "overview")
        for view in views:
            (demo / f"{view}_best_007.000s.png").write_text(f"{view}, best")
            (demo / f"{view}_009.000s.png").write_text("the last")
        done = self.figures("--only", "pictures", "--demo", demo.parent)
        self.assertEqual(done.returncode, 0, done.stderr)
        for view in views:
            self.assertEqual((self.root / f"docs/pictures/{view}.png").read_text(), f"{view}, best")
        (demo / "section_best_007.000s.png").unlink()
        done = self.figures("--only", "pictures", "--demo", demo.parent)
        self.assertEqual(done.returncode, 1)
        self.assertIn("section_best", done.stderr)

    def test_unknown_parts_and_options_are_refused(self):
        done = self.figures("--only", "weather")
        self.assertEqual(done.returncode, 1)
        self.assertIn("accuracy", done.stderr)
        self.assertEqual(self.figures("--fast").returncode, 2)


if __name__ == "__main__":
    unittest.main()
