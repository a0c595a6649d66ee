# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Every preset can be configured, a build without the client needs no graphics package, and other versions of tools
first on the path do no harm, or are reported."""

import json
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]


def run_cmake(folder, preset, *options, **environment):
    inherited = {name: value for name, value in os.environ.items()
                 if name not in ("CCACHE_DIR", "CMAKE_C_COMPILER_LAUNCHER", "CMAKE_CXX_COMPILER_LAUNCHER")}
    return subprocess.run(["cmake", "--preset", preset, "-S", ROOT, "-B", folder, *options], cwd=ROOT, capture_output=True,
                          text=True, env={**inherited, **environment})


def configure(preset, *options, **environment):
    """The CMake cache after configuring, without the packages of the report's page."""
    with tempfile.TemporaryDirectory() as folder:
        done = run_cmake(folder, preset, "-DETI_NPM=OFF", *options, **environment)
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

    def test_old_python_and_node_on_path_are_skipped(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, says in (("python3", "Python 3.6.9"), ("node", "v12.22.9")):
                file = Path(folder, name)
                file.write_text(f"#!/bin/sh\necho {says}\n")
                file.chmod(0o755)
            found = configure("release", "-DETI_TESTS=OFF", PATH=f"{folder}:{os.environ['PATH']}")
        self.assertIn("ETI_PYTHON:FILEPATH=/usr/bin/python3\n", found)
        self.assertIn("ETI_NODE:FILEPATH=/usr/bin/node\n", found)

    def test_unwritable_home_places_cache_in_build_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            for home, expected in (("/proc/none", "CCACHE_DIR"), (folder, "CCACHE_BASEDIR")):
                with tempfile.TemporaryDirectory() as build:
                    done = run_cmake(build, "release", "-DETI_TESTS=OFF", "-DETI_CLIENT=OFF", HOME=home,
                                     XDG_CACHE_HOME=f"{home}/.cache")
                    self.assertEqual(done.returncode, 0, done.stderr)
                    # CMake 3.25 writes the compiler's launcher into the rules, 3.31 beside each source.
                    written = "".join(Path(build, name).read_text() for name in ("CMakeFiles/rules.ninja", "build.ninja"))
                settings = set(re.findall("CCACHE_[A-Z]+", written))
                self.assertIn(expected, settings)
                self.assertEqual("CCACHE_DIR" in settings, expected == "CCACHE_DIR")

    def test_missing_googlemock_error_contains_remedy(self):
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as build:
            Path(folder, "GTestConfig.cmake").write_text("set(GTest_FOUND TRUE)\n")
            Path(folder, "GTestConfigVersion.cmake").write_text("set(PACKAGE_VERSION 1.11)\nset(PACKAGE_VERSION_COMPATIBLE TRUE)\n")
            done = run_cmake(build, "release", "-DETI_NPM=OFF", "-DETI_CLIENT=OFF", f"-DGTest_DIR={folder}")
        self.assertNotEqual(done.returncode, 0)
        said = " ".join(done.stderr.split())
        for part in (folder, "no GoogleMock", "libgmock-dev"):
            self.assertIn(part, said)


if __name__ == "__main__":
    unittest.main()
