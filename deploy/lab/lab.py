#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A whole lab: every program on a host of its own, in namespaces of this machine or on real machines over ssh."""

import argparse
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import hosts
import remote
import repeat
import session_run
from hosts import LabError

ROOT = session_run.ROOT
DISCOVERY_PORT = 11811
# Permission role of each program of a session in a secured lab (deploy/security).
IDENTITY = {"server": "server", "haptics": "laryngoscope", "tracker": "tube", "controller": "instructor",
            "trainee": "trainee", "observer": "observer", "observer-2": "observer"}
ROLES = (*IDENTITY, "discovery", "discovery-2")
CLIENTS = ("trainee", "observer", "observer-2")
# The controller belongs to the assistant, who stands beside the trainee.
HOST_OF = {"controller": "trainee"}
MEETINGS = ("discovery", "multicast", "peers")


def discovery_command(bin_folder, number, address):
    """A discovery server; `number`: its index in the list that programs are given."""
    return [Path(bin_folder) / "eti-discovery", "--number", number, "--address", address, "--port", DISCOVERY_PORT]


class Namespace(hosts.Host):
    """A host on this machine for a lab."""

    def program(self, role, command, folder):
        return session_run.Program(role, [*self.enter(), *command], folder)

    def send_folder(self, folder):
        pass

    def fetch(self, file):
        pass


class Lab(session_run.Session):
    """A session whose programs run on hosts; see Session for monitoring and ending it."""

    def __init__(self, options, folder, say=None):
        say = say or session_run.say
        quiet = ["--every", 0, "--no-video"] if not options.pictures else []
        observer = ["--wait", session_run.FIRST_SCENE, "--observe", "--json", "--offscreen", folder / "observer-2", *quiet]
        super().__init__(options.bin_there, folder, options.scenario, options.operator, options.domain, say=say,
                         name=f"lab-{os.getpid()}",
                         extra={"trainee": ["--json", *quiet], "observer": ["--json", *quiet]})
        self.options = options
        command = [self.bin / "eti-client", *observer, "--session", self.name, "--domain", options.domain]
        self.programs["observer-2"] = session_run.Program("observer-2", command, folder)
        self.complete_at = None     # [s] of simulation time at which all clients had the scene
        self.hosts, self.medium, self.discovery, self.passed = {}, None, [], {}

    # -- hosts

    def make_hosts(self):
        """Raises LabError or OSError, after cleaning up."""
        names = [name for name in IDENTITY if name not in HOST_OF]
        if self.options.meet == "discovery":
            names += ["discovery", "discovery-2"][:self.options.discovery_servers]
        if self.options.hosts:
            machines = remote.read_hosts(self.options.hosts, ROLES)
            self.programs = {role: program for role, program in self.programs.items() if role in machines}
            self.hosts = {role: remote.RemoteHost(role, machine) for role, machine in machines.items()}
            if self.options.meet == "discovery" and "discovery" not in machines:
                raise LabError(f"{self.options.hosts}: no line 'discovery MACHINE'; add it, or give --meet multicast "
                               "or --meet peers")
            return
        for name in names:
            self.hosts[name] = Namespace(name)
        self.medium = hosts.Medium(self.options.bin, list(self.hosts.values()), delay=self.options.delay,
                                   jitter=self.options.jitter, loss=self.options.loss, rate=self.options.rate,
                                   multicast=not self.options.no_multicast, seed=self.options.seed)

    def host(self, role):
        return self.hosts.get(role) or self.hosts[HOST_OF[role]]

    def meeting(self, role):
        """Discovery options of a program."""
        if self.options.meet == "multicast":
            return ["--network"]
        if self.options.meet == "discovery":
            return [word for name in ("discovery", "discovery-2") if name in self.hosts
                    for word in ("--discovery-server", f"{self.hosts[name].address}:{DISCOVERY_PORT}")]
        others = {host.address for other, host in self.hosts.items() if other in IDENTITY}
        return [word for address in sorted(others - {self.host(role).address}) for word in ("--peer", address)]

    # -- life cycle of a session

    def secure(self):
        """Creates the lab's identities and sends each host its own."""
        script = ROOT / "deploy/security/make_lab.sh"
        if not script.exists():
            raise LabError(f"--security: {script} is not there, which creates the lab's identities")
        folder = self.folder / "security"
        wanted = [word for role in self.programs for word in ("--role", f"{IDENTITY[role]}:{role}")]
        subprocess.run([script, "--out", folder, "--session", self.name, *wanted], check=True,
                       stdout=subprocess.DEVNULL)
        for role in self.programs:
            self.host(role).send_folder(folder / role)

    def calibrate(self):
        for role, device in (("haptics", "simulated"), ("tracker", "scripted")):
            if role in self.programs:
                self.host(role).run("mkdir", "-p", self.folder)
                self.host(role).run(self.bin / "eti-calibrate", "simulate", "--device", device, "--out",
                                    self.folder / f"{device}.yaml")

    def start(self):
        self.folder.mkdir(parents=True, exist_ok=True)
        self.make_hosts()
        if self.options.security:
            self.secure()
        for role in self.programs:
            self.host(role).run("mkdir", "-p", self.folder)
        self.calibrate()
        for number, name in enumerate(("discovery", "discovery-2")):
            if name in self.hosts and self.options.meet == "discovery":
                host = self.hosts[name]
                self.discovery.append(host.program(name, discovery_command(self.bin, number, host.address), self.folder))
                self.discovery[-1].start()
        if "controller" in self.programs and self.options.hosts:
            # Its pad is a pipe that this script writes to: not available on another machine.
            del self.programs["controller"]
        if "controller" in self.programs:
            self.pad.plug_in()
        for role, program in list(self.programs.items()):
            identity = ["--identity", self.folder / "security" / role] if self.options.security else []
            command = [*program.command, *self.meeting(role), *identity]
            self.programs[role] = self.host(role).program(role, command, self.folder)
            self.programs[role].start()
        self.server = self.programs["server"]

    def assist(self, time_s):
        if "controller" in self.programs:
            super().assist(time_s)
        if self.options.duration:
            self.end_in_time(time_s)

    def end_in_time(self, time_s):
        """Ends the session once all clients have been in it for the requested duration: joining may take seconds."""
        if self.complete_at is None:
            if all("scene is complete" in program.log.read_text(errors="replace")
                   for role, program in self.programs.items() if role in CLIENTS):
                self.complete_at = time_s
        elif time_s >= self.complete_at + self.options.duration:
            self.server.send(signal.SIGINT)

    def abandon(self):
        """Ends a lab that failed to start."""
        self.programs = {role: program for role, program in self.programs.items() if program.process}
        for program in self.programs.values():
            program.send(signal.SIGTERM)
        self.finish()

    def close(self):
        """Ends what is left of it. Call finish() first."""
        for program in self.discovery:
            program.send(signal.SIGTERM)
        for program in self.discovery:
            if not program.wait(session_run.END_ON_REQUEST):
                program.send(signal.SIGKILL)
                program.wait(session_run.END_ON_REQUEST)
        if self.medium:
            self.passed = self.medium.close()
        for host in self.hosts.values():
            host.close()

    def what_was_seen(self):
        """Each program's report on its session and the traffic between the hosts, for printing as JSON."""
        programs = {}
        for role, program in self.programs.items():
            how = program.how_it_ended() if program.process else "not started"
            programs[role] = {**self.said(role), "process": how}
        return {"session": self.name, "programs": programs, "medium": self.passed}


def lines_of(seen):
    """The same as lines for a person."""
    for role, said in seen["programs"].items():
        parts = [said["process"]]
        if "state_age_ms" in said:
            parts += [f"{said['frames']} frames", f"states missed {said['states_missed']}",
                      f"age {said['state_age_ms']['mean']:.1f} ms, at most {said['state_age_ms']['max']:.0f}"]
        if "stale_share" in said:
            parts += [f"full forces {100 *  (1 - said['stale_share']):.1f} % of the time",
                      f"at most {said['force_n']['max']:.1f} N"]
        if "step_ms" in said and said.get("steps"):
            parts += [f"{said['steps']} steps",
                      f"a step {said['step_ms']['p50']:.1f} ms, p99 {said['step_ms']['p99']:.1f}",
                      f"{said['behind_s']:.1f} s behind"]
        yield f"{role:<12}{'; '.join(parts)}"
    for host, count in seen["medium"].items():
        yield (f"{host:<12}sent {1e-6 * count['sent']['bytes']:.1f} MB, "
               f"received {1e-6 * count['received']['bytes']:.1f} MB; {count['lost']} frames lost on the way to it")


def parse():
    parser = argparse.ArgumentParser(prog="deploy/lab.sh", description=__doc__)
    link = parser.add_argument_group("medium between the hosts (network namespaces)")
    link.add_argument("--delay", type=float, default=0.0, metavar="MS", help="one-way delay")
    link.add_argument("--jitter", type=float, default=0.0, metavar="MS", help="additional delay, uniform from 0")
    link.add_argument("--loss", type=float, default=0.0, metavar="PCT", help="share of frames lost, independently")
    link.add_argument("--rate", type=float, default=0.0, metavar="MBIT", help="rate of each host in each direction; 0: no limit")
    link.add_argument("--no-multicast", action="store_true", help="drop multicast")
    link.add_argument("--seed", type=int, default=1, help="seed of the losses (default: %(default)s)")
    parser.add_argument("--meet", choices=MEETINGS, help="how programs find each other (default: by a discovery "
                        "server; with --security by multicast, or by peers where it does not pass)")
    parser.add_argument("--discovery-servers", type=int, choices=(1, 2), default=1, help="the second is a backup")
    parser.add_argument("--security", action="store_true", help="encrypt; every role has its own identity")
    parser.add_argument("--hosts", type=Path, metavar="FILE", help="on real machines over ssh; lines 'ROLE MACHINE', "
                        f"roles: {', '.join(ROLES)}")
    parser.add_argument("--bin-there", type=Path, metavar="DIR", help="folder of the programs on those machines")
    parser.add_argument("--duration", type=float, metavar="S", help="longest simulation time after all clients have the scene")
    parser.add_argument("--scenario", default="term")
    parser.add_argument("--operator", default="expert")
    parser.add_argument("--pictures", action="store_true", help="clients also write pictures and a video")
    parser.add_argument("--out", type=Path, default=ROOT / "out/lab", help="folder for logs and session file, in a subfolder of "
                        "their own (default: out/lab)")
    parser.add_argument("--domain", type=int, default=0, metavar="N")
    parser.add_argument("--repeat", type=int, default=1, metavar="N", help="run N sessions, and print how many failed; logs "
                        "of those are kept")
    parser.add_argument("--at-once", type=int, default=1, metavar="N", help="with --repeat: how many at a time (default: 1)")
    parser.add_argument("--json", action="store_true", help="print the results as one JSON object")
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help=argparse.SUPPRESS)
    options = parser.parse_args()
    options.bin, options.out = options.bin.absolute(), options.out.absolute()
    options.bin_there = options.bin_there or options.bin
    if not options.hosts:
        # Entering a namespace changes the working folder.
        for name in ("scenario", "operator"):
            if Path(getattr(options, name)).is_file():
                setattr(options, name, str(Path(getattr(options, name)).absolute()))
    if options.meet is None:
        # A secured lab admits no discovery server without an identity.
        options.meet = "discovery" if not options.security else "peers" if options.no_multicast else "multicast"
    if options.security and options.meet == "discovery":
        parser.error("--security with --meet discovery: no identity is made for the discovery server; "
                     "give --meet multicast or --meet peers")
    if options.no_multicast and options.meet == "multicast":
        parser.error("--no-multicast with --meet multicast: programs would not find each other; give --meet discovery or --meet peers")
    if options.repeat < 1 or options.at_once < 1:
        parser.error("--repeat and --at-once: expected 1 or more")
    if options.hosts and options.repeat > 1:
        parser.error("--hosts with --repeat: sessions are repeated on this machine only")
    if options.hosts and any((options.delay, options.jitter, options.loss, options.rate, options.no_multicast)):
        parser.error("--hosts with --delay, --jitter, --loss, --rate or --no-multicast: these apply to simulated networks " 
                     "only")
    return options


def repeat_sessions(options):
    repeated = repeat.Repeated(options, sys.argv[1:])
    handle_signals(repeated.stop)
    return repeated.run()


def handle_signals(stop):
    for number, why in ((signal.SIGINT, "interrupted"), (signal.SIGTERM, "terminated"), (signal.SIGHUP, "hung up")):
        signal.signal(number, lambda *_, why=why: stop(why))


def main():
    options = parse()
    why_not = None if options.hosts else hosts.why_impossible(options.bin)
    if why_not:
        sys.exit(f"lab: {why_not}")
    if options.repeat > 1:
        return repeat_sessions(options)
    folder = options.out / f"lab-{os.getpid()}"
    session_run.prepare_folder(folder)
    lab = Lab(options, folder)
    handle_signals(lab.stop)
    late = []
    try:
        lab.start()
        lab.say(f"Lab {lab.name}: {', '.join(lab.hosts)}; discovery by {options.meet}; {options.delay:g} ms, "
                f"{options.loss:g} % lost{', secured' if options.security else ''}.")
        lab.watch()
        late = lab.finish()
        lab.host("server").fetch(lab.record)
    except (LabError, subprocess.CalledProcessError) as error:
        lab.stop(str(error))
        lab.abandon()
        return 1
    finally:
        lab.close()
    seen = lab.what_was_seen()
    print(json.dumps(seen, indent=2) if options.json else "\n".join(lines_of(seen)))
    lab.say(f"Logs {folder / 'logs'}, session file {lab.record}")
    return 0 if not late and not lab.stopping and all(p.exit_code() == 0 for p in lab.programs.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
