# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Takes a picture of a program's window on a virtual display.

Usage: window_picture.py [--seconds S] [--keys "KEY ..."] OUT.png PROGRAM ARGUMENT...
Waits S seconds after the window has opened, presses the keys (xdotool's names), takes the picture and ends the program.
"""

import argparse
import subprocess
import sys
import time
from pathlib import Path

from PIL import ImageGrab

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "system"))
from virtual_display import VirtualDisplay  # noqa: E402


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--seconds", type=float, default=10.0, help="after the window has opened [s]")
    parser.add_argument("--keys", default="", help="pressed one after the other before the picture, e.g. 'F1 e'")
    parser.add_argument("out", type=Path)
    parser.add_argument("program", nargs=argparse.REMAINDER)
    options = parser.parse_args()
    display = VirtualDisplay(3840, 2160)
    try:
        program = subprocess.Popen(options.program, stdin=subprocess.DEVNULL)
        try:
            window = display.find("NeoETI")
            time.sleep(options.seconds)
            for key in options.keys.split():
                display.key(key)
            width, height = display.size(window)
            ImageGrab.grab((0, 0, width, height), xdisplay=display.name).convert("RGB").save(options.out, optimize=True)
        finally:
            program.terminate()
            program.wait(20)
    finally:
        display.close()


if __name__ == "__main__":
    main()
