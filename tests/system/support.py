# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""What the system tests share: running the programs, file systems that refuse, reading pictures."""

import os
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

import numpy

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(os.environ.get("ETI_BIN", ROOT / "build/release/bin"))
sys.path.insert(0, str(ROOT / "deploy"))

# Below 7400 + 250 * 101 the bus's ports stay clear of the kernel's ephemeral ports.
DOMAIN = 1 + os.getpid() % 100
SESSION = f"test-{os.getpid()}"

# Table 2 of the paper, by the names of JSON and session file.
PAPER_PARAMETERS = {
    "gum_force_n": ("max", "mean"), "blade_depth_cm": ("max", "mean"), "pitch_peaks": (), "yaw_peaks": (),
    "pitch_rocking_deg": (), "yaw_rocking_deg": (), "attempts": (), "time_s": (),
    "glottic_opening_percent": ("max", "mean"), "tube_speed_cm_per_s": ("max", "mean"), "head_elevation_deg": (),
    "oesophageal_entries": (),
}


def limit_memory():
    """Ends a program that a hostile file makes grow: a whole run needs well under this."""
    resource.setrlimit(resource.RLIMIT_DATA, (4 << 30, 4 << 30))


def run(program, *arguments, timeout=60, wrapper=(), **options):
    """Runs a program of ours to its end; standard output and error as text."""
    command = [*map(str, wrapper), str(BIN / program), *map(str, arguments)]
    return subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
                          timeout=timeout, preexec_fn=limit_memory, **options)


class Case(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="eti-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def assert_refused(self, done, *said):
        """The program ended by itself, not by a signal, without success, and said these words."""
        self.assertGreater(done.returncode, 0, f"exit status {done.returncode}\n{done.stderr}")
        self.assertLess(done.returncode, 128, done.stderr)
        self.assertNotIn("terminate called", done.stderr)
        for words in said:
            self.assertIn(str(words), done.stderr)

    def assert_parameters(self, parameters):
        """Every parameter of the paper is there and is a finite number."""
        for name, parts in PAPER_PARAMETERS.items():
            values = [parameters[name][part] for part in parts] if parts else [parameters[name]]
            for value in values:
                self.assertIsInstance(value, (int, float), f"{name}: {parameters[name]}")
                self.assertTrue(numpy.isfinite(value), f"{name}: {value}")


# A shell line that runs in a mount namespace of its own, with a file system mounted on $1.
IN_NAMESPACE = ["unshare", *([] if os.geteuid() == 0 else ["--user", "--map-root-user"]), "--mount", "sh", "-c"]


def on_file_system(options, folder):
    """Command prefix that runs what follows with a small tmpfs on `folder`; skips where that is not allowed."""
    mount = f'mount -t tmpfs -o {options} tmpfs "$1" && shift && exec "$@"'
    prefix = [*IN_NAMESPACE, mount, "sh", str(folder)]
    tried = subprocess.run([*prefix, "true"], capture_output=True, text=True)
    if tried.returncode != 0:
        raise unittest.SkipTest(f"no mounting in a namespace here: {tried.stderr.strip()}")
    return prefix


def read_png(path):
    """Pixels of an 8-bit RGB or RGBA PNG as an array (height, width, channels)."""
    data = Path(path).read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", path
    position, packed, header = 8, b"", None
    while position < len(data):
        length, kind = struct.unpack(">I4s", data[position:position + 8])
        chunk = data[position + 8:position + 8 + length]
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", chunk)
        elif kind == b"IDAT":
            packed += chunk
        position += 12 + length
    width, height, depth, colour, _, _, interlaced = header
    channels = {2: 3, 6: 4}[colour]
    assert depth == 8 and interlaced == 0, path
    rows = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, 1 + width * channels)
    pixels = numpy.zeros((height, width, channels), numpy.uint8)
    above = numpy.zeros((width, channels), numpy.uint8)
    for y in range(height):
        kind, row = rows[y, 0], rows[y, 1:].reshape(width, channels).copy()
        if kind == 1:       # each pixel adds to the one on its left: a running sum modulo 256
            row = numpy.cumsum(row, axis=0, dtype=numpy.uint8)
        elif kind == 2:
            row += above
        elif kind in (3, 4):
            left, corner = numpy.zeros(channels, int), numpy.zeros(channels, int)
            for x in range(width):
                up = above[x].astype(int)
                if kind == 3:
                    predicted = (left + up) // 2
                else:
                    guess = left + up - corner
                    distance = numpy.abs([guess - left, guess - up, guess - corner])
                    choice = numpy.argmin(distance, axis=0)
                    predicted = numpy.choose(choice, [left, up, corner])
                row[x] = (row[x] + predicted) % 256
                left, corner = row[x].astype(int), up
        pixels[y] = above = row
    return pixels
