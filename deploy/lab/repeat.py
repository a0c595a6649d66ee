# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Many sessions of a lab, some at a time, each by a lab.py of its own."""

import concurrent.futures
import json
import os
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import session_run

LAB = Path(__file__).with_name("lab.py")


class Repeated:
    """Runs `options.repeat` sessions with the arguments of one. Of sessions that end well only the count is kept."""

    def __init__(self, options, arguments):
        self.options, self.arguments = options, arguments
        self.folder = options.out / f"labs-{os.getpid()}"
        self.running, self.lock = set(), threading.RLock()  # stop() may interrupt itself
        self.done, self.failed, self.stopping = 0, [], False

    def stop(self, why):
        """Ends the running sessions in order, and begins no other."""
        with self.lock:
            if not self.stopping:
                session_run.say(f"Stopping: {why}.")
            self.stopping = True
            for process in self.running:
                process.terminate()

    def session(self, number):
        folder = self.folder / str(number)
        # Of an option that is given twice, the last counts.
        command = [sys.executable, "-B", LAB, *self.arguments, "--repeat", 1, "--json", "--out", folder]
        folder.mkdir(parents=True)
        with (folder / "lab.log").open("wb") as log, (folder / "lab.json").open("wb") as out:
            with self.lock:
                if self.stopping:
                    return
                # In a group of its own: Ctrl-C reaches it by stop() alone.
                process = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=out,
                                           stderr=log, start_new_session=True,
                                           preexec_fn=session_run.die_with_parent)
                self.running.add(process)
            status = process.wait()
        with self.lock:
            self.running.discard(process)
            if self.stopping:
                return
            self.done += 1
            if status != 0:
                self.failed.append(number)
                session_run.say(f"Session {number} failed with exit status {status}: {folder / 'lab.log'}")
            elif self.done % 10 == 0:
                session_run.say(f"{self.done} of {self.options.repeat} sessions, {len(self.failed)} failed")
        if status == 0:
            shutil.rmtree(folder)

    def run(self):
        """Returns the exit status: 0 if all were run and ended well."""
        with concurrent.futures.ThreadPoolExecutor(self.options.at_once) as pool:
            list(pool.map(self.session, range(1, self.options.repeat + 1)))
        if not self.failed:
            shutil.rmtree(self.folder, ignore_errors=True)
        result = {"sessions": self.done, "failed": sorted(self.failed)}
        print(json.dumps(result) if self.options.json else
              f"{self.done} sessions, {len(self.failed)} failed" +
              (f": {', '.join(map(str, result['failed']))}, logs in {self.folder}" if self.failed else ""))
        return 0 if self.done == self.options.repeat and not self.failed else 1
