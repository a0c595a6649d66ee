# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Everything that a build reads and a script runs comes from the lists of deploy/packages: nothing is missing on a bare
system.

A bare system is debootstrap's variant minbase: Debian's required packages, and apt, plus the packages of the lists with
their dependencies. Files that belong to no such package are detected: they exist here because they were installed for
another reason, and are missing elsewhere. ETI_BUILD names the build folder.
"""

import ast
import os
import platform
import re
import subprocess
import sys
import tempfile
import unittest
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
BUILD = Path(os.environ.get("ETI_BUILD", ROOT / "build/release"))
RELEASE = platform.freedesktop_os_release().get("VERSION_CODENAME", "")
SERVER, PROGRAMS = ("build",), ("build", "client")
TESTS = (*PROGRAMS, "test", "figures", "lab", "security")

# Lists that a script installs before it runs anything below them; tests have all of test.sh.
SCRIPTS = {
    "deploy/setup.sh": (), "deploy/progress.sh": (),      # these run before anything is installed
    "deploy/demo.sh": PROGRAMS, "deploy/session_run.py": PROGRAMS, "idl/wire.py": SERVER,
    "deploy/lab.sh": (*PROGRAMS, "lab"), "deploy/lab/*.py": (*PROGRAMS, "lab"),
    "deploy/security/*": ("security",),
    "deploy/figures.sh": TESTS, "docs/*.py": TESTS,
    "deploy/test.sh": TESTS, "deploy/counted.sh": TESTS, "tests/**/*.py": TESTS,
    "deploy/sanitize.sh": (*TESTS, "fuzz", "library"), "deploy/sanitized_library.sh": (*PROGRAMS, "fuzz", "library"),
    "deploy/package.sh": (*PROGRAMS, "package"), "deploy/try_packages.sh": (*PROGRAMS, "package"),
    "deploy/bare.sh": ("bare",), "deploy/try_bare.sh": ("bare",),
}
# Programs that a script runs only where they exist, or through what it has just installed.
OPTIONAL = {
    ("deploy/setup.sh", "cmake"), ("deploy/setup.sh", "npm"), ("deploy/setup.sh", "node"),
    ("deploy/setup.sh", "sudo"),
    ("deploy/try_bare.sh", "git"),      # without a clone, files are copied without it
    ("tests/unit/deploy/test_build_options.py", "node"),    # a name that the test gives to a script of its own
    ("tests/unit/deploy/test_build_options.py", "clang++-16"),    # skipped without it
    ("tests/system/install/test_packages.py", "lintian"),         # skipped without it
    ("tests/unit/structure/test_contributing.py", "git"),   # history is compared where there is one
}

# Found by CMake's modules in addition, but used by no build here: dependencies of static libraries, X11's extensions. A
# Node.js from another source works as well as Debian's.
FOUND_BESIDES = re.compile(r"X11_(?!X11)|HDF5_DIFF|\w+_STATIC_|pkgcfg_lib_IMGUI|ETI_NODE|ETI_NPM|"
                           r"\w*FONTCONFIG|FREETYPE|Fontconfig")


@cache
def installed():
    """For each installed package: whether a bare system has it, its dependencies (alternatives), what it provides."""
    listed = subprocess.run(
        ["dpkg-query", "-W", "-f",
         "${Package}\t${Essential}\t${Priority}\t${db:Status-Status}\t${Pre-Depends}, ${Depends}\t${Provides}\n"],
        capture_output=True, text=True, check=True).stdout
    packages, provided = {}, {}
    for line in listed.splitlines():
        name, essential, priority, status, depends, provides = line.split("\t")
        if status != "installed":
            continue
        wanted = [[re.sub(r"[ :(].*", "", one.strip()) for one in alternatives.split("|")]
                  for alternatives in depends.split(",") if alternatives.strip()]
        packages[name] = (essential == "yes" or priority == "required" or name == "apt", wanted)
        for virtual in provides.split(","):
            provided.setdefault(re.sub(r"[ :(].*", "", virtual.strip()), []).append(name)
    return packages, provided


@cache
def closure(lists):
    """Packages of a bare system and of the lists, with their dependencies."""
    packages, provided = installed()
    pending = [name for name, (bare, _) in packages.items() if bare]
    for name in lists:
        text = re.sub(r"#.*", "", (ROOT / f"deploy/packages/{name}.txt").read_text())
        pending += [package for package, release in re.findall(r"^(\S+)(?:[ \t]+\[(\w+)\])?", text, re.MULTILINE)
                    if release in ("", RELEASE)]
    found = set()
    while pending:
        name = pending.pop()
        if name in found or name not in packages:
            continue
        found.add(name)
        for alternatives in packages[name][1]:
            here = [one for one in alternatives if one in packages]
            pending += here[:1] or next((provided[one][:1] for one in alternatives if one in provided), [])
    return found


@cache
def owners():
    """Package of each installed file, and of each folder that only one package has."""
    found = {}
    for file in Path("/var/lib/dpkg/info").glob("*.list"):
        name = file.stem.partition(":")[0]
        for path in file.read_text().splitlines():
            found.setdefault(path, set()).add(name)
    return found


def owned_by(path):
    """Packages that a file belongs to, by any path of links; empty if none."""
    for one in (path, os.path.realpath(path)):
        for spelt in (one, one.removeprefix("/usr"), "/usr" + one):
            if spelt in owners():
                return owners()[spelt]
    return set()


def from_elsewhere(paths, lists):
    """Existing files that no package of a bare system with these lists provides."""
    out = []
    for path in sorted(set(paths)):
        packages = owned_by(path)
        if os.path.exists(path) and not packages & closure(lists):
            out.append(f"{path} ({', '.join(sorted(packages)) or 'no package'})")
    return out


def found_by_cmake(cache_file):
    """Files and folders that configuring found outside the checkout and the build folder."""
    for line in cache_file.read_text().splitlines():
        name, _, value = line.partition("=")
        if not FOUND_BESIDES.match(name) and re.search(r":(FILEPATH|PATH|INTERNAL|STRING)$", name) and not name.startswith("CMAKE_INSTALL"):
            for path in value.split(";"):
                if path.startswith(("/usr/", "/opt/", "/bin/", "/lib")) and os.path.exists(path):
                    yield path


def commands_of_shell(text):
    text = re.sub(r"<<-?\s*'?(\w+)'?.*?\n\1\b", "", text, flags=re.DOTALL)
    text = re.sub(r"(^|\s)#.*", r"\1", text)
    # Quoted text, unless it contains a command substitution; by lines, because such a one leaves its second quotation
    # mark behind.
    text = re.sub(r"'[^'\n]*'" + r'|"(?:[^"\\$\n]|\\.|\$(?!\())*"', "''", text)
    own = set(re.findall(r"^\s*(\w+)\(\)", text, re.MULTILINE)) | {"kill", "echo", "printf", "test", "true", "false"}
    before = r"(?:^|[|;&(!{]|\b(?:then|do|else|if|elif|while|until|exec|sudo|command -v)\s)\s*"
    return set(re.findall(before + r"([a-z][a-z0-9+-]*)(?=[\s;)]|$)", text, re.MULTILINE)) - own


def commands_of_python(text):
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.List, ast.Tuple)) and node.elts:
            head = node.elts[0]
        elif isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "which" and node.args:
            head = node.args[0]
        else:
            continue
        if isinstance(head, ast.Constant) and isinstance(head.value, str) and re.fullmatch(r"[\w.+-]+", head.value):
            yield head.value


def modules_of_python(file):
    """Third-party modules that a script imports, as files."""
    local = {path.stem for path in ROOT.rglob("*.py") if "build" not in path.parts}
    for node in ast.walk(ast.parse(file.read_text())):
        names = [one.name for one in node.names] if isinstance(node, ast.Import) else \
                [node.module or ""] if isinstance(node, ast.ImportFrom) and node.level == 0 else []
        for name in {one.partition(".")[0] for one in names} - set(sys.stdlib_module_names) - local:
            for folder in ("/usr/lib/python3/dist-packages", "/usr/local/lib/python3.11/dist-packages"):
                for path in (f"{folder}/{name}/__init__.py", f"{folder}/{name}.py"):
                    if os.path.exists(path):
                        yield path


class PackageLists(unittest.TestCase):
    maxDiff = None

    def assert_none(self, missing, lists):
        self.assertEqual(missing, [], f"these come with no package of deploy/packages/{{{','.join(lists)}}}.txt; add the "
                                      "package that brings each to one of them")

    def test_program_configure_dependencies_are_listed(self):
        for lists, options in ((SERVER, ["-DETI_CLIENT=OFF"]), (PROGRAMS, [])):
            with self.subTest(lists=lists), tempfile.TemporaryDirectory() as folder:
                subprocess.run(["cmake", "--preset", "release", "-S", ROOT, "-B", folder, "-DETI_TESTS=OFF",
                                "-DETI_NPM=OFF", *options], cwd=ROOT, check=True, capture_output=True)
                self.assert_none(from_elsewhere(found_by_cmake(Path(folder, "CMakeCache.txt")), lists), lists)

    def test_test_configure_dependencies_are_listed(self):
        self.assert_none(from_elsewhere(found_by_cmake(BUILD / "CMakeCache.txt"), TESTS), TESTS)

    def test_every_included_header_is_listed(self):
        read = {PROGRAMS: set(), TESTS: set()}
        lists = TESTS
        with subprocess.Popen(["ninja", "-C", BUILD, "-t", "deps"], stdout=subprocess.PIPE, text=True) as deps:
            for line in deps.stdout:
                if not line.startswith(" "):
                    # Newer versions of CMake also note what a program is linked with, tests' programs in any folder.
                    is_programs = ".o: " in line and not line.startswith("tests/")
                    lists = PROGRAMS if is_programs else TESTS
                elif line.startswith("    /usr/"):
                    read[lists].add(line.strip())
        self.assertGreater(len(read[PROGRAMS]), 1000, "no headers found: is this folder built?")
        for lists, files in read.items():
            self.assert_none(from_elsewhere(files, lists), lists)

    def test_every_script_command_is_listed(self):
        for pattern, lists in SCRIPTS.items():
            missing = []
            for file in sorted(ROOT.glob(pattern)):
                if file.suffix not in (".py", ".sh"):
                    continue
                name, text = str(file.relative_to(ROOT)), file.read_text()
                called = commands_of_python(text) if file.suffix == ".py" else commands_of_shell(text)
                paths = [f"{folder}/{one}" for one in called for folder in ("/usr/bin", "/usr/sbin", "/bin", "/sbin")
                         if (name, one) not in OPTIONAL]
                if file.suffix == ".py":
                    paths += modules_of_python(file)
                missing += [f"{name}: {one}" for one in from_elsewhere(paths, lists)]
            with self.subTest(scripts=pattern):
                self.assert_none(missing, lists)

    def test_unpackaged_file_is_detected(self):
        self.assertEqual(from_elsewhere(["/usr/bin/dpkg-query", "/usr/include/zlib.h"], ()),
                         ["/usr/include/zlib.h (zlib1g-dev)"])
        self.assertEqual(from_elsewhere(["/usr/include/zlib.h"], SERVER), [])
        with tempfile.NamedTemporaryFile() as file:
            self.assertEqual(from_elsewhere([file.name], TESTS), [f"{file.name} (no package)"])


if __name__ == "__main__":
    unittest.main()
