# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Counts and exit status of deploy/test.sh, on a small project without compiled code."""

import os
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PROJECT = """
cmake_minimum_required(VERSION 3.22)
project(small LANGUAGES NONE)
enable_testing()
add_custom_target(unit_tests)
add_custom_target(eti-server)
add_custom_target(fuzz_targets)
function(case name label command)
  add_test(NAME ${name} COMMAND sh -c "${command}")
  set_tests_properties(${name} PROPERTIES LABELS "${label}" SKIP_RETURN_CODE 4)
endfunction()
"""


class TestScript(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        (self.root / "deploy").mkdir()
        for name in ("setup.sh", "progress.sh", "counted.sh", "test.sh", "sanitize.sh"):
            shutil.copy(ROOT / "deploy" / name, self.root / "deploy")
        shutil.copy(ROOT / "CMakePresets.json", self.root)

    def run_tests(self, cases, *options, script="test.sh"):
        (self.root / "CMakeLists.txt").write_text(PROJECT + cases)
        return subprocess.run([self.root / "deploy" / script, "--no-install", *options], capture_output=True, text=True)

    def assert_ends_with(self, done, line, code):
        self.assertEqual(done.stdout, line + "\n", done.stderr)
        self.assertEqual(done.returncode, code)

    def test_fuzz_targets_of_both_builds_are_counted(self):
        done = self.run_tests('case(a unit "true")\ncase(b system "true")\ncase(c fuzz "true")\n', "--fuzz")
        self.assert_ends_with(done, "4 passed, 0 failed", 0)
        self.assertTrue((self.root / "build/fuzz").exists())

    def test_passed_tests_are_counted(self):
        done = self.run_tests('case(a unit "true")\ncase(b system "true")\n')
        self.assert_ends_with(done, "2 passed, 0 failed", 0)
        self.assertFalse((self.root / "build/fuzz").exists())

    def test_sanitize_short_runs_only_fuzz_targets(self):
        cases = 'case(a unit "exit 1")\ncase(b fuzz "true")\ncase(c fuzz "exit 1")\n'
        done = self.run_tests(cases, "--short", script="sanitize.sh")
        self.assert_ends_with(done, "1 passed, 1 failed", 1)
        self.assertIn("Failed: c", done.stderr)

    def test_sanitize_runs_unit_tests_and_session_per_build(self):
        # The session's program is missing here, which is a failure of its own.
        done = self.run_tests('case(a unit "true")\ncase(b system "exit 1")\n', "--only", "asan", "--only", "tsan",
                              script="sanitize.sh")
        self.assert_ends_with(done, "2 passed, 2 failed", 1)
        for preset in ("asan", "tsan"):
            self.assertIn(f"Failed: a session by build/{preset}", done.stderr)

    def test_sanitize_refuses_unknown_options(self):
        for options, said in ((("--only", "msan"), "fuzz library asan tsan"), (("--runs", "1e7"), "whole number"),
                              (("--reader", "../x/none"), "--reader"), (("--out",), "--help"), (("--all",), "Usage")):
            with self.subTest(options=options):
                done = self.run_tests("", *options, script="sanitize.sh")
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(said, done.stderr)

    def test_quick_counts_unit_tests_only(self):
        done = self.run_tests('case(a unit "true")\ncase(b scripts "true")\ncase(c system "exit 1")\n', "--quick")
        self.assert_ends_with(done, "2 passed, 0 failed", 0)

    def test_long_tests_run_only_with_whole_option(self):
        cases = 'case(a unit "true")\ncase(b "unit;long" "exit 1")\ncase(c "system;long" "true")\n'
        self.assert_ends_with(self.run_tests(cases), "1 passed, 0 failed", 0)
        self.assert_ends_with(self.run_tests(cases, "--quick"), "1 passed, 0 failed", 0)
        self.assert_ends_with(self.run_tests(cases, "--whole"), "2 passed, 1 failed", 1)

    def test_failed_test_is_counted_and_named(self):
        done = self.run_tests('case(good unit "true")\ncase(broken unit "exit 1")\n', "--quick")
        self.assert_ends_with(done, "1 passed, 1 failed", 1)
        self.assertIn("Failed: broken", done.stderr)

    def test_program_tests_are_retried_once_and_reported(self):
        disturbed = f"test -e {self.root}/tried || ! touch {self.root}/tried"
        done = self.run_tests(f'case(a unit "true")\ncase(b.c+ bench "{disturbed}")\ncase(d system "exit 1")\n')
        self.assert_ends_with(done, "2 passed, 1 failed", 1)
        self.assertIn("Passed at the second try alone: b.c+", done.stderr)
        self.assertIn("Failed: d", done.stderr)

    def test_unit_tests_have_one_try(self):
        done = self.run_tests(f'case(a unit "test -e {self.root}/tried || ! touch {self.root}/tried")\n')
        self.assert_ends_with(done, "0 passed, 1 failed", 1)

    def test_many_failures_are_not_retried(self):
        done = self.run_tests("".join(f'case({name} bench "echo {name} >> {self.root}/tries; exit 1")\n'
                                      for name in "abcd"))
        self.assert_ends_with(done, "0 passed, 4 failed", 1)
        self.assertEqual(len((self.root / "tries").read_text().split()), 4)

    def test_skipped_test_is_named_and_not_counted(self):
        done = self.run_tests('case(good unit "true")\ncase(idle unit "echo skipped: no display; exit 4")\n', "--quick")
        self.assert_ends_with(done, "1 passed, 0 failed", 0)
        self.assertIn("Skipped: idle: skipped: no display", done.stderr)

    def test_each_test_of_a_suite_counts(self):
        good = "echo '[==========] 3 tests from 1 test suite ran. (5 ms total)'; echo '[  PASSED  ] 3 tests.'"
        bad = ("echo '[  SKIPPED ] Odd/Two.Idle (0 ms)'; "
               "echo '[  FAILED  ] Odd/Two.Wrong/1, where GetParam() = 8 (1 ms)'; "
               "echo '[==========] 5 tests from 1 test suite ran. (5 ms total)'; echo '[  PASSED  ] 3 tests.'; "
               "echo '[  SKIPPED ] Odd/Two.Idle'; echo '[  FAILED  ] Odd/Two.Wrong/1, where GetParam() = 8'; exit 1")
        crash = "echo '[ RUN      ] Three.Crashes'; exit 1"
        cases = "".join(f"case({name} unit [=[{says}]=])\n" for name, says in zip("abc", (good, bad, crash)))
        done = self.run_tests(cases, "--quick")
        self.assert_ends_with(done, "6 passed, 2 failed", 1)
        for line in ("Failed: Odd/Two.Wrong/1", "Skipped: Odd/Two.Idle", "Failed: c"):
            self.assertIn(line + "\n", done.stderr)

    def test_missing_program_fails(self):
        done = self.run_tests("add_test(NAME lost COMMAND no_such_program)\n"
                              "set_tests_properties(lost PROPERTIES LABELS unit)\n", "--quick")
        self.assert_ends_with(done, "0 passed, 1 failed", 1)

    def test_tests_with_failed_fixture_are_failures(self):
        done = self.run_tests('case(first unit "exit 1")\ncase(second unit "true")\n'
                              "set_tests_properties(first PROPERTIES FIXTURES_SETUP f)\n"
                              "set_tests_properties(second PROPERTIES FIXTURES_REQUIRED f)\n", "--quick")
        self.assert_ends_with(done, "0 passed, 2 failed", 1)

    def test_empty_test_run_fails(self):
        self.assertEqual(self.run_tests("", "--quick").returncode, 1)

    def test_known_failures_run_and_are_listed_in_last_line(self):
        (self.root / "tests").mkdir()
        (self.root / "tests/known_failures.txt").write_text("# comment\nbad  # a library\ngood  # a library\n")
        done = self.run_tests(f'case(good unit "touch {self.root}/ran")\ncase(bad unit "exit 1")\ncase(c unit "true")\n')
        self.assert_ends_with(done, "2 passed, 0 failed (known to fail, and failed: bad)", 0)
        self.assertIn("Known to fail: bad: a library", done.stderr)
        self.assertTrue((self.root / "ran").exists())

    def test_progress_is_printed_and_output_logged(self):
        done = self.run_tests('add_custom_target(work ALL COMMAND echo compiling)\n'
                              'case(a unit "echo said; exit 1")\ncase(b unit "true")\n', "--quick")
        self.assertRegex(done.stderr, r"Building build/release: 1 of 1, \d+ s so far")
        self.assertRegex(done.stderr, r"Tests: 2 of 2, 1 failed, \d+ s so far")
        self.assertIn("said", done.stderr)
        self.assertIn("compiling", (self.root / "build/logs/build-release.log").read_text())
        self.assertIn("Test #2: b", (self.root / "build/logs/test-release.log").read_text())
        self.assertNotIn("Test #2: b", done.stderr)

    def test_build_without_tests_is_reconfigured(self):
        cases = 'option(ETI_TESTS "" ON)\nif(ETI_TESTS)\ncase(a unit "true")\nendif()\n'
        (self.root / "CMakeLists.txt").write_text(PROJECT + cases)
        subprocess.run(["cmake", "--preset", "release", "-DETI_TESTS=OFF"], cwd=self.root, check=True, capture_output=True)
        self.assert_ends_with(self.run_tests(cases, "--quick"), "1 passed, 0 failed", 0)

    def test_ctrl_c_stops_and_rerun_resumes(self):
        cases = (f'add_custom_target(slow ALL COMMAND sh -c "test -e {self.root}/second || {{ touch {self.root}/begun; sleep 60; }}"'
                 ' VERBATIM)\ncase(a unit "true")\n')
        (self.root / "CMakeLists.txt").write_text(PROJECT + cases)
        started = subprocess.Popen([self.root / "deploy/test.sh", "--no-install", "--quick"], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True, start_new_session=True)
        while not (self.root / "begun").exists():
            self.assertIsNone(started.poll(), "ended before anything was built")
            time.sleep(0.02)
        os.killpg(started.pid, signal.SIGINT)
        said = started.communicate(timeout=60)[1]
        self.assertEqual(started.returncode, 130, said)
        self.assertIn("The same command resumes from here", said)
        (self.root / "second").touch()
        self.assert_ends_with(self.run_tests(cases, "--quick"), "1 passed, 0 failed", 0)

    def test_failed_build_is_a_failure(self):
        done = self.run_tests('add_custom_target(broken ALL COMMAND false)\ncase(a unit "true")\n', "--quick")
        self.assert_ends_with(done, "0 passed, 1 failed", 1)
        self.assertIn("Building release failed", done.stderr)

    def test_failed_configuration_is_a_failure(self):
        done = self.run_tests("message(FATAL_ERROR impossible)\n", "--quick")
        self.assert_ends_with(done, "0 passed, 1 failed", 1)
        self.assertIn("impossible", done.stderr)


if __name__ == "__main__":
    unittest.main()
