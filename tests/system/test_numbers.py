# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Every number of every command line, tried at and beyond its limits.

The programs' own `--help` lists the options and their types, so that a new option, subcommand or program is tried
without being named here. An option whose value the help calls FLOAT, INT or UINT was declared without limits.
"""

import re
import unittest
from decimal import Decimal

import support

PROGRAMS = sorted(p.name for p in support.BIN.glob("eti-*") if p.is_file())
# Their options are Python's or those of the programs they start; see test_launchers().
LAUNCHERS = {"eti-bench", "eti-bench-bus"}
BUS_PARTS = ("join", "write-poses", "read-poses", "read-states")
SECONDS_TO_REFUSE = 30
NO_NUMBERS = ("nan", "inf", "0x10", "5mm")  # more of them in tests/unit/common/process/command_line_test.cpp
LONGEST_MESSAGE = 300  # letters; the largest double alone has 309


def help_of(*command):
    done = support.run(*command, "--help")
    assert done.returncode == 0, f"{command}: {done.stderr}"
    return done.stdout


def subcommands(text):
    listed = re.search(r"^Subcommands:\n(.*?)(?:^\S|\Z)", text, re.MULTILINE | re.DOTALL)
    return re.findall(r"^  (\S+)", listed.group(1), re.MULTILINE) if listed else []


class Option:
    """A numeric option: its name and its limits."""

    def __init__(self, command, name, kind, low, high):
        self.command, self.name, self.whole = command, name, kind == "COUNT"
        self.low, self.high = Decimal(low), Decimal(high) if high else None

    def refused(self):
        """Values that this option must reject."""
        yield from NO_NUMBERS
        yield str(2**64) if self.whole or self.high else "1" + "0" * 400
        yield str(self.low - 1)
        if self.high is not None:
            yield str(self.high + 1)


def options_of(*command):
    """The numeric options in a command's help, and the names of those declared without limits."""
    text = help_of(*command)
    found, unlimited = [], []
    for name, rest in re.findall(r"^  (?:-\w,)?(--[\w-]+)((?: .*|)(?:\n {6,}.*)*)", text, re.MULTILINE):
        words = " ".join(rest.split())
        if re.match(r"(FLOAT|INT|UINT|NUMBER(?! \[)|COUNT(?! \[))", words):
            unlimited.append(f"{' '.join(command)} {name}")
        if limits := re.match(r"(NUMBER|COUNT) \[(-?[\d.e+]+)(?: to (-?[\d.e+]+)| or more)", words):
            found.append(Option(command, name, *limits.groups()))
    return found, unlimited


def commands():
    for program in PROGRAMS:
        if program in LAUNCHERS:
            continue
        yield (program,)
        for sub in subcommands(help_of(program)):
            yield (program, sub)
    if "eti-bench-bus" in PROGRAMS:
        yield from (("eti-bench-bus", part) for part in BUS_PARTS)


class Numbers(support.Case):
    def test_every_numeric_option_has_limits(self):
        found, unlimited = {}, []
        for command in commands():
            options, without = options_of(*command)
            found[command] = options
            unlimited += without
        self.assertEqual(unlimited, [], "declare them by add_number(), common/process/command_line.hpp")
        names = {option.name for options in found.values() for option in options}
        # Options that once accepted NaN or crashed are among those tried.
        self.assertLessEqual({"--closing-mm", "--noise-hu", "--silence-ms", "--duration", "--stylus-diameter-mm",
                              "--steps", "--seed"}, names)
        self.assertGreater(sum(map(len, found.values())), 60)

    def test_invalid_numbers_are_refused_with_range(self):
        for command in commands():
            for option in options_of(*command)[0]:
                for value in option.refused():
                    with self.subTest(command=" ".join(command), option=option.name, value=value[:20]):
                        done = support.run(*command, f"{option.name}={value}", timeout=SECONDS_TO_REFUSE,
                                           cwd=self.folder)
                        self.assertEqual(done.returncode, 2, f"{done.stdout}\n{done.stderr}")
                        said = done.stderr.splitlines()[0]
                        self.assertIn(option.name, said)
                        self.assertIn("expected a ", said)
                        self.assertIn(f"{option.low} ", said)
                        self.assertLess(len(said), LONGEST_MESSAGE)
        self.assertEqual(list(self.folder.iterdir()), [], "something was written before the refusal")

    def test_launchers(self):
        for arguments in ((), ("NO_SUCH",), ("NO_SUCH", "--help"), ("NO_SUCH", "--version"), ("--no-such", "--help")):
            with self.subTest(arguments):
                self.assertEqual(support.run("eti-bench", *arguments).returncode, 2)
        self.assertIn("NO_SUCH", support.run("eti-bench", "NO_SUCH", "--help").stderr)
        for arguments in (("--help",), ("--version",), ("speed", "--help"), ("--threads", "1", "speed", "--help")):
            with self.subTest(arguments):
                self.assertEqual(support.run("eti-bench", *arguments).returncode, 0)
        for option in ("--tries", "--soak"):
            for value in ("nan", "inf", "-1", "0", "18446744073709551616"):
                with self.subTest(option=option, value=value):
                    self.assert_refused(support.run("eti-bench-bus", f"{option}={value}", cwd=self.folder), option)


if __name__ == "__main__":
    unittest.main()
