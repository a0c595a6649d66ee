# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A server given several scenarios runs one session after another."""

import json
import unittest

import support


class Next(support.Programs):
    def ask(self, command):
        return self.control("--command", command)

    def test_next_starts_following_session_and_stop_ends_all(self):
        self.record = self.folder / "lesson.eti.h5"
        self.start("server", "eti-server", "--scenario", "term", "--scenario", "term_enhanced", "--scenario", "term",
                   "--record", self.record)
        self.wait_for("server", "runs scenario 'term'", support.SECONDS_TO_START)
        done = self.ask("next")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.wait_for("server", "runs scenario 'term_enhanced'", support.SECONDS_TO_START)
        session = self.description()
        self.assertEqual(session["scenario"], "term_enhanced")
        self.assertEqual(next(row["now"] for row in session["live"] if row["name"] == "view_enhanced"), 1)
        done = self.ask("stop")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.running["server"].wait(support.PATIENCE), 0)
        self.assertEqual(sorted(file.name for file in self.folder.glob("*.h5")), ["lesson-2.eti.h5", "lesson.eti.h5"])

    def test_next_is_refused_in_last_session(self):
        self.start_server()
        refused = self.ask("next")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("--scenario A --scenario B", refused.stderr)
        self.stop("server")

    def test_sessions_run_in_sequence_after_all_are_read(self):
        done = support.run("eti-server", "--no-dds", "--fast", "--steps", 20, "--scenario", "term", "--scenario",
                           "premature", "--json", timeout=support.SECONDS_TO_START)
        self.assertEqual(done.returncode, 0, done.stderr)
        decoder, names, rest = json.JSONDecoder(), [], done.stdout.strip()
        while rest:
            report, end = decoder.raw_decode(rest)
            names.append(report["scenario"])
            rest = rest[end:].strip()
        self.assertEqual(names, ["term", "premature"])
        wrong = support.run("eti-server", "--no-dds", "--fast", "--steps", 20, "--scenario", "term", "--scenario",
                            "nobody")
        self.assert_refused(wrong, "nobody")
        self.assertNotIn("runs scenario", wrong.stderr)


if __name__ == "__main__":
    unittest.main()
