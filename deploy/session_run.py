#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Runs and monitors the processes of a session, and shows its results.

demo.sh calls this after building; the system tests use its classes for failure tests.
"""

import argparse
import ctypes
import errno
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SPACE_NEEDED = 200e6     # [bytes] session file, pictures and video of a demo, with room to spare
FIRST_SCENE = 120        # [s] that clients wait for it: a patient missing from the cache is built first
STALL_LIMIT = 180.0      # [s] without progress of the simulation time after which a server counts as hung
END_BY_ITSELF = 60.0     # [s] for processes to notice the session's end (a lease on the bus lasts 1.5 s), and
                         # for clients, which run at low priority, to draw their last pictures
END_ON_REQUEST = 30.0    # [s] from SIGTERM to SIGKILL: on a busy machine a client draws its first picture for seconds
USUAL_SESSION = 20       # [s] of simulation time of the expert's attempt
LONGEST_SESSION = 120    # [s] of simulation time
SUCTION = (1.0, 2.0)     # [s] of simulation time between which the assistant holds the pad's suction button
PR_SET_PDEATHSIG = 1


def die_with_parent():
    """Lets the kernel end this process when its parent dies."""
    ctypes.CDLL(None, use_errno=True).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


def put(text):
    """Writes to standard error without Python's buffer, which a signal's handler may not enter while a line is written."""
    os.write(sys.stderr.fileno(), text.encode(errors="replace"))


def say(text):
    """Prints a line on standard error, replacing a progress line on a terminal."""
    put(("\r\033[K" if sys.stderr.isatty() else "") + text + "\n")


class Program:
    """One process of a session: its command, log, and exit status."""

    def __init__(self, name, command, folder):
        self.name = name
        self.command = [str(part) for part in command]
        self.log = folder / "logs" / f"{name}.log"
        self.output = folder / "logs" / f"{name}.out"
        self.process = None
        self.reported = False

    def start(self):
        self.log.parent.mkdir(parents=True, exist_ok=True)
        # A process session of its own: Ctrl-C in the terminal reaches only this script, which ends the others in order.
        with self.log.open("wb") as log, self.output.open("wb") as output:
            self.process = subprocess.Popen(self.command, stdin=subprocess.DEVNULL, stdout=output, stderr=log,
                                            start_new_session=True, preexec_fn=die_with_parent)

    def running(self):
        return self.process is not None and self.process.poll() is None

    def exit_code(self):
        """Exit status; negative: the signal that killed it; None: still running."""
        return self.process.poll()

    def send(self, number):
        if self.running():
            self.process.send_signal(number)

    def wait(self, seconds):
        """Returns whether the process has ended within `seconds`."""
        try:
            self.process.wait(max(0.0, seconds))
            return True
        except subprocess.TimeoutExpired:
            return False

    def last_words(self, count=5):
        lines = self.log.read_text(errors="replace").splitlines()
        return [line.split("\r")[-1] for line in lines[-count:]]

    def how_it_ended(self):
        code = self.exit_code()
        if code == 0:
            return "ended"
        if code > 0:
            return f"failed with exit status {code}"
        return f"was killed by {signal.Signals(-code).name}"


class Pad:
    """A simulated game pad: a named pipe that delivers the kernel's joystick events."""

    BUTTON, AXIS = 1, 2  # JS_EVENT_BUTTON, JS_EVENT_AXIS of linux/joystick.h

    def __init__(self, file):
        self.file = file
        self.pipe = None

    def plug_in(self):
        os.mkfifo(self.file)
        # Opened for both, so that opening does not block until the reader opens it.
        self.pipe = os.open(self.file, os.O_RDWR | os.O_NONBLOCK | os.O_CLOEXEC)

    def press(self, button, down):
        self._write(int(down), self.BUTTON, button)

    def move(self, axis, share):
        """Moves a stick to -1..1 of its range."""
        self._write(round(32767 * share), self.AXIS, axis)

    def _write(self, value, kind, number):
        os.write(self.pipe, struct.pack("=IhBB", 0, value, kind, number))

    def unplug(self):
        if self.pipe is not None:
            os.close(self.pipe)
            self.pipe = None
            self.file.unlink(missing_ok=True)


class Session:
    """Processes of a session: server, haptics, tracker, controller, trainee, observer."""

    def __init__(self, bin_folder, folder, scenario="term", operator="expert", domain=0, name=None, extra=None,
                 say=say):
        self.bin = Path(bin_folder)
        self.folder = Path(folder)
        self.name = name or f"demo-{os.getpid()}"
        self.record = self.folder / "session.eti.h5"
        self.say = say
        self.on_terminal = sys.stderr.isatty()
        self.stopping = None    # reason for stopping the session early, if any
        bus = ["--session", self.name, "--domain", domain]
        commands = {
            "server": ["eti-server", "--scenario", scenario, "--record", self.record, "--finish-after-attempt",
                       "--duration", LONGEST_SESSION, "--json"],
            "haptics": ["eti-haptics", "--device", "simulated", "--operator", operator,
                        "--calibration", self.folder / "simulated.yaml", "--json"],
            "tracker": ["eti-tracker", "--device", "scripted", "--operator", operator,
                        "--calibration", self.folder / "scripted.yaml"],
            "controller": ["eti-controller", "--device", "gamepad", "--source", self.folder / "pad", "--json"],
            "trainee": ["eti-client", "--wait", FIRST_SCENE, "--offscreen", self.folder / "trainee"],
            "observer": ["eti-client", "--wait", FIRST_SCENE, "--observe", "--view", "all", "--offscreen", self.folder / "observer"],
        }
        self.programs = {
            role: Program(role, [self.bin / command[0], *command[1:], *bus, *(extra or {}).get(role, [])], self.folder)
            for role, command in commands.items()
        }
        self.server = self.programs["server"]
        self.pad = Pad(self.folder / "pad")
        self.suction = False

    def calibrate(self):
        """Registers both devices as a person would by touching the board's points, and keeps the files."""
        for device in ("simulated", "scripted"):
            done = subprocess.run([self.bin / "eti-calibrate", "simulate", "--device", device, "--out",
                                   self.folder / f"{device}.yaml"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                  text=True)
            if done.returncode != 0:
                raise SystemExit(f"eti-calibrate failed with exit status {done.returncode}:\n{done.stderr}")

    def start(self):
        self.folder.mkdir(parents=True, exist_ok=True)
        self.calibrate()
        self.pad.plug_in()
        for program in self.programs.values():
            program.start()

    def progress(self):
        """Simulation time and lag behind the clock [s] as the server last logged them, or None."""
        if not self.server.log.exists():
            return None
        with self.server.log.open("rb") as log:
            log.seek(max(0, log.seek(0, os.SEEK_END) - 4096))
            tail = log.read().decode(errors="replace")
        found = re.findall(r"simulation time ([\d.]+) s.*?([\d.]+) s behind", tail)
        return (float(found[-1][0]), float(found[-1][1])) if found else None

    def assist(self, time_s):
        """The assistant's input at this simulation time."""
        wanted = SUCTION[0] <= time_s < SUCTION[1]
        if wanted != self.suction:
            self.suction = wanted
            self.pad.press(0, wanted)

    def show_progress(self, progress):
        """One line, replacing the last one on a terminal: simulation time, and the share of an attempt's usual
        duration."""
        simulated, behind = progress
        line = f"simulated {simulated:.1f} s of about {USUAL_SESSION:.0f} s, {behind:.1f} s behind the clock"
        if self.on_terminal:
            put(f"\r\033[K{line}")
        else:
            self.say(line)

    def stop(self, why):
        """Asks the server to finish the session; the others end after it."""
        if self.stopping is None:
            self.stopping = why
            self.say(f"Stopping: {why}.")
            self.server.send(signal.SIGINT)

    def report_ended(self):
        """Reports how each newly ended process ended; returns those that failed."""
        failed = []
        for program in self.programs.values():
            if program.running() or program.reported:
                continue
            program.reported = True
            self.say(f"{program.name} {program.how_it_ended()}.")
            if program.exit_code() != 0:
                failed.append(program)
                for line in program.last_words():
                    self.say(f"  {program.name}: {line}")
        return failed

    def watch(self, keep_going=False):
        """Waits until the server has ended; returns False if it hung. When another process dies, stops the session."""
        began = moved = shown = time.monotonic()
        last = None
        asked = None
        while True:
            failed = self.report_ended()
            if not self.server.running():
                return True
            if failed and not keep_going:
                self.stop(f"{failed[0].name} died")
            now, progress = time.monotonic(), self.progress()
            if progress != last:
                moved, last = now, progress
            if progress:
                self.assist(progress[0])
            if now - moved > STALL_LIMIT:
                self.stop(f"no simulation time has passed for {STALL_LIMIT:.0f} s")
            if self.stopping:
                asked = asked or now
                if now - asked > END_ON_REQUEST:
                    return False
            if progress and now - shown > (1.0 if self.on_terminal else 10.0):
                shown = now
                self.show_progress(progress)
            elif now - shown > 10.0:
                shown = now
                self.say(f"Waiting for the server's first step: {now - began:.0f} s so far. Building a new patient takes "
                         "half a minute.")
            time.sleep(0.1)

    def finish(self):
        """Lets every process end by itself, then ends the remaining ones. Returns the names of those that had to be
        killed."""
        late = []
        deadline = time.monotonic() + (END_BY_ITSELF if not self.server.running() else 0.0)
        for program in self.programs.values():
            if program.process and not program.wait(deadline - time.monotonic()):
                late.append(program.name)
        for name in late:
            self.say(f"{name} did not exit; terminating it.")
            self.programs[name].send(signal.SIGTERM)
        deadline = time.monotonic() + END_ON_REQUEST
        for name in late:
            if not self.programs[name].wait(deadline - time.monotonic()):
                self.say(f"{name} did not answer SIGTERM; killing it.")
                self.programs[name].send(signal.SIGKILL)
                self.programs[name].wait(END_ON_REQUEST)
        self.pad.unplug()
        self.report_ended()
        return late

    def summary(self):
        """The session's summary from eti-review: a dictionary, and the printed table."""
        review = [self.bin / "eti-review", "summary", self.record]
        as_json = subprocess.run([*review, "--json"], stdout=subprocess.PIPE, text=True, check=True)
        table = subprocess.run(review, stdout=subprocess.PIPE, text=True, check=True)
        return json.loads(as_json.stdout), table.stdout

    def report(self):
        """Writes the report page of the session; returns its path, or None if eti-review was built without it."""
        done = subprocess.run([self.bin / "eti-review", "report", self.record, "--out", self.folder],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            self.say(f"No report was written: {done.stderr.strip()}")
            return None
        return Path(done.stdout.strip())

    def said(self, role):
        """The JSON object that a process printed, or an empty one."""
        try:
            return json.loads(self.programs[role].output.read_text())
        except (OSError, json.JSONDecodeError):
            return {}

    def products(self, suffix):
        """Files of a kind written by the clients, oldest first."""
        found = [file for role in ("trainee", "observer") for file in (self.folder / role).glob(f"*{suffix}")]
        return sorted((file for file in found if file.stat().st_size > 0), key=lambda file: file.stat().st_mtime)


def prepare_folder(folder):
    """Creates the results folder and checks that it is writable; raises SystemExit with the problem and its remedy."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        trial = folder / ".written"
        trial.write_bytes(b"x" * 4096)
        trial.unlink()
    except OSError as error:
        remedy = "free some space" if error.errno in (errno.ENOSPC, errno.EDQUOT) else "choose another folder"
        sys.exit(f"demo: cannot write to {folder}: {error.strerror}. Remedy: {remedy}, or --out DIR.")
    free = shutil.disk_usage(folder).free
    if free < SPACE_NEEDED:
        sys.exit(f"demo: {folder} has {free / 1e6:.0f} MB left, a demo may need {SPACE_NEEDED / 1e6:.0f} MB. "
                 "Remedy: free some space, or --out DIR on another disk.")


def pace(server, haptics):
    """How well server and hand kept up with real time, from their final reports: lines of a table."""
    rows = []
    if haptics.get("cycles", 0) > 0:
        rows.append(("Forces were complete", f"{100 * (1 - haptics['stale_share']):.1f} % of the time"))
        rows.append(("Largest force felt", f"{haptics['force_n']['max']:.1f} N"))
    if server.get("steps", 0) > 0:
        simulated = server["steps"] * 1e-3 * server["step_budget_ms"]
        behind = server["behind_s"]
        rows.append(("Simulated at", f"{server['quality']} quality"))
        rows.append(("The server fell behind", f"{100 * behind / (simulated + behind):.1f} % of the time "
                                               f"({behind:.1f} s in {simulated + behind:.1f} s)"))
        rows.append(("A step took", f"{server['step_ms']['p50']:.1f} ms, one in a hundred more than "
                                    f"{server['step_ms']['p99']:.1f} ms, of {server['step_budget_ms']:.1f} ms"))
    return [f"{name:<24}{value}" for name, value in rows]


def show(session):
    """Prints a session's results; returns True if the trachea was intubated and all requested files exist."""
    try:
        summary, table = session.summary()
    except (subprocess.CalledProcessError, json.JSONDecodeError) as error:
        session.say(f"The session file cannot be read: {error}. Remedy: eti-review check --repair {session.record}")
        return False
    print(table)
    intubated = "The trachea was intubated" if summary.get("success") else "The trachea was not intubated"
    print(f"{intubated}: {summary.get('reason')}.\n")
    for line in pace(session.said("server"), session.said("haptics")):
        print(line)
    controller = session.said("controller")
    if controller:
        print(f"The assistant sent {controller['commands']} commands, {controller['accepted']} were accepted.\n")
    print(f"Session file  {session.record}")
    print(f"Calibrations  {session.folder / 'simulated.yaml'}, {session.folder / 'scripted.yaml'}")
    pictures, videos = session.products(".png"), session.products(".mp4")
    for folder in sorted({picture.parent for picture in pictures}):
        print(f"Pictures      {folder} ({sum(picture.parent == folder for picture in pictures)})")
    for video in videos:
        print(f"Video         {video}")
    report = session.report()
    if report:
        print(f"Report        {report}")
    print(f"Logs          {session.folder / 'logs'}")
    for kind, files in (("picture", pictures), ("video", videos)):
        if not files:
            session.say(f"No {kind} was written; see {session.programs['trainee'].log}.")
    return bool(summary.get("success")) and bool(pictures) and bool(videos)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help="folder of the programs")
    parser.add_argument("--scenario", default="term")
    parser.add_argument("--operator", default="expert")
    parser.add_argument("--out", type=Path, default=ROOT / "out/demo")
    parser.add_argument("--domain", type=int, default=0)
    parser.add_argument("--keep-going", action="store_true")
    options = parser.parse_args()

    name = f"demo-{os.getpid()}"
    folder = (options.out / name).absolute()
    missing = [p for p in ("eti-server", "eti-haptics", "eti-tracker", "eti-controller", "eti-calibrate", "eti-client",
                             "eti-review")
               if not (options.bin / p).exists()]
    if missing:
        sys.exit(f"demo: {options.bin} lacks {', '.join(missing)}. Remedy: run deploy/demo.sh without --no-build.")
    prepare_folder(folder)

    session = Session(options.bin, folder, options.scenario, options.operator, options.domain, name)
    for number, why in ((signal.SIGINT, "interrupted"), (signal.SIGTERM, "terminated")):
        signal.signal(number, lambda *_, why=why: session.stop(why))
    session.say(f"Session {name}: {options.operator} intubates in scenario {options.scenario}.")
    session.start()
    session.watch(options.keep_going)
    late = session.finish()
    succeeded = show(session) if session.record.exists() else False
    ended_well = not late and all(p.exit_code() == 0 for p in session.programs.values())
    if session.stopping:
        session.say(f"The demo was stopped: {session.stopping}.")
    elif not ended_well:
        session.say("Some processes failed; see above.")
    return 0 if succeeded and ended_well and not session.stopping else 1


if __name__ == "__main__":
    sys.exit(main())
