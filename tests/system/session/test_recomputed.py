# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Parameters of a recorded attempt, computed anew from the session file by docs/metrics.md, with h5py and numpy alone."""

import sys
import unittest
from pathlib import Path

import h5py
import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import support

TISSUES = ("soft", "tongue", "epiglottis", "larynx", "trachea", "oesophagus", "upper gum", "lower gum", "palate",
           "skull", "mandible", "spine", "hyoid")
# The file holds forces and places as float32, of which sums over thousands of steps are taken.
RELATIVE = 1e-5


def turned(quaternion, vector):
    w, axis = quaternion[:, :1], quaternion[:, 1:]
    across = 2.0 * numpy.cross(axis, vector)
    return vector + w * across + numpy.cross(axis, across)


def force(file, rows, tissue):
    """Docs/metrics.md: normal forces of the contacts with the shell, and the net force of its particles [N]."""
    number = TISSUES.index(tissue)
    net = file["contacts/net"][rows, number].astype(float)
    return file["contacts/pressed"][rows, number].astype(float) + numpy.linalg.norm(net, axis=1)


def recomputed(file, began, ended):
    time = file["metrics/time_ns"][:] * 1e-9
    rows = numpy.flatnonzero((time >= began - 1e-6) & (time <= ended + 1e-6))
    time = time[rows]
    seconds = numpy.diff(time, prepend=time[0])
    found = {"time_s": time[-1] - time[0]}
    for tissue, key in (("upper gum", "gum"), ("epiglottis", "epiglottis"), ("tongue", "tongue")):
        newtons = force(file, rows, tissue)
        found[f"{key}_force_n/max"] = newtons.max()
        found[f"{key}_impulse_n_s"] = (newtons * seconds).sum()
    found["gum_force_n/mean"] = found["gum_impulse_n_s"] / seconds.sum()
    pose = file["tools/proxy_pose"][rows].astype(float)
    length = file["scene/laryngoscope"].attrs["blade_length_m"]
    tip = pose[:, :3] + turned(pose[:, 3:], numpy.array([[0.0, 0.0, length]]))
    every = round(180 / 30)
    found["blade_path_length_cm"] = 100.0 * numpy.linalg.norm(numpy.diff(tip[::every], axis=0), axis=1).sum()
    opening = file["metrics/glottic_opening_now"][rows].astype(float)
    found["glottic_opening_percent/max"] = opening.max()
    found["time_to_first_view_s"] = time[numpy.argmax(opening > 0.0)] - time[0]
    return found


class Recomputed(support.Case):
    def test_parameters_follow_from_the_file(self):
        record = self.folder / "run.eti.h5"
        done = support.run("eti-server", "--scenario", "term", "--operator", "expert", "--fast", "--no-dds", "--json",
                           "--participant", "P07", "--record", record, timeout=900)
        self.assertEqual(done.returncode, 0, done.stderr)
        with h5py.File(record) as file:
            self.assertEqual(file["meta/more"].attrs["participant"], "P07")
            self.assertIn("+y posterior", file["scene"].attrs["patient_frame"])
            self.assertIn("upper gum", file["contacts/pressed"].attrs["description"])
            eye = file["metrics/eye_used"][:]
            self.assertTrue(numpy.isfinite(eye[6:]).all(), "a scripted hand has no eye, and the measures use one")
            row = list(file["summary/attempt"]).index(1)
            began, ended = file["summary/began"][row], file["summary/ended"][row]
            found = recomputed(file, began, ended)
            self.assertGreater(found["tongue_force_n/max"], 1.0, "else it tells nothing")
            for key, value in found.items():
                with self.subTest(key):
                    numpy.testing.assert_allclose(value, file[f"summary/{key}"][row], rtol=RELATIVE)


if __name__ == "__main__":
    unittest.main()
