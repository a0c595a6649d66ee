# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Common to the system tests: running the programs, failing file systems, reading pictures."""

import json
import math
import os
import re
import resource
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(os.environ.get("ETI_BIN", ROOT / "build/release/bin"))
sys.path.insert(0, str(ROOT / "deploy"))
os.environ["LANGUAGE"] = "en"    # of the texts that tests expect


def own_domain():
    """A DDS domain reserved by this process, and the socket that holds it until the process ends; see
    tests/support/bus_domain.hpp."""
    for tried in range(100):
        domain = 1 + (os.getpid() + tried) % 100
        token = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            token.bind(f"\0eti-test-domain-{domain}")
            return domain, token
        except OSError:
            token.close()
    raise RuntimeError("no DDS domain from 1 to 100 is free for this test")


DOMAIN, _domain_token = own_domain()
SESSION = f"test-{os.getpid()}"
SECONDS_TO_START = 120
PATIENCE = 120  # [s]: a wait ends with its event, and only a hanging program takes this long

# The term scenario on particles of 3 mm, for tests that do not depend on the tissue.
COARSE_TERM = ROOT / "deploy/data/studies/patients/term_3500.yaml"

# For sessions of which nobody looks at the clients' pictures: further arguments of session_run.Session's clients. In
# software, drawing takes most of the processor.
SMALL_PICTURES = {client: ["--size", "320x180", "--no-video"] for client in ("trainee", "observer")}

# Table 2 of the paper, by the names of JSON and session file.
PAPER_PARAMETERS = {
    "gum_force_n": ("max", "mean"), "blade_depth_cm": ("max", "mean"), "pitch_peaks": (), "yaw_peaks": (),
    "pitch_rocking_deg": (), "yaw_rocking_deg": (), "attempts": (), "time_s": (),
    "glottic_opening_percent": ("max", "mean"), "tube_speed_cm_per_s": ("max", "mean"), "head_elevation_deg": (),
    "oesophageal_entries": (),
}


def limit_memory():
    """Ends a program whose memory a hostile file inflates: a whole run needs well under this."""
    resource.setrlimit(resource.RLIMIT_DATA, (4 << 30, 4 << 30))


def wait_until(happened, what):
    """Waits for a condition; `what`: text, or a function that returns it, for the error on timeout."""
    end = time.monotonic() + PATIENCE
    while not happened():
        if time.monotonic() > end:
            raise AssertionError(f"not within {PATIENCE} s: {what() if callable(what) else what}")
        time.sleep(0.02)


def cached_patients():
    """Where servers keep the newborns that they have built, see server/app/run/patient_cache.hpp."""
    usual = Path(os.environ.get("ETI_CACHE") or
                 Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "neoeti")
    return usual if usual.exists() else Path(tempfile.gettempdir()) / f"neoeti-{os.getuid()}"


def takes(process, number):
    """Whether a program has installed its handler for a signal, by proc(5): before that, the signal ends it."""
    status = Path(f"/proc/{process.pid}/status").read_text()
    return int(status.split("SigCgt:")[1].split()[0], 16) >> (number - 1) & 1 == 1


def processor_seconds(process):
    """User and system time of a program so far."""
    fields = Path(f"/proc/{process.pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def run(program, *arguments, timeout=PATIENCE, wrapper=(), **options):
    """Runs one of our programs to its end; standard output and error as text."""
    command = [*map(str, wrapper), str(BIN / program), *map(str, arguments)]
    return subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
                          timeout=timeout, preexec_fn=limit_memory, **options)


class Case(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="eti-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def assert_refused(self, done, *said):
        """The program exited by itself, not by a signal, without success, and printed these words."""
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
                self.assertTrue(math.isfinite(value), f"{name}: {value}")

    def assert_session_succeeds(self, session):
        """Runs a whole session: it intubates, every program ends by itself, forces are felt, commands are accepted and
        both clients have the scene."""
        session.start()
        self.addCleanup(session.finish)
        self.assertTrue(session.watch())
        late = session.finish()
        logs = {role: program.log.read_text(errors="replace") for role, program in session.programs.items()}
        self.assertEqual(late, [], [logs[role] for role in late])
        for role, program in session.programs.items():
            self.assertEqual(program.exit_code(), 0, f"{role}: {program.how_it_ended()}\n{logs[role]}")
        summary, _ = session.summary()
        self.assertTrue(summary["success"], f"{summary['reason']}\n{logs['server']}")
        self.assertGreater(session.said("haptics")["force_n"]["max"], 0.5)
        controller = session.said("controller")
        self.assertEqual((controller["commands"], controller["accepted"]), (2, 2))
        for role in ("trainee", "observer"):
            self.assertIn("scene is complete", logs[role])


class Programs(Case):
    """Programs of one session, started one by one; each has a log and its output in the test's folder."""

    def setUp(self):
        super().setUp()
        self.bus = ["--session", SESSION, "--domain", DOMAIN]
        self.running = {}
        self.addCleanup(self.kill)

    def kill(self):
        for process in self.running.values():
            if process.poll() is None:
                process.kill()
                process.wait()

    def start(self, role, *command):
        with (self.folder / f"{role}.log").open("wb") as log, (self.folder / f"{role}.out").open("wb") as out:
            self.running[role] = subprocess.Popen(
                [str(BIN / command[0]), *map(str, [*command[1:], *self.bus])], stdin=subprocess.DEVNULL,
                stdout=out, stderr=log)
        return self.running[role]

    def log(self, role):
        return (self.folder / f"{role}.log").read_text(errors="replace")

    def wait_for(self, role, words, seconds=PATIENCE):
        end = time.monotonic() + seconds
        while words not in self.log(role):
            self.assertLess(time.monotonic(), end, f"{role} never said '{words}':\n{self.log(role)}")
            self.assertIsNone(self.running[role].poll(), self.log(role))
            time.sleep(0.05)

    def start_server(self, *options, scenario="term"):
        """Starts a recording server; returns once its patient is built."""
        self.record = self.folder / "server.eti.h5"
        self.start("server", "eti-server", "--scenario", scenario, "--record", self.record, *options)
        self.wait_for("server", "runs scenario", SECONDS_TO_START)

    def stop(self, role):
        """Asks a program to end, and waits until it has."""
        self.running[role].send_signal(signal.SIGINT)
        self.assertEqual(self.running[role].wait(PATIENCE), 0, self.log(role))

    def control(self, *words):
        """Runs eti-controller once."""
        return run("eti-controller", *words, "--json", *self.bus)

    def description(self):
        """The session's description and current values, as clients receive them."""
        done = self.control("--list")
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def now(self, name):
        """Value of a runtime parameter."""
        return next(row["now"] for row in self.description()["live"] if row["name"] == name)

    def simulated(self):
        """Simulation time and its lag behind the clock [s], as last logged by the server."""
        told = re.findall(r"simulation time (\d+) s, ([\d.]+) s behind", self.log("server"))
        return tuple(map(float, told[-1])) if told else (0.0, 0.0)

    def end(self, role):
        """Stops a program; returns its JSON."""
        self.stop(role)
        return json.loads((self.folder / f"{role}.out").read_text())


# A shell line that runs in a mount namespace of its own, with a file system mounted on $1.
IN_NAMESPACE = ["unshare", *([] if os.geteuid() == 0 else ["--user", "--map-root-user"]), "--mount", "sh", "-c"]


def on_file_system(options, folder):
    """Command prefix that runs a command with a small tmpfs on `folder`; skips where that is not allowed."""
    mount = f'mount -t tmpfs -o {options} tmpfs "$1" && shift && exec "$@"'
    prefix = [*IN_NAMESPACE, mount, "sh", str(folder)]
    tried = subprocess.run([*prefix, "true"], capture_output=True, text=True)
    if tried.returncode != 0:
        raise unittest.SkipTest(f"no mounting in a namespace here: {tried.stderr.strip()}")
    return prefix


def read_picture(path):
    """Pixels of a picture as an array (height, width, channels)."""
    import numpy  # takes longer than most tests that read no picture
    from PIL import Image
    with Image.open(path) as picture:
        return numpy.asarray(picture.convert("RGB"))
