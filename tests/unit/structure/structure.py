# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Rules for the source tree: permitted includes, and the form of every file.

Usage: structure.py [ROOT]. Prints one line per violation, FILE:LINE: finding and remedy.
"""

import os
import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
TOP = ("common", "server", "devices", "client", "deploy", "idl")
NOT_SOURCE = {"build", "out", ".git", "__pycache__"}

# Folders that the files of a folder may include, besides their own. The longest matching folder decides. Inside the
# server, only app knows the bus; pbd and rigid are independent.
WITHOUT_BUS = tuple(f"common/{room}" for room in
                    ("device", "hdf5", "math", "mesh", "model", "operator", "process", "scenario", "session"))
MAY_INCLUDE = {
    "idl": (),
    "common": ("idl",),
    "server/parallel": (),
    "server/patient/mesh": WITHOUT_BUS + ("server/parallel",),
    "server/patient/model": WITHOUT_BUS + ("server/parallel",),
    "server/patient/newborn": WITHOUT_BUS + ("server/parallel", "server/patient/mesh", "server/patient/model"),
    "server/patient/imaging": WITHOUT_BUS + ("server/parallel", "server/patient/mesh"),
    "server/patient/segmentation": WITHOUT_BUS + ("server/parallel", "server/patient/mesh", "server/patient/model", "server/patient/newborn",
                                                  "server/patient/imaging"),
    "server/patient/tool": WITHOUT_BUS + ("server/parallel", "server/patient"),
    "server/pbd": WITHOUT_BUS + ("server/parallel",),
    "server/rigid": WITHOUT_BUS,
    "server/scene": WITHOUT_BUS + ("server/parallel", "server/patient/model", "server/pbd", "server/rigid"),
    "server/physiology": (),
    "server/metrics": WITHOUT_BUS + ("server/patient/model", "server/scene", "server/physiology"),
    # A running server needs a patient's model, and the generator behind the cache: none of the offline rooms.
    "server/app": ("common", "idl", "server/parallel", "server/patient/model", "server/patient/newborn", "server/pbd",
                   "server/rigid", "server/scene", "server/physiology", "server/metrics"),
    "devices": ("common", "idl"),
    "client": ("common", "idl"),
    "deploy": ("common/process",),
    "deploy/doctor": ("common", "idl"),
    "deploy/discovery": ("common", "idl"),
    "tests/unit/common": ("common", "idl", "tests"),
    "tests/unit/server": ("common", "idl", "server", "tests"),
    "tests/unit/devices": ("common", "idl", "devices", "tests"),
    "tests/unit/client": ("common", "idl", "client", "tests"),
    "tests": TOP,
}

# Libraries confined to one folder's interface, or to one file.
LIBRARIES = (
    (re.compile(r"fast(dds|rtps|cdr)/"), ("common/bus", "idl"), "Fast DDS"),
    (re.compile(r"openssl/|tinyxml2\.h$"), ("common/bus",), "OpenSSL"),
    (re.compile(r"bt[A-Z]\w*\.h$|Bullet(Collision|Dynamics)/|LinearMath/|bullet/"), ("server/rigid",), "Bullet"),
    (re.compile(r"GLFW/"), ("client", "devices/sensor"), "GLFW"),
    (re.compile(r"(epoxy|EGL|GL|GLES\w*)/|imgui"), ("client",), "graphics"),
    (re.compile(r"openxr/"), ("client/hmd",), "OpenXR"),
    (re.compile(r"AL/"), ("client/sound",), "OpenAL"),
    (re.compile(r"opencv2/"), ("client",), "OpenCV"),
    (re.compile(r"gdcm\w*\.h$"), ("server/patient/imaging",), "GDCM"),
    # app decides the number of threads.
    (re.compile(r"tbb/(?!global_control)"), ("server/parallel",), "oneTBB"),
    (re.compile(r"boost/"), ("client/review",), "Boost"),
    (re.compile(r"nlopt"), ("client/review",), "NLopt"),
    (re.compile(r"hdf5(_hl)?\.h$|H5\w+\.h$"), ("common/hdf5", "common/session"), "HDF5"),
    # Header-only: about ten seconds of compile time for each file that includes it.
    (re.compile(r"CLI/"), ("common/process/command_line.cpp",), "CLI11"),
)

# What differs between the versions of a library is written once.
ONE_PLACE = (
    (re.compile(r"ETI_FASTDDS|eprosima::fastrtps|eprosima::fastcdr|<fastrtps/|<fastdds/[^>]*\.h>"), "common/bus/fastdds",
     "version of Fast DDS"),
)

INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)')
SPDX = ("SPDX-License-Identifier: Apache-2.0", "Copyright the NeoETI authors")
C_SOURCES = {".hpp", ".cpp", ".h", ".c"}
SOURCES = C_SOURCES | {".idl", ".cmake", ".py", ".sh", ".glsl", ".vert", ".frag"}
LONG_FILE = 600


def source_files(root):
    for folder, subfolders, names in os.walk(root):
        subfolders[:] = sorted(d for d in subfolders if d not in NOT_SOURCE)
        for name in sorted(names):
            path = Path(folder, name)
            if path.suffix in SOURCES or name == "CMakeLists.txt":
                yield path.relative_to(root)


def inside(path, folder):
    return path == folder or path.startswith(folder + "/")


def owner_of(path):
    """The key of MAY_INCLUDE that applies to a file."""
    return max((f for f in MAY_INCLUDE if inside(path, f)), key=len, default=None)


def include_violation(path, line):
    """Violation by a line's #include in the file `path`, or None."""
    match = INCLUDE.match(line)
    if not match:
        return None
    target = match.group(1) or match.group(2)
    for library, homes, label in LIBRARIES:
        # Tests may look behind a folder's interface, not behind a file's.
        free = inside(path, "tests") and not any(h.endswith(".cpp") for h in homes)
        if library.search(target) and not free and not any(inside(path, h) for h in homes):
            return f"includes {target}; {label} stays behind {' and '.join(homes)}"
    beside = inside(path, "tests") and "/" not in target  # a helper of these tests
    if match.group(2) or beside:
        return None
    if target.split("/")[0] not in TOP + ("tests",):
        return f'includes "{target}"; write the path from the repository\'s root'
    owner = owner_of(path)
    if owner is None:
        return f"lies outside the known folders ({', '.join(sorted(MAY_INCLUDE))})"
    allowed = MAY_INCLUDE[owner] + (owner,)
    if not any(inside(target, folder) for folder in allowed):
        return f"includes {target}; {owner} may include only {', '.join(sorted(allowed))}"
    return None


def room_of(path):
    return "/".join(path.split("/")[:3 if inside(path, "server/patient") else 2])


def cycle_in(edges):
    """One cycle in the graph {node: nodes it includes} as a list of nodes, or None."""
    done, trail = set(), []

    def visit(node):
        if node in trail:
            return trail[trail.index(node):] + [node]
        if node in done:
            return None
        trail.append(node)
        for following in sorted(edges.get(node, ())):
            if cycle := visit(following):
                return cycle
        trail.pop()
        done.add(node)
        return None

    return next((cycle for node in sorted(edges) if (cycle := visit(node))), None)


def forbidden_words():
    lines = (HERE / "forbidden_words.txt").read_text().splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def check_file(path, lines, forbidden):
    """Violations within one file as (line number, text)."""
    head = lines[:3] if lines and lines[0].startswith("#!") else lines[:2]
    if not all(any(s in line for line in head) for s in SPDX):
        yield 1, "lacks the two-line SPDX header"
    if len(lines) > LONG_FILE and not any(f"{LONG_FILE} lines" in line for line in lines[:15]):
        yield 1, (f"has {len(lines)} lines; split it, or say within its first 15 lines why it passes {LONG_FILE} lines")
    if path.endswith((".hpp", ".h")) and not any(line.strip() == "#pragma once" for line in lines):
        yield 1, "lacks #pragma once"
    for number, line in enumerate(lines, 1):
        if match := forbidden.search(line):
            yield number, f"says '{match.group(0)}'; finish the work, or say what is the case"
        if re.search(r"\bDISABLED_\w", line):
            yield number, "switches a test off; mend the test or remove it"
        for pattern, home, label in ONE_PLACE:
            if Path(path).suffix in C_SOURCES and not inside(path, home) and pattern.search(line):
                yield number, f"depends on the {label}; what differs stays in {home}"
        if Path(path).suffix in C_SOURCES and (text := include_violation(path, line)):
            yield number, text


def told_to_run(line):
    """Scripts of ours that a line of documentation tells the reader to run: a command, or one named in backticks."""
    return re.findall(r"(?:^|`)(?:\w+=\S+ )*((?:tests|deploy)/\S+?\.(?:py|sh))(?=[ `]|$)", line)


def check_documents(root):
    """Scripts that the documentation names but that cannot be run, one string each."""
    for document in sorted([*Path(root).glob("*.md"), *Path(root).glob("docs/**/*.md")]):
        for number, line in enumerate(document.read_text().splitlines(), 1):
            for script in told_to_run(line):
                if not os.access(Path(root) / script, os.X_OK):
                    yield f"{document.relative_to(root)}:{number}: {script} cannot be run; make it executable"


def check(root):
    """All violations under `root`, one string each."""
    forbidden = re.compile(r"\b(" + "|".join(map(re.escape, forbidden_words())) + r")\b", re.IGNORECASE)
    found, rooms, files = [], {}, {}
    for relative in source_files(root):
        path = relative.as_posix()
        lines = (Path(root) / relative).read_text(errors="replace").splitlines()
        found += [f"{path}:{number}: {text}" for number, text in check_file(path, lines, forbidden)]
        for match in filter(None, map(INCLUDE.match, lines)):
            target = match.group(1)
            if target and path.split("/")[0] in TOP:
                files.setdefault(path, set()).add(target)
                if room_of(target) != room_of(path):
                    rooms.setdefault(room_of(path), set()).add(room_of(target))
    for kind, edges in (("rooms", rooms), ("files", files)):
        if cycle := cycle_in(edges):
            found.append(f"{cycle[0]}: {kind} include each other in a circle: {' -> '.join(cycle)}")
    return found + list(check_documents(root))


if __name__ == "__main__":
    violations = check(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE.parents[2])
    print(*violations, sep="\n", end="\n" if violations else "")
    sys.exit(1 if violations else 0)
