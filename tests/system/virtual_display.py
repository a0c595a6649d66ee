# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A virtual display with synthetic keyboard and mouse input."""

import os
import subprocess
import time


class VirtualDisplay:
    """Programs started during its lifetime open their windows there."""

    def __init__(self, width=1280, height=800):
        read, write = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", f"{width}x{height}x24", "-nolisten", "tcp", "-noreset"],
            pass_fds=[write], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as number:
            self.name = f":{number.readline().strip()}"
        self.before = os.environ.get("DISPLAY")
        os.environ["DISPLAY"] = self.name

    def close(self):
        self.server.terminate()
        self.server.wait(10)
        if self.before is None:
            os.environ.pop("DISPLAY", None)
        else:
            os.environ["DISPLAY"] = self.before

    def do(self, *words):
        return subprocess.run(["xdotool", *map(str, words)], capture_output=True, text=True, timeout=120, check=True,
                              env={**os.environ, "DISPLAY": self.name}).stdout

    def find(self, title, seconds=60):
        """The window of that title, with the keyboard focus; only a mapped window can take it."""
        end = time.monotonic() + seconds
        while True:
            found = subprocess.run(["xdotool", "search", "--onlyvisible", "--name", title], capture_output=True, text=True, timeout=120,
                                   env={**os.environ, "DISPLAY": self.name}).stdout.split()
            if found:
                self.do("windowmove", "--sync", found[-1], 0, 0)
                self.do("windowfocus", "--sync", found[-1])
                return found[-1]
            if time.monotonic() > end:
                raise TimeoutError(f"no window '{title}'")
            time.sleep(0.2)

    def size(self, window):
        """Width and height [pixels]."""
        said = dict(line.split("=") for line in self.do("getwindowgeometry", "--shell", window).split())
        return int(said["WIDTH"]), int(said["HEIGHT"])

    def key(self, name, held=0.15):
        """Holds a key for several pictures: a key pressed and released between two of them is not seen."""
        self.do("keydown", name)
        time.sleep(held)
        self.do("keyup", name)
        time.sleep(held)

    def type(self, text):
        self.do("type", "--delay", 100, text)
        time.sleep(0.2)

    def click(self, x, y):
        self.do("mousemove", x, y)
        time.sleep(0.15)
        self.do("mousedown", 1)
        time.sleep(0.15)
        self.do("mouseup", 1)
