# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""eti-doctor on this machine with and without a session, and with one fault at a time."""

import json
import math
import os
import subprocess
import unittest

import support


def in_empty_network():
    """Command prefix of a network namespace in which even loopback is down; skips where that is not allowed."""
    prefix = ["unshare", *([] if os.geteuid() == 0 else ["--user", "--map-root-user"]), "--net"]
    tried = subprocess.run([*prefix, "true"], capture_output=True, text=True)
    if tried.returncode != 0:
        raise unittest.SkipTest(f"no network namespace here: {tried.stderr.strip()}")
    return prefix


class Doctor(support.Programs):
    def doctor(self, *options, wrapper=(), duration=1):
        done = support.run("eti-doctor", "--json", "--duration", duration, *options, *self.bus, wrapper=wrapper)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        report = json.loads(done.stdout)
        problems = [finding for finding in report["findings"] if finding["state"] == "mend"]
        self.assertEqual(done.returncode, 1 if problems else 0)
        self.assertEqual(report["problems"], len(problems))
        for finding in report["findings"]:
            self.assertEqual(finding["remedy"] == "", finding["state"] == "well", finding)
        return report

    def finding(self, report, area, thing):
        found = [one for one in report["findings"] if (one["area"], one["thing"]) == (area, thing)]
        self.assertEqual(len(found), 1, report["findings"])
        return found[0]

    def test_session_is_found_and_measured(self):
        self.start("server", "eti-server", "--scenario", "term")
        self.wait_for("server", "simulation time 1 s")
        self.start("haptics", "eti-haptics", "--device", "simulated")
        self.wait_for("server", "the laryngoscope's device is here")
        for duration in (2, 8, 32):  # as long as a busy machine needs
            report = self.doctor(duration=duration)
            if len(report["peers"]) == 2 and all(peer["answers"] > 10 for peer in report["peers"]) and \
                    all(topic["arrived"] > 50 for topic in report["topics"]):
                break
        self.assertTrue(report["server"])
        self.assertEqual(self.finding(report, "session", support.SESSION)["state"], "well")
        peers = {peer["name"]: peer for peer in report["peers"]}
        self.assertEqual(set(peers), {"eti-server", "eti-haptics"})
        for role, name in (("server", "eti-server"), ("haptics", "eti-haptics")):
            peer = peers[name]
            self.assertTrue(peer["process"].endswith(f":{self.running[role].pid}"), peer)
            self.assertGreater(peer["answers"], 10)
            self.assertTrue(0 < peer["round_trip_ms"]["min"] <= peer["round_trip_ms"]["median"], peer)
            self.assertTrue(math.isfinite(peer["round_trip_ms"]["p99"]))
            # One machine, one clock.
            self.assertLessEqual(abs(peer["clock_offset_ms"]), peer["clock_error_ms"] + 1e-3)
            self.assertEqual(peer["serves"], name == "eti-server")
        for topic in report["topics"]:
            self.assertGreater(topic["arrived"], 50, topic)

    def test_missing_session_report_contains_remedy(self):
        report = self.doctor()
        self.assertFalse(report["server"])
        found = self.finding(report, "session", support.SESSION)
        self.assertEqual(found["state"], "mend")
        for words in ("eti-server", "--network", "--peer", "--session"):
            self.assertIn(words, found["remedy"])

    def test_text_output_contains_remedy(self):
        done = support.run("eti-doctor", "--duration", 1, *self.bus)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("to do: start eti-server", done.stdout)
        self.assertIn("to fix.", done.stdout.splitlines()[-1])

    def test_usage_error_has_its_own_exit_status(self):
        self.assertEqual(support.run("eti-doctor", "--duration", "never").returncode, 2)

    def test_network_down_is_reported(self):
        report = self.doctor(wrapper=in_empty_network())
        self.assertIn("ip link set lo up", self.finding(report, "network", "loopback")["remedy"])
        self.assertEqual(self.finding(report, "session", support.SESSION)["state"], "mend")

    def test_network_without_peers_is_reported(self):
        up = [*in_empty_network(), "sh", "-c", 'ip link set lo up && exec "$@"', "sh"]
        report = self.doctor("--network", wrapper=up)
        self.assertEqual(self.finding(report, "network", "lo")["state"], "well")
        self.assertIn("omit --network", self.finding(report, "network", "others")["remedy"])

    def test_small_shared_memory_is_reported(self):
        report = self.doctor(wrapper=support.on_file_system("size=1m", "/dev/shm"))
        self.assertIn("--shm-size", self.finding(report, "memory", "/dev/shm")["remedy"])

    def test_missing_real_time_rights_are_reported(self):
        if os.geteuid() != 0:
            self.skipTest("taking rights away needs root")
        report = self.doctor(wrapper=["setpriv", "--bounding-set=-sys_nice", "--inh-caps=-sys_nice", "prlimit",
                                      "--rtprio=0"])
        self.assertIn("rtprio 80", self.finding(report, "rights", "real time")["remedy"])

    def test_broken_identity_is_reported(self):
        (self.folder / "identity").mkdir()
        report = self.doctor("--identity", self.folder / "identity")
        texts = [finding["text"] for finding in report["findings"] if finding["area"] == "security"]
        for file in ("key.pem", "certificate.pem", "permissions_ca.pem"):
            self.assertTrue(any(f"{file}: is missing" in text for text in texts), texts)


if __name__ == "__main__":
    unittest.main()
