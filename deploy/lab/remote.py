# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Programs on other machines, over ssh."""

import shlex
import signal
import subprocess
from pathlib import Path

from hosts import LabError
from session_run import Program, die_with_parent

# BatchMode: never asks for a password. The other options detect a lost machine within 15 s.
SSH = ["ssh", "-o", "BatchMode=yes", "-o", "ConnectTimeout=10", "-o", "ServerAliveInterval=5",
       "-o", "ServerAliveCountMax=3"]

# Signals arrive as lines; end of file means that ssh or its parent has ended, and then the program must end, too.
RUN = """
exec 3<&0
"$@" </dev/null 3<&- & program=$!
{ while read -r number; do kill -s "$number" $program; done <&3
  kill -s TERM $program; sleep 10; kill -s KILL $program; } >/dev/null 2>&1 &
listener=$!
wait $program; status=$?
kill $listener >/dev/null 2>&1
exit $status
"""


class RemoteProgram(Program):
    """A program on another machine; its output is logged here."""

    def __init__(self, name, machine, command, folder):
        line = " ".join(shlex.quote(str(part)) for part in ["sh", "-c", RUN, "sh", *command])
        super().__init__(name, [*SSH, machine, line], folder)

    def start(self):
        self.log.parent.mkdir(parents=True, exist_ok=True)
        with self.log.open("wb") as log, self.output.open("wb") as output:
            self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE, stdout=output, stderr=log,
                                            start_new_session=True, preexec_fn=die_with_parent)

    def send(self, number):
        if not self.running():
            return
        if number == signal.SIGKILL:
            self.process.kill()     # kills ssh; the other machine does the rest
            return
        try:
            self.process.stdin.write(f"{signal.Signals(number).name.removeprefix('SIG')}\n".encode())
            self.process.stdin.flush()
        except BrokenPipeError:
            pass


class RemoteHost:
    """A machine that ssh reaches without a password."""

    def __init__(self, name, machine):
        self.name = name
        self.machine = machine
        self.address = machine.rpartition("@")[2]

    def run(self, *command):
        line = " ".join(shlex.quote(str(part)) for part in command)
        done = subprocess.run([*SSH, self.machine, line], stdin=subprocess.DEVNULL, capture_output=True)
        if done.returncode != 0:
            raise LabError(f"{self.name} on {self.machine}: {line}: {done.stderr.decode(errors='replace').strip()}; "
                           f"try: ssh {self.machine} {line}")
        return done.stdout

    def program(self, role, command, folder):
        return RemoteProgram(role, self.machine, command, folder)

    def send_folder(self, folder):
        """Copies a folder to the same path there."""
        archive = subprocess.run(["tar", "-C", folder, "-c", "."], check=True, capture_output=True).stdout
        there = shlex.quote(str(folder))
        done = subprocess.run([*SSH, self.machine, f"umask 077; mkdir -p {there} && tar -C {there} -x"], input=archive,
                              capture_output=True)
        if done.returncode != 0:
            raise LabError(f"{self.name} on {self.machine}: {done.stderr.decode(errors='replace').strip()}")

    def fetch(self, file):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(self.run("cat", file))

    def close(self):
        pass


def read_hosts(file, roles):
    """{role: machine} from lines 'ROLE MACHINE'; MACHINE as ssh takes it. Raises LabError."""
    found = {}
    try:
        lines = Path(file).read_text().splitlines()
    except OSError as error:
        raise LabError(f"{file}: {error.strerror}") from error
    for number, line in enumerate(lines, 1):
        words = line.partition("#")[0].split()
        if not words:
            continue
        if len(words) != 2 or words[1].startswith("-"):
            raise LabError(f"{file}:{number}: '{line.strip()}'; expected a role and a machine, e.g. "
                           "'server alice@rack1'")
        if words[0] not in roles:
            raise LabError(f"{file}:{number}: no role '{words[0]}'; expected one of {', '.join(roles)}")
        if words[0] in found:
            raise LabError(f"{file}:{number}: {words[0]} has a machine already, {found[words[0]]}")
        found[words[0]] = words[1]
    if "server" not in found:
        raise LabError(f"{file}: no line 'server MACHINE'; every lab has a server")
    return found
