# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""C++ sources are formatted by the repository's .clang-format, and shell scripts parse."""

import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import structure

ROOT = structure.HERE.parents[2]
VERSION = 14  # Debian 12's; no configuration makes 19, Debian 13's, break these sources' lines alike


def formatter_version():
    done = subprocess.run(["clang-format", "--version"], capture_output=True, text=True, check=True)
    return int(re.search(r"version (\d+)\.", done.stdout).group(1))


def badly_formatted(files):
    """clang-format's findings in these C++ files: its own messages, one line each."""
    done = subprocess.run(["clang-format", "--dry-run", f"--style=file:{ROOT}/.clang-format", *map(str, files)],
                          capture_output=True, text=True, check=True)
    return [line for line in done.stderr.splitlines() if "[-Wclang-format-violations]" in line]


class Formatting(unittest.TestCase):
    def test_sources_are_formatted(self):
        if formatter_version() != VERSION:
            self.skipTest(f"sources are formatted by clang-format {VERSION}; this is {formatter_version()}")
        files = [ROOT / p for p in structure.source_files(ROOT) if p.suffix in structure.C_SOURCES]
        self.assertGreater(len(files), 10)
        found = badly_formatted(files)
        names = sorted({line.split(":")[0] for line in found})
        self.assertEqual(found, [], f"\nRemedy: clang-format -i {' '.join(names)}")

    def test_bad_formatting_is_detected(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "a.cpp")
            file.write_text("int  f( ){return 1 ;}\n")
            self.assertNotEqual(badly_formatted([file]), [])
            file.write_text("int f() {\n    return 1;\n}\n")
            self.assertEqual(badly_formatted([file]), [])

    def test_shell_scripts_parse(self):
        scripts = [*ROOT.glob("deploy/*.sh"), ROOT / ".ci" / "run"]
        self.assertGreater(len(scripts), 2)
        for script in scripts:
            with self.subTest(script=script.name):
                done = subprocess.run(["bash", "-n", script], capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertTrue(script.stat().st_mode & 0o100, f"{script} cannot be run: chmod +x")


if __name__ == "__main__":
    unittest.main()
