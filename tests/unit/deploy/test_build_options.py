# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Every preset can be configured, and a build without the client looks for no graphics package."""

import json
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]


def configure(preset, *options):
    """The CMake cache that configuring gives."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(["cmake", "--preset", preset, "-S", ROOT, "-B", folder, *options], cwd=ROOT,
                              capture_output=True, text=True)
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        return Path(folder, "CMakeCache.txt").read_text()


class BuildOptions(unittest.TestCase):
    def test_every_preset_configures(self):
        presets = json.loads((ROOT / "CMakePresets.json").read_text())["configurePresets"]
        names = [preset["name"] for preset in presets if not preset.get("hidden")]
        self.assertEqual(names, ["release", "debug", "asan", "tsan", "fuzz"])
        if shutil.which("clang++-16") is None:
            names.remove("fuzz")
        for name in names:
            with self.subTest(preset=name):
                self.assertIn("CMAKE_BUILD_TYPE", configure(name))

    def test_server_alone_needs_no_graphics(self):
        graphics = re.compile(r"^[^/#].*(epoxy|opencv|glfw|imgui|opengl|egl)\w*[:_=]", re.IGNORECASE | re.MULTILINE)
        self.assertRegex(configure("release"), graphics)
        self.assertNotRegex(configure("release", "-DETI_CLIENT=OFF"), graphics)


if __name__ == "__main__":
    unittest.main()
