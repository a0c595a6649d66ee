# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""The instructor's panel in a window: input there becomes commands that the server accepts."""

import time
import unittest

import h5py

import support
from virtual_display import VirtualDisplay

WIDTH, HEIGHT = 960, 540
LETTER = 13  # pixels, as in client/panel/panel_renderer.cpp for this height


class Panel(support.Programs):
    def setUp(self):
        super().setUp()
        self.display = VirtualDisplay()
        self.addCleanup(self.display.close)
        self.addCleanup(self.kill)  # before the display goes

    def becomes(self, name, value, seconds=6):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if self.now(name) == value:
                return True
        return False

    def open_client(self, *options):
        self.start("client", "eti-client", "--size", f"{WIDTH}x{HEIGHT}", "--view", "eye", "--quality", "low", "--json",
                   *options)
        self.wait_for("client", "showing the patient")
        self.display.find("NeoETI")
        time.sleep(2)  # nothing reports when the window has the keyboard focus

    def type_value(self, words, value):
        """By keys alone: shows the panel, which focuses the search field, and moves to the slider found."""
        self.display.key("F1")
        time.sleep(0.5)
        self.display.type(words)
        self.display.key("Tab")
        self.display.type(str(value))
        self.display.key("Return")

    def hide(self):
        self.display.key("F1")

    def click_start_of_the_only_row(self):
        """Clicks the button at the row's right end. The search result is the only row below the tabs."""
        for y in range(16 * LETTER, 8 * LETTER, -LETTER // 2):
            self.display.click(WIDTH - 3 * LETTER, y)

    def test_keys_and_clicks_send_accepted_commands(self):
        self.start_server()
        self.open_client()
        for _ in range(8):  # on a busy machine a picture may take longer than a key is held
            self.type_value("axes", 1)
            # Without hiding it: if the first key was lost, the next try shows it instead of hiding it again.
            if self.becomes("view_axes", 1):
                break
        self.assertEqual(self.now("view_axes"), 1, self.log("client"))
        for _ in range(8):
            self.click_start_of_the_only_row()
            if self.becomes("view_axes", 0):
                break
        self.assertEqual(self.now("view_axes"), 0, self.log("client"))
        report = self.end("client")
        self.assertGreaterEqual(report["commands"]["accepted"], 2)
        self.assertEqual(report["commands"]["refused"], 0)
        self.stop("server")
        with h5py.File(self.record, "r") as file:
            kinds = [kind.decode() for kind in file["inputs/commands/kind"]]
            senders = [sender.decode() for sender in file["inputs/commands/sender"]]
        self.assertEqual(set(kinds), {"view_axes"})
        self.assertTrue(all(sender.startswith("eti-client:") for sender in senders), senders)

    def test_observer_keys_and_clicks_send_nothing(self):
        self.start_server()
        self.open_client("--observe")
        for _ in range(2):
            self.type_value("axes", 1)
            self.click_start_of_the_only_row()
            self.assertFalse(self.becomes("view_axes", 1, 2))
            self.hide()
        self.assertNotIn("commands", self.end("client"))
        self.stop("server")
        with h5py.File(self.record, "r") as file:
            self.assertEqual(len(file["inputs/commands/kind"]), 0)


if __name__ == "__main__":
    unittest.main()
