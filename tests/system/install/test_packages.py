# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""The Debian packages: their contents, dependencies, and that the server runs from them."""

import json
import platform
import re
import shutil
import subprocess
import unittest

import package_files
from package_files import COMPILED, NAMES, contents, field, packages
from support import ROOT, Case

# Programs that run scripts of this tree.
IN_TREE = {"eti-bench-bus"}
BUILD_VERSION = re.search(r"VERSION (\S+) DESC", (ROOT / "CMakeLists.txt").read_text()).group(1)
# With the release of Debian that the packages are for.
PACKAGE_VERSION = f"{BUILD_VERSION}+deb{platform.freedesktop_os_release()['VERSION_ID']}"
# Libraries whose package is named after their version, by release.
LIBRARIES = {
    "bookworm": {"server": ["libfastrtps2.9", "libbullet3.24", "libhdf5-103-1", "libyaml-cpp0.7"],
                 "client": ["libfastrtps2.9", "libopencv-videoio406"], "devices": ["libfastrtps2.9"],
                 "tools": ["libgdcm3.0", "libhdf5-103-1"]},
    "trixie": {"server": ["libfastdds3.1", "libbullet3.24t64", "libhdf5-310", "libyaml-cpp0.8"],
               "client": ["libfastdds3.1", "libopencv-videoio410"], "devices": ["libfastdds3.1"],
               "tools": ["libgdcm3.0t64", "libhdf5-310"]},
}[platform.freedesktop_os_release()["VERSION_CODENAME"]]


class Packages(Case):
    def setUp(self):
        super().setUp()
        self.packages = packages()
        self.files = {name: contents(file) for name, file in self.packages.items()}

    def test_every_program_is_in_its_package(self):
        self.assertEqual(sorted(self.packages), sorted(NAMES))
        for package, programs in {
            "neoeti-server": ["server"], "neoeti-client": ["client"], "neoeti": ["demo"],
            "neoeti-devices": ["haptics", "tracker", "controller", "calibrate", "parts"],
            "neoeti-tools": ["anatomy", "review", "doctor", "discovery", "bench", "bench-physics", "bench-devices"],
        }.items():
            self.assertLessEqual({f"/usr/bin/eti-{program}" for program in programs}, self.files[package])
        packed = {path.rpartition("/")[2] for files in self.files.values() for path in files if "/bin/" in path}
        built = {program.name for program in package_files.BIN.glob("eti-*")}
        self.assertEqual(built - packed, IN_TREE, "built, and in no package")

    def test_data_and_documents_match_source_tree(self):
        data = self.files["neoeti-data"]
        for kind in ("scenarios", "operators", "presets", "hands", "dds", "calibration", "parts"):
            for file in (ROOT / "deploy/data" / kind).iterdir():
                self.assertIn(f"/usr/share/neoeti/{kind}/{file.name}", data)
        for page in (ROOT / "docs").rglob("*.md"):
            self.assertIn(f"/usr/share/doc/neoeti-doc/{page.relative_to(ROOT)}", self.files["neoeti-doc"])
        self.assertIn("/usr/share/neoeti/session_run.py", self.files["neoeti"])
        for name, files in self.files.items():
            self.assertLessEqual({f"/usr/share/doc/{name}/copyright", f"/usr/share/doc/{name}/changelog.gz"}, files)

    def test_services_have_units_settings_and_user(self):
        for package, services in {"neoeti-server": ["server"], "neoeti-devices": ["haptics", "tracker"]}.items():
            settings = {f"/etc/neoeti/conf.d/{service}.conf" for service in services}
            units = {f"/usr/lib/systemd/system/eti-{service}@.service" for service in services}
            self.assertLessEqual(settings | units, self.files[package])
            kept = subprocess.run(["dpkg-deb", "-I", self.packages[package], "conffiles"], stdout=subprocess.PIPE,
                                  text=True, check=True).stdout.split()
            self.assertEqual(set(kept), settings)
        self.assertIn("/usr/lib/sysusers.d/neoeti.conf", self.files["neoeti-data"])

    def test_no_file_is_in_two_packages(self):
        every = [path for files in self.files.values() for path in files]
        self.assertEqual(len(every), len(set(every)), sorted(path for path in set(every) if every.count(path) > 1))

    def test_control_fields_declare_dependencies(self):
        for name, file in self.packages.items():
            self.assertEqual(field(file, "Version"), PACKAGE_VERSION)
            self.assertIn(f"_{PACKAGE_VERSION}_", file.name)
            self.assertEqual(field(file, "Architecture") == "all", name[7:] not in COMPILED, name)
            self.assertLess(len(field(file, "Description").splitlines()[0]), 80)
            for part in field(file, "Depends").split(", "):
                if part.startswith("neoeti"):
                    self.assertTrue(part.endswith(f" (= {PACKAGE_VERSION})"), f"{name} depends on {part}")
        for package, needed in {
            "neoeti-server": [*LIBRARIES["server"], "libtbb12"],
            "neoeti-client": [*LIBRARIES["client"], "libepoxy0", "libgl1-mesa-dri", "libegl1", "libopenxr-loader1"],
            "neoeti-devices": [*LIBRARIES["devices"], "libglfw3"],
            "neoeti-tools": LIBRARIES["tools"],
            "neoeti": [name for name in NAMES if name not in ("neoeti", "neoeti-doc")] + ["python3"],
        }.items():
            depends = {part.split()[0] for part in field(self.packages[package], "Depends").split(", ")}
            self.assertLessEqual(set(needed), depends, package)
        graphics = re.compile(r"epoxy|mesa|libgl|opencv|libegl")
        self.assertNotRegex(field(self.packages["neoeti-server"], "Depends"), graphics)

    def test_changelog_matches_version(self):
        first = (ROOT / "deploy/debian/changelog").read_text().splitlines()[0]
        self.assertIn(f"({BUILD_VERSION})", first)

    def test_no_file_contains_a_build_path(self):
        package_files.unpack(self.folder, *self.packages.values())
        for path in self.folder.rglob("*"):
            if path.is_file() and not path.is_symlink():
                self.assertNotIn(str(ROOT).encode(), path.read_bytes(), path)

    def test_lintian_finds_no_error(self):
        if shutil.which("lintian") is None:
            self.skipTest("no lintian here")
        done = subprocess.run(["lintian", "--allow-root", "--fail-on", "error", "--suppress-tags",
                               "bogus-mail-host,bogus-mail-host-in-debian-changelog", *self.packages.values()],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout)


class Unpacked(Case):
    """Outside of the tree that they were built in."""

    def setUp(self):
        super().setUp()
        made = packages()
        package_files.unpack(self.folder, made["neoeti-server"], made["neoeti-data"], made["neoeti"])
        self.bin = self.folder / "usr/bin"

    def run_program(self, *command):
        return subprocess.run([self.bin / command[0], *command[1:]], capture_output=True, text=True, timeout=120,
                              cwd="/")

    def test_server_runs_with_packaged_data(self):
        done = self.run_program("eti-server", "--fast", "--no-dds", "--operator", "expert", "--steps", "20", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["steps"], 20)

    def test_names_are_resolved_in_packaged_data_only(self):
        done = self.run_program("eti-server", "--fast", "--no-dds", "--scenario", "nobody")
        self.assertEqual(done.returncode, 1)
        self.assertIn(str(self.folder / "usr/share/neoeti/scenarios"), done.stderr)
        self.assertNotIn(str(ROOT), done.stderr)
        # Files are read from there: an additional one beside them is found.
        shutil.copy(self.folder / "usr/share/neoeti/scenarios/term.yaml",
                    self.folder / "usr/share/neoeti/scenarios/nobody.yaml")
        done = self.run_program("eti-server", "--fast", "--no-dds", "--scenario", "nobody", "--steps", "1", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_demo_prints_help_and_forwards_options(self):
        self.assertIn("--scenario", self.run_program("eti-demo", "--help").stdout)
        done = self.run_program("eti-demo", "--out", self.folder / "out")
        self.assertEqual(done.returncode, 1)
        self.assertIn("lacks eti-haptics", done.stderr)  # of packages that were not unpacked here


if __name__ == "__main__":
    unittest.main()
