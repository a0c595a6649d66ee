# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A complete run of deploy/demo.sh: six processes over the bus, and their results."""

import json
import os
import signal
import subprocess
import unittest
from pathlib import Path

import h5py
import numpy

import support

RESULT = support.BIN.parent / "demo-run.json"  # written by the first case for the others


def demo_folder():
    return Path(json.loads(RESULT.read_text())["folder"])


class Demo(support.Case):
    def test_demo_intubates_the_trachea(self):
        out = support.BIN.parent / "demo-run"
        done = subprocess.run([support.ROOT / "deploy/session_run.py", "--bin", support.BIN, "--out", out, "--domain",
                               str(support.DOMAIN)], capture_output=True, text=True, timeout=1100)
        print(done.stdout, done.stderr, sep="\n")
        self.assertEqual(done.returncode, 0)
        folder = Path(next(line.split(maxsplit=2)[-1] for line in done.stdout.splitlines() if line.startswith("Session file")))
        RESULT.write_text(json.dumps({"folder": str(folder.parent), "stdout": done.stdout, "stderr": done.stderr}))
        self.assertIn("The trachea was intubated:", done.stdout)
        for kind in ("Pictures", "Video", "Forces were complete", "The server fell behind"):
            self.assertIn(kind, done.stdout)
        if "was built without the page" not in done.stderr:     # which needs npm
            self.assertIn("Report", done.stdout)
        for role in ("server", "haptics", "tracker", "controller", "trainee", "observer"):
            self.assertIn(f"{role} ended.", done.stderr)
        self.assertIn("The assistant sent 2 commands, 2 were accepted.", done.stdout)
        for device in ("simulated", "scripted"):
            self.assertIn(f"device: {device}\n", (folder.parent / f"{device}.yaml").read_text())
        for role in ("haptics", "tracker"):
            self.assertIn("calibration of", (folder.parent / "logs" / f"{role}.log").read_text())

    def test_demo_summary_contains_every_parameter(self):
        done = support.run("eti-review", "summary", demo_folder() / "session.eti.h5", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        summary = json.loads(done.stdout)
        self.assertTrue(summary["success"], summary["reason"])
        self.assert_parameters(summary["parameters"])

    def test_demo_session_file_records_all_participants(self):
        # Hands and eye are in other processes, so their latched values arrived over the bus.
        with h5py.File(demo_folder() / "session.eti.h5", "r") as file:
            self.assertLessEqual({"meta", "inputs", "tools", "skeleton", "deformation", "metrics", "events", "scene"},
                                 set(file))
            inputs = {name: item[()] for name, item in file["inputs"].items() if isinstance(item, h5py.Dataset)}
        # Steps of 1/180 s without a gap; times are whole nanoseconds.
        steps = numpy.diff(inputs["time_ns"].astype(numpy.int64))
        self.assertLessEqual(numpy.abs(steps - 1e9 / 180).max(), 1)
        # Each tool comes from outside the mouth and moves some 7 cm down to the glottis.
        for name in ("laryngoscope_pose", "tube_grip_pose"):
            self.assertGreater(numpy.ptp(inputs[name][:, :3], axis=0).max(), 0.02, name)
        self.assertTrue(numpy.isfinite(inputs["eye_pose"]).all(axis=1).any(), "the trainee's eye was never seen")

    def test_demo_pictures_show_a_moving_scene(self):
        for role in ("trainee", "observer"):
            with self.subTest(role):
                files = sorted((demo_folder() / role).glob("*.png"))
                pictures = [support.read_picture(file) for file in files]
                self.assertGreaterEqual(len(pictures), 2)
                colours = {}
                for file, picture in zip(files, pictures):
                    red, green, blue = (picture[..., k].astype(numpy.uint32) for k in range(3))
                    colours[file.name] = len(numpy.unique(red << 16 | green << 8 | blue))
                # Until it is in the mouth, the blade's camera sees a dark room.
                lens = [count for name, count in colours.items() if name.startswith("laryngoscope")]
                self.assertGreater(max(lens, default=501), 500)
                for name, count in colours.items():
                    if not name.startswith("laryngoscope"):
                        self.assertGreater(count, 500, f"{name}: a lit scene has many shades; an empty one has a few")
                self.assertTrue(any((a != pictures[0]).any() for a in pictures[1:] if a.shape == pictures[0].shape))

    def test_ctrl_c_ends_the_demo_cleanly(self):
        process = subprocess.Popen([support.ROOT / "deploy/session_run.py", "--bin", support.BIN, "--out", self.folder,
                                    "--domain", str(support.DOMAIN)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True)
        self.addCleanup(process.kill)
        for line in process.stderr:
            if line.startswith("simulated "):
                break
        os.kill(process.pid, signal.SIGINT)
        _, said = process.communicate(timeout=support.PATIENCE)
        self.assertEqual(process.returncode, 1)
        self.assertIn("Stopping: interrupted.", said)
        self.assertNotIn("killing it", said)
        for role in ("server", "haptics", "tracker", "controller", "trainee", "observer"):
            self.assertIn(f"{role} ended.", said)
        file = next(self.folder.glob("*/session.eti.h5"))
        self.assertEqual(support.run("eti-review", "check", file).returncode, 0)


if __name__ == "__main__":
    unittest.main()
