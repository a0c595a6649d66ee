# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""eti-anatomy from volume to surfaces, as run by a person."""

import gzip
import json
import signal
import subprocess

import numpy
from PIL import Image

import support

BONE, MANDIBLE = 2, 4


class Anatomy(support.Case):
    def anatomy(self, *arguments):
        return support.run("eti-anatomy", *arguments, timeout=250)

    def phantom(self, name="ct.nii.gz", spacing=2.5):
        out = self.folder / name
        done = self.anatomy("phantom", "--spacing-mm", spacing, "--out", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        return out

    def test_volume_to_surfaces(self):
        ct = self.phantom(spacing=1.5)
        labels = self.folder / "labels.nrrd"
        done = self.anatomy("segment", ct, "--out", labels, "--truth", self.folder / "ct-labels.nii.gz", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads(done.stdout)
        self.assertGreater(result["agreement"]["airway"]["dice"], 0.95)
        self.assertTrue(all(s["found"] for s in result["structures"]), result["structures"])
        with Image.open(self.folder / "labels.png") as picture:
            self.assertEqual(picture.size, (1000, 1000))
            self.assertGreater(len(picture.getcolors(1 << 20)), 500)
        # Written landmarks can be read as input.
        again = self.anatomy("segment", ct, "--out", self.folder / "again.nrrd", "--landmarks",
                             self.folder / "labels-landmarks.mrk.json", "--json")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(json.loads(again.stdout)["structures"], result["structures"])
        done = self.anatomy("surfaces", labels, "--volume", ct, "--out", self.folder / "surfaces", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        for surface in json.loads(done.stdout)["surfaces"]:
            size = (self.folder / "surfaces" / f"{surface['name']}.stl").stat().st_size
            self.assertEqual(size, 84 + 50 * surface["triangles"])

        # Without a mandible the tongue has no attachment: surfaces, and no model.
        self.relabel(labels, MANDIBLE, BONE)
        model = self.folder / "model.h5"
        done = self.anatomy("build", labels, "--out", model, "--json")
        self.assertEqual(done.returncode, 3, done.stderr)
        result = json.loads(done.stdout)
        self.assertIsNone(result["model"])
        self.assertIn("mandible", result["why_no_model"])
        self.assertFalse(model.exists())
        self.assertTrue((self.folder / "model-surfaces" / "skin.stl").exists())

    def test_patient_orientation_is_detected_and_reported(self):
        spacing = 2.2  # [mm], too coarse for organs, which this test does not need
        ct = self.phantom("ct.nrrd", spacing)
        header, voxels = ct.read_bytes().split(b"\n\n", 1)
        out = self.folder / "labels.nrrd"

        def turned(name, *directions):
            """The same voxels along other directions."""
            vectors = " ".join("(" + ",".join(f"{spacing * v:.9f}" for v in d) + ")" for d in directions)
            file = self.folder / name
            file.write_bytes(b"\n".join(b"space directions: " + vectors.encode() if line.startswith(b"space directions")
                                        else line for line in header.split(b"\n")) + b"\n\n" + voxels)
            return file

        # Rotated by 30 degrees about left-right: found, without a warning.
        c, s = 0.8660254, 0.5
        done = self.anatomy("segment", turned("nod.nrrd", (1, 0, 0), (0, c, s), (0, -s, c)), "--out", out, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads(done.stdout)
        self.assertAlmostEqual(result["turn_deg"], 30, delta=4)
        self.assertEqual(result["contradictions"], [])
        # Upside down, because the file states a wrong orientation: labels, a warning, and an exit status of its own.
        done = self.anatomy("segment", turned("down.nrrd", (1, 0, 0), (0, -1, 0), (0, 0, -1)), "--out", out, "--json")
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertIn("doubtful: the head is rotated by 1", done.stderr)
        self.assertIn("Remedy", done.stderr)
        self.assertTrue(out.exists())
        self.assertEqual(len(json.loads(done.stdout)["contradictions"]), 1)
        # Noise is not a head.
        random = numpy.random.default_rng(1)
        sizes = [int(n) for n in header.split(b"sizes: ", 1)[1].split(b"\n", 1)[0].split()]
        noise = random.normal(0, 500, sizes).astype("<i2")
        (self.folder / "noise.nrrd").write_bytes(header + b"\n\n" + gzip.compress(noise.tobytes()))
        self.assert_refused(self.anatomy("segment", self.folder / "noise.nrrd", "--out", self.folder / "none.nrrd"),
                            "noise.nrrd", "no head", "expected", "Remedy")
        self.assertFalse((self.folder / "none.nrrd").exists())

    @staticmethod
    def relabel(file, old, new):
        """Changes a volume of labels in eti-anatomy's format: a header, an empty line, zipped bytes."""
        header, packed = file.read_bytes().split(b"\n\n", 1)
        voxels = numpy.frombuffer(gzip.decompress(packed), numpy.uint8).copy()
        assert (voxels == old).any()
        voxels[voxels == old] = new
        file.write_bytes(header + b"\n\n" + gzip.compress(voxels.tobytes()))

    def test_segments_are_read_by_name(self):
        ct = self.phantom("ct.nrrd", 2.5)
        labels = self.folder / "ct-labels.nrrd"
        header, packed = labels.read_bytes().split(b"\n\n", 1)
        voxels = numpy.frombuffer(gzip.decompress(packed), numpy.uint8)
        # The structures of surfaces, numbered in another order, as 3D Slicer stores them.
        names = {1: (3, "Airway"), 2: (2, "Skull"), 3: (1, "Skin")}
        other = numpy.zeros_like(voxels)
        for value, (label, _) in names.items():
            other[voxels == label] = value
        pairs = "".join(f"\nSegment{i}_LabelValue:={value}\nSegment{i}_Name:={name}"
                        for i, (value, (_, name)) in enumerate(names.items()))
        named = self.folder / "named.seg.nrrd"
        named.write_bytes(header + pairs.encode() + b"\n\n" + gzip.compress(other.tobytes()))
        plain = self.folder / "plain.nrrd"
        plain.write_bytes(header + b"\n\n" + gzip.compress(
            numpy.where(numpy.isin(voxels, [label for label, _ in names.values()]), voxels, 0).astype("u1").tobytes()))
        results = []
        for file in (named, plain):
            done = self.anatomy("surfaces", file, "--out", self.folder / file.stem, "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            results.append([{**one, "file": None} for one in json.loads(done.stdout)["surfaces"]])
            if file is named:
                self.assertIn("'Skull' is bone", done.stderr)
        self.assertEqual(*results)
        named.write_bytes(named.read_bytes().replace(b"Name:=Skull", b"Name:=Liver"))
        self.assert_refused(self.anatomy("surfaces", named, "--out", self.folder / "none"), named, "'Liver'", "Remedy")

    def test_noise_has_an_exit_status_of_its_own(self):
        ct = self.folder / "noisy.nrrd"
        self.assertEqual(self.anatomy("phantom", "--spacing-mm", 1.5, "--noise-hu", 60, "--out", ct).returncode, 0)
        done = self.anatomy("segment", ct, "--out", self.folder / "labels.nrrd", "--json")
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertIn("low confidence: tongue: the noise is 6", done.stderr)
        self.assertIn("Remedy", done.stderr)
        self.assertTrue((self.folder / "labels.nrrd").exists())
        self.assertIn("5 labels of low confidence", " ".join(self.anatomy("segment", "--help").stdout.split()))

    def test_surfaces_in_metres_are_recognised(self):
        corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        faces = "1 2 4 3,5 7 8 6,1 5 6 2,3 4 8 7,1 3 7 5,2 6 8 4".split(",")
        for scale, said in ((0.12, "seems to be in metres: scale it by 1000"),
                            (12, "seems to be in centimetres: scale it by 10")):
            skin = self.folder / "skin.obj"
            skin.write_text("".join(f"v {scale * x} {scale * y} {scale * z}\n" for x, y, z in corners)
                            + "".join(f"f {face}\n" for face in faces))
            self.assert_refused(self.anatomy("build", skin, "--out", self.folder / "model.h5"), skin, "expected 30 to",
                                "Remedy", said)

    def test_built_model_equals_server_model(self):
        coarse = "patient: {weight_kg: 2.5}\nphysics: {spacing_mm: 3, fine_spacing_mm: 1.5}\n"
        whole = self.folder / "whole.yaml"
        whole.write_text(coarse)
        done = self.anatomy("build", "--scenario", whole, "--out", self.folder / "newborn.h5", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["provenance"]["generator"], "implicit newborn")
        done = self.anatomy("check", self.folder / "newborn.h5", "--json")
        self.assertEqual(done.returncode, 0, done.stdout)
        result = json.loads(done.stdout)
        self.assertTrue(result["sound"])
        self.assertTrue(all(d["source"] for d in result["dimensions"]))
        named = self.folder / "named.yaml"
        named.write_text("patient: {model: newborn.h5}\n")
        hashes = set()
        for scenario in (whole, named):
            done = support.run("eti-server", "--scenario", scenario, "--operator", "expert", "--fast", "--no-dds",
                               "--steps", 400, "--json", timeout=200, env={**support.os.environ,
                                                                          "ETI_CACHE": str(self.folder / "cache")})
            self.assertEqual(done.returncode, 0, done.stderr)
            hashes.add(json.loads(done.stdout)["state_hash"])
        self.assertEqual(len(hashes), 1, "the same steps of the same patient end in different states")

    def test_newborn_segmented_from_noisy_ct_is_intubated(self):
        ct = self.phantom(spacing=0.6)
        done = self.anatomy("segment", ct, "--out", self.folder / "labels.nrrd")
        self.assertEqual(done.returncode, 0, done.stderr)
        done = self.anatomy("build", self.folder / "labels.nrrd", "--volume", ct, "--surface-mm", 1.5,
                            "--out", self.folder / "newborn.h5")
        self.assertEqual(done.returncode, 0, done.stderr)
        scenario = self.folder / "from_ct.yaml"
        scenario.write_text("""patient: {model: newborn.h5, head_elevation_deg: 26, jaw_opening_deg: 29}
laryngoscope: {blade: miller_1}
tube: {inner_diameter_mm: 3.0, grip_from_tip_mm: 100, curve_radius_mm: 70, youngs_modulus_mpa: 40}
""")
        done = support.run("eti-server", "--scenario", scenario, "--operator", "expert", "--fast", "--no-dds",
                           "--finish-after-attempt", "--json", timeout=200)
        result = json.loads(done.stdout)
        self.assertTrue(result["success"], result["reason"])
        self.assertGreater(result["parameters"]["glottic_opening_percent"]["max"], 25)

    def test_invalid_model_input_is_explained_without_output(self):
        (self.folder / "open.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        before = sorted(self.folder.iterdir())
        out = self.folder / "model.h5"
        self.assert_refused(self.anatomy("build", self.folder / "open.obj", "--out", out), "its name does not indicate",
                            "Remedy")
        skin = (self.folder / "open.obj").rename(self.folder / "skin.obj")
        self.assert_refused(self.anatomy("build", skin, "--out", out), "3 open", "near", "Remedy")
        skin.rename(self.folder / "open.obj")
        self.assert_refused(self.anatomy("build", "--weight-kg", 1, "--gestational-age-weeks", 40, "--out", out),
                            "weight_kg is 1", "expected")
        self.assert_refused(self.anatomy("check", self.folder / "open.obj"), "open.obj")
        self.assertEqual(sorted(self.folder.iterdir()), before)

    def test_damaged_files_are_refused_without_output(self):
        ct = self.phantom()
        cut = self.folder / "cut.nii.gz"
        cut.write_bytes(ct.read_bytes()[:5000])
        before = sorted(self.folder.iterdir())
        done = self.anatomy("segment", cut, "--out", self.folder / "labels.nrrd")
        self.assert_refused(done, cut, "expected", "Remedy")
        done = self.anatomy("segment", ct, "--out", self.folder / "labels.png")
        self.assert_refused(done, "labels.png", "Remedy")
        done = self.anatomy("surfaces", ct, "--out", self.folder / "surfaces")
        self.assert_refused(done, ct, "labels from 0", "Remedy")
        self.assertEqual(sorted(self.folder.iterdir()), before)

    def test_interrupt_leaves_nothing(self):
        program = subprocess.Popen([support.BIN / "eti-anatomy", "phantom", "--spacing-mm", "0.5", "--out",
                                    self.folder / "ct.nrrd"], stderr=subprocess.PIPE, text=True)
        support.wait_until(lambda: support.takes(program, signal.SIGINT), "a handler of SIGINT")
        program.send_signal(signal.SIGINT)
        _, said = program.communicate(timeout=support.PATIENCE)
        self.assertEqual(program.returncode, 130, said)
        self.assertIn("nothing was written", said)
        self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    support.unittest.main()
