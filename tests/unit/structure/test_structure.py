# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""The tree follows the rules, and the checker detects each violation."""

import tempfile
import unittest
from pathlib import Path

import structure

HEADER = "// SPDX-License-Identifier: Apache-2.0\n// Copyright the NeoETI authors\n"
WORD = structure.forbidden_words()[0]


def violations(files):
    """The checker's output for a tree made of {path: text}."""
    with tempfile.TemporaryDirectory() as folder:
        for path, text in files.items():
            file = Path(folder, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        return structure.check(folder)


def including(path, target):
    """A tree of one source that includes `target`, in quotes or angle brackets."""
    return {path: f"{HEADER}#include {target}\n"}


class ThisTree(unittest.TestCase):
    def test_source_tree_follows_the_rules(self):
        found = structure.check(structure.HERE.parents[2])
        self.assertEqual(found, [], "\n" + "\n".join(found))

    def test_source_tree_is_actually_read(self):
        read = {p.as_posix() for p in structure.source_files(structure.HERE.parents[2])}
        self.assertLessEqual({"idl/eti.idl", "common/bus/bus.hpp", "cmake/targets.cmake", "deploy/setup.sh"}, read)


class Includes(unittest.TestCase):
    def test_allowed_includes_pass(self):
        for path, target in (
            ("common/bus/a.cpp", '"common/math/transform.hpp"'),
            ("common/bus/a.cpp", '"idl/eti_wire.hpp"'),
            ("common/bus/a.cpp", "<fastdds/dds/domain/DomainParticipant.hpp>"),
            ("server/scene/a.cpp", '"server/pbd/solver.hpp"'),
            ("server/app/a.cpp", '"common/bus/bus.hpp"'),
            ("server/app/a.cpp", '"server/patient/newborn/build/build.hpp"'),
            ("server/patient/tool/a.cpp", '"server/patient/imaging/read.hpp"'),
            ("server/rigid/a.cpp", "<btBulletDynamicsCommon.h>"),
            ("client/render/a.cpp", "<epoxy/gl.h>"),
            ("client/hmd/a.cpp", "<openxr/openxr.h>"),
            ("server/app/a.cpp", "<tbb/global_control.h>"),
            ("common/process/command_line.cpp", "<CLI/CLI.hpp>"),
            ("tests/unit/server/pbd/a.cpp", '"server/pbd/solver.hpp"'),
            ("tests/unit/server/pbd/a.cpp", '"particles_at_rest.hpp"'),
            ("tests/validation/a.cpp", '"server/scene/scene.hpp"'),
        ):
            with self.subTest(path=path, target=target):
                self.assertEqual(violations(including(path, target)), [])

    def test_forbidden_includes_are_detected(self):
        for path, target in (
            ("common/math/a.cpp", '"server/pbd/solver.hpp"'),
            ("server/pbd/a.cpp", '"server/rigid/world.hpp"'),
            ("server/rigid/a.cpp", '"server/pbd/solver.hpp"'),
            ("server/pbd/a.cpp", '"common/bus/bus.hpp"'),
            ("server/scene/a.cpp", '"server/patient/newborn/build/build.hpp"'),
            ("server/app/a.cpp", '"server/patient/imaging/read.hpp"'),
            ("server/patient/model/a.cpp", '"server/patient/newborn/build/build.hpp"'),
            ("server/scene/a.cpp", '"idl/eti_wire.hpp"'),
            ("server/metrics/a.cpp", '"common/bus/topics.hpp"'),
            ("server/app/a.cpp", '"client/view/view.hpp"'),
            ("server/app/a.cpp", "<fastdds/dds/domain/DomainParticipant.hpp>"),
            ("server/scene/a.cpp", "<btBulletDynamicsCommon.h>"),
            ("server/app/a.cpp", "<epoxy/gl.h>"),
            ("server/pbd/a.cpp", "<tbb/parallel_for.h>"),
            ("devices/app/a.cpp", '"server/scene/snapshot.hpp"'),
            ("devices/app/a.cpp", '"client/view/view.hpp"'),
            ("client/view/a.cpp", '"server/scene/snapshot.hpp"'),
            ("client/view/a.cpp", "<hdf5.h>"),
            ("client/app/a.cpp", "<openxr/openxr.h>"),
            ("client/app/a.cpp", "<CLI/CLI.hpp>"),
            ("common/process/a.cpp", "<CLI/App.hpp>"),
            ("tests/bench/a.cpp", "<CLI/CLI.hpp>"),
            ("tests/unit/client/a.cpp", '"server/scene/snapshot.hpp"'),
            ("server/pbd/a.cpp", '"solver.hpp"'),
            ("elsewhere/a.cpp", '"common/math/transform.hpp"'),
        ):
            with self.subTest(path=path, target=target):
                found = violations(including(path, target))
                self.assertEqual(len(found), 1, found)
                self.assertTrue(found[0].startswith(f"{path}:3: "), found)

    def test_library_versions_are_known_in_one_place(self):
        for line in ("#if ETI_FASTDDS >= 3", "#include <fastrtps/config.h>", "using eprosima::fastrtps::Duration_t;"):
            with self.subTest(line=line):
                self.assertEqual(violations({"common/bus/fastdds/a.cpp": f"{HEADER}{line}\n"}), [])
                found = violations({"common/bus/a.cpp": f"{HEADER}{line}\n"})
                self.assertEqual(found, ["common/bus/a.cpp:3: depends on the version of Fast DDS; what differs stays in "
                                         "common/bus/fastdds"])

    def test_circular_folder_includes_are_detected(self):
        found = violations(including("common/mesh/a.cpp", '"common/model/b.hpp"')
                           | including("common/model/b.cpp", '"common/mesh/a.hpp"'))
        self.assertEqual(len(found), 1, found)
        self.assertIn("circle", found[0])

    def test_circular_header_includes_are_detected(self):
        header = HEADER + "#pragma once\n#include "
        found = violations({"common/mesh/a.hpp": header + '"common/mesh/b.hpp"\n',
                            "common/mesh/b.hpp": header + '"common/mesh/a.hpp"\n'})
        self.assertEqual(found, ["common/mesh/a.hpp: files include each other in a circle: "
                                 "common/mesh/a.hpp -> common/mesh/b.hpp -> common/mesh/a.hpp"])

    def test_circular_patient_folder_includes_are_detected(self):
        found = violations(including("server/patient/tool/a.cpp", '"server/patient/segmentation/b.hpp"')
                           | including("server/patient/segmentation/b.cpp", '"server/patient/tool/a.hpp"'))
        self.assertIn("circle", " ".join(found))


class Files(unittest.TestCase):
    def only(self, files, expected):
        found = violations(files)
        self.assertEqual(len(found), 1, found)
        self.assertIn(expected, found[0])

    def test_clean_tree_has_no_violations(self):
        self.assertEqual(violations({
            "common/math/a.hpp": HEADER + "#pragma once\n",
            "deploy/run.sh": "#!/bin/sh\n" + HEADER.replace("//", "#"),
            "CMakeLists.txt": HEADER.replace("//", "#"),
            "build/generated.cpp": "no header here\n",
            "notes.md": WORD + "\n",
        }), [])

    def test_missing_licence_header_is_detected(self):
        for path in ("a.cpp", "a.py", "a.sh", "a.idl", "a.cmake", "CMakeLists.txt"):
            with self.subTest(path=path):
                self.only({f"common/math/{path}": "\n"}, "SPDX")

    def test_missing_pragma_once_is_detected(self):
        self.only({"common/math/a.hpp": HEADER}, "#pragma once")

    def test_forbidden_words_are_detected_in_any_case(self):
        for word in structure.forbidden_words():
            for written in (word, word.upper(), word.capitalize()):
                with self.subTest(word=written):
                    self.only({"common/math/a.cpp": f"{HEADER}// {written}: later\n"}, ":3: says")

    def test_words_containing_a_forbidden_word_pass(self):
        self.assertEqual(violations({"common/math/a.cpp": f"{HEADER}int un{WORD}ne;\n"}), [])

    def test_non_executable_documented_command_is_detected(self):
        script = {"tests/sweep.py": HEADER.replace("//", "#")}
        for line in ("tests/sweep.py --count 3", "ETI_BIN=bin tests/sweep.py", "as `tests/sweep.py` does"):
            with self.subTest(line=line):
                self.only({**script, "docs/a.md": line + "\n"}, "docs/a.md:1: tests/sweep.py cannot be run")
        self.assertEqual(violations({**script, "docs/a.md": "python3 tests/sweep.py\n"}), [])

    def test_disabled_test_is_detected(self):
        self.only({"tests/unit/a.cpp": HEADER + "TEST(Solver, DISABLED" + "_converges) {}\n"}, "switches a test off")

    def test_long_file_must_state_its_reason(self):
        filling = "\n" * structure.LONG_FILE
        self.only({"common/math/a.cpp": HEADER + filling}, "split it")
        reason = "// Over 600 lines: one table of the wire's values.\n"
        self.assertEqual(violations({"common/math/a.cpp": HEADER + reason + filling}), [])


if __name__ == "__main__":
    unittest.main()
