# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A lab's own programs, in C with Cyclone DDS: they read what the server recorded, and the server receives what they
write."""

import json
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy
import yaml

import support

sys.path.insert(0, str(support.ROOT / "deploy/examples"))
from vtk_state import State  # noqa: E402

RECORDED_EVERY = 12  # steps; surfaces come every 6
STEPS_PER_SECOND = 180

# Error of the record: a frame that moved by less since it was last recorded (common/mesh/skinning.hpp), and the
# rounding of its grid (server/app/output/recorder.cpp).
FRAME_SHIFT, FRAME_TURN = 0.02e-3, 0.05 * numpy.pi / 180  # [m], [rad]
GRID_SHIFT, GRID_TURN = 0.5 * 2**-20, 4 * 0.5 * 2**-15
# Floats of up to 0.3 m, summed over four frames.
ROUNDING = 8 * 0.3 * 2**-24


def turned(rotation, points):
    """Rotates points by unit quaternions w x y z, row by row."""
    w, v = rotation[:, :1], rotation[:, 1:]
    t = 2 * numpy.cross(v, points)
    return points + w * t + numpy.cross(v, t)


class Record:
    """Frames and surfaces of a session file, skinned as documented."""

    def __init__(self, path):
        with h5py.File(path, "r") as file:
            self.rest_centre = file["scene/frame_rest_centre"][:].astype(float)
            self.surfaces = {s.attrs["name"]: {key: s[key][:] for key in s}
                             for s in file["scene/surfaces"].values()}
            self.moved = {key: file["deformation"][key][:] for key in file["deformation"]}

    def frames_at(self, time_ns):
        """Centre and rotation of each frame as last recorded by then."""
        last = numpy.searchsorted(self.moved["time_ns"], time_ns, side="right") - 1
        rows = slice(0, int(self.moved["first_row"][last] + self.moved["row_count"][last]))
        centre, rotation = self.rest_centre.copy(), numpy.tile([1.0, 0, 0, 0], (len(self.rest_centre), 1))
        frame = self.moved["frame"][rows]
        for values, key in ((centre, "centre"), (rotation, "rotation")):
            values[frame] = self.moved[key][rows]  # the last of several rows of a frame counts
        return centre, rotation / numpy.linalg.norm(rotation, axis=1, keepdims=True)

    def skinned(self, name, time_ns):
        """Vertices of a surface, and the maximum error of the record at each [m]."""
        centre, rotation = self.frames_at(time_ns)
        surface = self.surfaces[name]
        rest = surface["vertices"].astype(float)
        place, off = numpy.zeros_like(rest), numpy.zeros(len(rest))
        for k in range(surface["skin_frame"].shape[1]):
            frame, weight = surface["skin_frame"][:, k], surface["skin_weight"][:, k].astype(float)
            arm = rest - self.rest_centre[frame]
            place += weight[:, None] * (turned(rotation[frame], arm) + centre[frame])
            off += weight * (FRAME_SHIFT + GRID_SHIFT + (FRAME_TURN + GRID_TURN) * numpy.linalg.norm(arm, axis=1))
        return place, off


@unittest.skipUnless(shutil.which("idlc"), "there is no idlc: apt-get install cyclonedds-dev cyclonedds-tools")
class LabReaders(support.Programs):
    @classmethod
    def setUpClass(cls):
        cls.programs = Path(tempfile.mkdtemp(prefix="eti-examples-"))
        cls.addClassCleanup(shutil.rmtree, cls.programs, ignore_errors=True)
        built = subprocess.run([support.ROOT / "deploy/examples/build.sh", cls.programs], capture_output=True,
                               text=True)
        assert built.returncode == 0 and not built.stderr, built.stderr

    def example(self, program, *arguments):
        done = subprocess.run([self.programs / program, "--session", support.SESSION, "--domain",
                               str(support.DOMAIN), *map(str, arguments)],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              timeout=support.SECONDS_TO_START)
        self.assertEqual(done.returncode, 0, done.stderr + self.log("server"))
        return [json.loads(line) for line in done.stdout.splitlines()]

    def one_that_lifts_and_stays(self):
        """The expert's script up to the lift, which is held until the server is stopped, however long reading takes."""
        script = yaml.safe_load((support.ROOT / "deploy/data/operators/expert.yaml").read_text(encoding="utf-8"))
        stages = script["laryngoscope"]
        lift = next(number for number, stage in enumerate(stages) if stage["stage"] == "lift")
        stay = [{"stage": "stay", "keep": True, "hold_s": 120}] * 3  # the maximum of a stage, beyond the test's limit
        script["laryngoscope"] = [*stages[:lift + 1], *stay]
        script["tube"] = script["tube"][:1]
        script["tube"][0] |= {"until": {"view_percent": 100}, "timeout_s": 120, "abort_on_timeout": False}
        file = self.folder / "lifts.yaml"
        file.write_text(json.dumps(script))  # JSON is valid YAML
        return file

    def read_at_a_recorded_time(self):
        """Every second state coincides with a recorded one. Particles are compared with means, and a blade at rest
        moves those by less than a tenth of the bound within six steps."""
        for _ in range(20):
            counts = self.example("surface_reader", "--out", self.folder, "--seconds", "0.1")
            surfaces = State(self.folder / "surfaces.vtk")
            if round(surfaces.time_ns * STEPS_PER_SECOND / 1e9) % RECORDED_EVERY == 0:
                return counts, surfaces, State(self.folder / "particles.vtk")
        return self.fail("no state at a recorded time in twenty")

    def test_c_reader_receives_recorded_data(self):
        self.start_server("--operator", self.one_that_lifts_and_stays())
        self.wait_for("server", "simulation time 6 s", support.SECONDS_TO_START)  # the blade has lifted the tongue
        counts, surfaces, particles = self.read_at_a_recorded_time()
        self.assertEqual([row["topic"] for row in counts], ["eti/mesh_state", "eti/particle_state"])
        self.stop("server")

        record = Record(self.record)
        self.assertEqual(sorted(set(surfaces.objects)), sorted(record.surfaces))
        moved_most = 0.0
        for name, surface in record.surfaces.items():
            own = surfaces.objects == name
            expected, off = record.skinned(name, surfaces.time_ns)
            bound = off + numpy.sqrt(3) * surfaces.values["half_quantum"][own] + ROUNDING
            error = numpy.linalg.norm(surfaces.points[own] - expected, axis=1)
            self.assertTrue((error <= bound).all(), f"{name}: {1e6 * (error - bound).max():.1f} um beyond the bound")
            moved_most = max(moved_most, numpy.linalg.norm(expected - surface["vertices"], axis=1).max())
            begin = numpy.flatnonzero(own)[0]
            triangles = surfaces.triangles[surfaces.triangles[:, 0] >= begin][:len(surface["triangles"])] - begin
            numpy.testing.assert_array_equal(triangles, surface["triangles"])
        # Otherwise rest shapes would pass, too: the head is raised and the jaw open.
        self.assertGreater(moved_most, 10e-3)
        numpy.testing.assert_array_equal(
            surfaces.values["tissue"], numpy.concatenate([record.surfaces[name]["triangle_tissue"] for name in
                                                          dict.fromkeys(surfaces.objects)]))
        self.check_particles(record, particles)

    def check_particles(self, record, particles):
        """The record has no particles, but frames that are means of known ones: the epiglottis has clusters over
        exactly its particles, strips across a plate 2 mm thick (server/patient/newborn/build/build_particles.cpp)."""
        kinds = particles.values["tissue"]
        for tissue in (0, 1, 2, 3):  # soft, tongue, epiglottis, larynx
            self.assertGreater((kinds == tissue).sum(), 100, tissue)
        surface = record.surfaces["epiglottis"]
        weights = numpy.bincount(surface["skin_frame"].ravel(), surface["skin_weight"].ravel())
        frames = numpy.flatnonzero(weights)
        self.assertGreaterEqual(len(frames), 2)
        centres = record.frames_at(particles.time_ns)[0]
        plate = particles.points[kinds == 2]
        for frame in frames:
            # The plate is curved, so that a strip's centroid lies off it, by less than its thickness.
            self.assertLess(numpy.linalg.norm(plate - centres[frame], axis=1).min(), 2e-3)
        # Otherwise rest shapes would pass, too.
        self.assertGreater(numpy.linalg.norm((centres - record.rest_centre)[frames], axis=1).max(), 2e-3)

    def test_c_writer_is_received_and_acknowledged(self):
        self.start_server()
        at = (0.01, -0.15, 0.25)
        said, = self.example("tool_writer", "--at", *at, "--set", "table_angle", "-0.1")
        numpy.testing.assert_array_equal(numpy.float32(said["device"]), numpy.float32(at))
        self.assertTrue(said["answered"] and said["accepted"], said)
        refused, = self.example("tool_writer", "--at", *at, "--set", "table_angle", "-9")
        self.assertTrue(refused["answered"] and not refused["accepted"], refused)
        self.assertIn("expected -20 to 20", refused["reason"])
        self.stop("server")
        with h5py.File(self.record, "r") as file:
            # More than once, if an answer was lost and the command repeated.
            self.assertEqual({sender.decode() for sender in file["inputs/commands/sender"]}, {"tool_writer"})
            numpy.testing.assert_allclose(file["inputs/commands/value"][:], [-0.1], rtol=1e-6)


if __name__ == "__main__":
    unittest.main()
