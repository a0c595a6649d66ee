# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Trainee, instructor and observer in windows of a virtual display: their rights, and a window's behaviour when server,
driver or size fail."""

import os
import re
import time
import unittest

import h5py
import numpy

import support
from virtual_display import VirtualDisplay

WIDTH, HEIGHT = 640, 360


class Roles(support.Programs):
    def setUp(self):
        super().setUp()
        self.display = VirtualDisplay(1400, 800)
        self.addCleanup(self.display.close)
        self.addCleanup(self.kill)  # before the display goes

    def start_client(self, role, *options, height=HEIGHT):
        self.start(role, "eti-client", "--size", f"{WIDTH}x{height}", "--view", "overview", "--json", *options)

    def draws(self, role):
        """Waits until it draws the patient, before which nothing can be picked; returns its window."""
        self.wait_for(role, "showing the patient")
        return self.display.find("NeoETI")

    def said_by_server(self, words):
        return len(re.findall(words, self.log("server")))

    def test_only_instructor_leaves_marks_and_commands(self):
        self.start_server()
        self.start_client("observer", "--observe")
        self.draws("observer")
        self.hands(lambda words: time.sleep(0.5))
        report = self.end("observer")
        self.assertNotIn("commands", report)
        self.assertGreater(report["frames"], 0)
        self.assertEqual(self.said_by_server("note of|marks:"), 0, self.log("server"))

        # The lower half of an upright window is the instructor's panel.
        self.start_client("instructor", "--instructor", height=2 * HEIGHT)
        self.draws("instructor")
        self.hands(lambda words: self.wait_for("server", words))
        self.display.do("key", "z")
        self.wait_for("server", "wipes all marks away")
        report = self.end("instructor")
        self.assertEqual(report["commands"], {"sent": 1, "accepted": 1, "refused": 0})
        self.assertEqual(report["messages_dropped"], 0)
        self.stop("server")
        with h5py.File(self.record, "r") as file:
            self.assertEqual([kind.decode() for kind in file["inputs/commands/kind"]], ["view_enhanced"])
            events = list(zip((k.decode() for k in file["events/kind"]), (t.decode() for t in file["events/text"])))
            notes = [text for kind, text in events if kind == "note"]
            self.assertEqual(len(notes), 1, events)
            self.assertTrue(notes[0].endswith(": Lift more"), notes)
            marks = file["annotations"]
            self.assertEqual([kind.decode() for kind in marks["kind"]], ["point", "stroke"])
            self.assertTrue((marks["time_ns"][:] > 0).all())
            counts, first = marks["row_count"][:], marks["first_row"][:]
            self.assertEqual(counts[0], 1)
            self.assertGreaterEqual(counts[1], 2)
            # Past positions follow from the scene, as the data sets document: the patient is at rest.
            surfaces = {surface.attrs["name"]: surface for surface in file["scene/surfaces"].values()}
            for row in range(len(counts)):
                surface = surfaces[marks["object"][row].decode()]
                vertices, triangles = surface["vertices"][:], surface["triangles"][:]
                for k in range(first[row], first[row] + counts[row]):
                    a, b, c = vertices[triangles[marks["triangle"][k]]]
                    u, v, height = marks["place"][k]
                    normal = numpy.cross(b - a, c - a)
                    at_rest = a + u * (b - a) + v * (c - a) + height * normal / numpy.linalg.norm(normal)
                    # Head and jaw are posed by some degrees: centimetres at most.
                    self.assertLess(numpy.linalg.norm(marks["position"][k] - at_rest), 0.05)
        summary = support.run("eti-review", "summary", self.record)
        self.assertIn("Lift more", summary.stdout)
        self.assertIn("points at", summary.stdout)

    def hands(self, wait_for):
        """An instructor's actions: a command, a remark, a point and a line on the head, each after the server has had
        time for the previous one."""
        x, y = WIDTH // 2, HEIGHT // 2
        self.display.do("key", "e")
        self.display.do("key", "w")
        self.display.do("type", "--delay", 60, "Lift more")
        self.display.do("key", "Return")
        wait_for("note of")
        self.display.do("mousemove", x, y, "keydown", "shift", "click", 1)
        wait_for("points at")
        self.display.do("mousedown", 1)
        for i in range(1, 8):
            self.display.do("mousemove", x, y + 6 * i)
            time.sleep(0.1)
        self.display.do("mouseup", 1, "keyup", "shift")
        wait_for("draws on")

    def test_window_outlives_server_and_follows_next_one(self):
        self.start_server()
        self.start_client("trainee")
        window = self.draws("trainee")
        # The posture changes, and the window shrinks to zero and back, while it draws.
        changed = self.control("--set", "head_elevation_deg=20", "--set", "jaw_opening_deg=15", "--set", "tongue_scale=1.1")
        self.assertEqual(changed.returncode, 0, changed.stderr)
        for size in ((1, 1), (2, 500), (800, 450)):
            self.display.do("windowsize", window, *size)
            time.sleep(0.4)  # some pictures of that size
        self.running["server"].kill()
        self.running["server"].wait()
        self.wait_for("trainee", "connection to the server lost; waiting for a server")
        self.record.unlink()
        self.start_server()
        self.wait_for("trainee", "connected to a server again")
        time.sleep(1)  # some pictures of its scene
        report = self.end("trainee")
        self.assertEqual(report["end"], "stopped")
        self.assertEqual(report["messages_dropped"], 0, self.log("trainee"))

    def test_old_graphics_driver_error_contains_remedy(self):
        """By Mesa's own switches: a driver that is too old."""
        for way in ([], ["--offscreen", self.folder / "pictures"]):
            done = support.run("eti-client", *way, "--wait", "3", "--session", support.SESSION, "--domain",
                               support.DOMAIN, env=dict(os.environ, MESA_GL_VERSION_OVERRIDE="2.1"))
            self.assert_refused(done, "OpenGL 3.3", "Install")

    def test_window_gives_up_without_server(self):
        begin = time.monotonic()
        done = support.run("eti-client", "--wait", "2", "--session", support.SESSION, "--domain", support.DOMAIN)
        self.assert_refused(done, "no server found for 2 s (--wait)", support.SESSION)
        self.assertGreater(time.monotonic() - begin, 2)


if __name__ == "__main__":
    unittest.main()
