# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""package.sh, try_packages.sh and try_bare.sh: what they reject, and with what remedy."""

import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]


class PackageScripts(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        self.bin = self.folder / "bin"
        self.bin.mkdir()

    def program(self, name, text):
        file = self.bin / name
        file.write_text(f"#!/bin/sh\n{text}\n")
        file.chmod(0o755)

    def run_script(self, script, *arguments):
        return subprocess.run([ROOT / "deploy" / script, *arguments], capture_output=True, text=True,
                              env={**os.environ, "PATH": f"{self.bin}:{os.environ['PATH']}"})

    def test_scripts_print_help_and_refuse_unknown_options(self):
        for script in ("package.sh", "try_packages.sh", "try_bare.sh"):
            self.assertIn("--no-install", self.run_script(script, "--help").stdout)
            self.assertEqual(self.run_script(script, "--bogus").returncode, 2)

    def test_failed_cpack_is_reported_and_leaves_no_packages(self):
        self.program("cpack", "echo 'no such program'; exit 1")
        done = self.run_script("package.sh", "--no-build", "--no-install", "--out", self.folder / "out")
        self.assertEqual(done.returncode, 1)
        self.assertIn("no such program", done.stderr)
        self.assertIn("without --no-build", done.stderr)
        self.assertEqual(list((self.folder / "out").iterdir()), [])

    def test_trial_install_needs_root(self):
        self.program("id", "echo 1000")
        for script in ("try_packages.sh", "try_bare.sh"):
            done = self.run_script(script, "--no-install")
            self.assertEqual(done.returncode, 1)
            self.assertIn("needs root", done.stderr)

    def test_trial_install_needs_namespaces_and_mirror(self):
        for script in ("try_packages.sh", "try_bare.sh"):
            self.program("id", "echo 0")
            self.program("unshare", "exit 1")
            self.program("apt-get", "exit 0")
            self.assertIn("mount namespaces", self.run_script(script, "--no-install").stderr)
            self.program("unshare", "exit 0")
            self.program("apt-get", "exit 1")
            done = self.run_script(script, "--no-install")
            self.assertEqual(done.returncode, 1)
            self.assertIn("--mirror", done.stderr)

    def test_trial_install_refuses_another_release(self):
        self.program("id", "echo 0")
        self.program("unshare", "exit 0")
        (self.folder / "neoeti_0.1.0+deb12_all.deb").touch()
        done = self.run_script("try_packages.sh", "--no-install", "--packages", self.folder, "--release", "13",
                               "--mirror", "http://localhost")
        self.assertEqual(done.returncode, 1)
        for part in ("not built on Debian 13", "found neoeti_0.1.0+deb12_all.deb", "--release"):
            self.assertIn(part, done.stderr)

    def test_bare_system_trial_lists_valid_users_and_parts(self):
        for option, value, expected in (("--as", "guest", "root or user"), ("--only", "lab", "demo or test")):
            done = self.run_script("try_bare.sh", option, value)
            self.assertEqual(done.returncode, 1)
            self.assertIn(expected, done.stderr)

    def test_bare_system_trial_needs_a_compiler_cache(self):
        self.program("id", "echo 0")
        self.program("unshare", "exit 0")
        done = self.run_script("try_bare.sh", "--no-install", "--mirror", "http://localhost", "--cache", self.folder)
        self.assertEqual(done.returncode, 1)
        self.assertIn(f"--cache {self.folder}: no compiler cache", done.stderr)


if __name__ == "__main__":
    unittest.main()
