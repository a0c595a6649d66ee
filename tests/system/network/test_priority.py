# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Scheduling on a busy machine: with and without the right to real-time priorities, the simulation is the same."""

import ctypes
import json
import os
import resource
import subprocess
import time
import unittest

import support

CAP_SYS_NICE = 23       # linux/capability.h
PR_CAPBSET_DROP = 24    # linux/prctl.h
SECONDS_TO_START = 120


def without_rights():
    """Programs started next may not have real-time priorities, root or not."""
    resource.setrlimit(resource.RLIMIT_RTPRIO, (0, 0))
    ctypes.CDLL(None).prctl(PR_CAPBSET_DROP, CAP_SYS_NICE, 0, 0, 0)


def may_have_priority():
    try:
        subprocess.run(["chrt", "--fifo", "60", "true"], check=True, stderr=subprocess.DEVNULL)
        return True
    except (subprocess.CalledProcessError, FileNotFoundError):
        return False


class Priority(support.Case):
    def start(self, *arguments, prepare=None):
        server = subprocess.Popen([support.BIN / "eti-server", "--scenario", "term", "--session", support.SESSION,
                                   "--domain", str(support.DOMAIN), "--steps", "180", "--json", *arguments],
                                  stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                  preexec_fn=prepare)
        self.addCleanup(server.kill)
        return server

    def outcome(self, server):
        out, said = server.communicate(timeout=SECONDS_TO_START)
        self.assertEqual(server.returncode, 0, said)
        return json.loads(out)["state_hash"], said

    def test_state_is_independent_of_priority_and_threads(self):
        refused, said = self.outcome(self.start("--threads", "1", prepare=without_rights))
        self.assertEqual(said.count("no real-time priority (Operation not permitted)"), 1, said)
        line = next(line for line in said.splitlines() if "no real-time priority" in line)
        self.assertIn("ulimit -r", line)
        granted, _ = self.outcome(self.start("--threads", "2"))
        # The reference ignores the clock, and so has neither background threads nor priorities.
        alone, said = self.outcome(self.start("--fast", "--no-dds", prepare=without_rights))
        self.assertNotIn("no real-time priority", said)
        self.assertEqual(refused, alone)
        self.assertEqual(granted, alone)

    def test_simulation_has_real_time_priority(self):
        if not may_have_priority():
            self.skipTest("no right to real-time priorities here")
        server = self.start()
        # The library's threads and the haptic publisher; the simulation and shapes; the assessment. Each thread sets
        # its priority as it starts.
        wanted = ((70, 2), (60, 2), (50, 1))
        found, deadline = {}, time.monotonic() + SECONDS_TO_START
        while any(list(found.values()).count((os.SCHED_FIFO, priority)) < least for priority, least in wanted):
            self.assertIsNone(server.poll(), f"it ended before all had their priorities: {found}")
            self.assertLess(time.monotonic(), deadline, found)
            found = {}
            for thread in map(int, os.listdir(f"/proc/{server.pid}/task")):
                policy = os.sched_getscheduler(thread) & ~os.SCHED_RESET_ON_FORK
                found[thread] = (policy, os.sched_getparam(thread).sched_priority)
            time.sleep(0.01)
        self.assertEqual(found[server.pid], (os.SCHED_FIFO, 60))
        server.kill()
        server.communicate()

    def test_tracker_has_higher_priority_than_simulation(self):
        if not may_have_priority():
            self.skipTest("no right to real-time priorities here")
        tracker = subprocess.Popen([support.BIN / "eti-tracker", "--device", "simulated", "--session", support.SESSION,
                                    "--domain", str(support.DOMAIN)],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(tracker.wait)
        self.addCleanup(tracker.kill)
        deadline = time.monotonic() + SECONDS_TO_START
        while os.sched_getscheduler(tracker.pid) != os.SCHED_FIFO or os.sched_getparam(tracker.pid).sched_priority != 70:
            self.assertIsNone(tracker.poll(), "it ended")
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)


if __name__ == "__main__":
    unittest.main()
