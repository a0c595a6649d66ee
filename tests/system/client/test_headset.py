# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A trainee in a scripted headset: the server measures from the head's pose."""

import json
import os
import unittest

import support

RUNTIME = os.environ.get("ETI_HEADSET_RUNTIME", support.BIN.parent / "tests/headset_runtime.json")
HALF_BETWEEN_EYES = 0.032  # [m], of the scripted headset
STEPS_TO_THE_VIEW = 1800   # the expert looks at the glottis from the eighth second on


class Headset(support.Programs):
    def glottis_seen(self, aside):
        """Best visible share [%] while the expert exposes the glottis, with the right eye that far [m] beside the line
        of sight; and the report of the headset's runtime."""
        worn = self.folder / f"worn-{aside}"
        worn.mkdir()
        (worn / "script.json").write_text(json.dumps({
            "eye_width": 64, "eye_height": 64, "pace_ms": 11,
            "head": [{"position": [aside - HALF_BETWEEN_EYES, 0, 0], "pitch": -0.59}]}))
        os.environ.update(ETI_HEADSET_FOLDER=str(worn), XR_RUNTIME_JSON=str(RUNTIME))
        os.environ.pop("DISPLAY", None)
        self.start("client", "eti-client", "--view", "hmd", "--quality", "low", "--json")
        self.wait_for("client", "64 x 64 pixels per eye")
        server = self.start("server", "eti-server", "--scenario", "term", "--operator", "expert", "--steps", STEPS_TO_THE_VIEW,
                            "--json")
        server.wait(150)
        said = self.end("client")
        self.assertGreater(said["frames"], 0, "the headset showed the session")
        report = json.loads((worn / "report.json").read_text())
        self.assertEqual(report["faults"], [])
        result = json.loads((self.folder / "server.out").read_text())
        return result["parameters"]["glottic_opening_percent"]["max"]

    def test_view_is_measured_from_head_tracked_eye(self):
        # In front of the mouth, on the line of the best view; then a hand's breadth and more beside it.
        self.assertGreater(self.glottis_seen(0.0), 50)
        self.assertLess(self.glottis_seen(0.2), 5)

    def test_missing_runtime_error_says_what_to_install(self):
        done = support.run("eti-client", "--view", "hmd", *self.bus, env={**os.environ, "XR_RUNTIME_JSON": "/nowhere.json"})
        self.assert_refused(done, "--view hmd", "Install", "XR_RUNTIME_JSON")


if __name__ == "__main__":
    unittest.main()
