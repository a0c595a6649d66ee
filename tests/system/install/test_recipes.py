# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Recipes for external CI and containers: they are well formed, name existing files, and their commands work."""

import json
import os
import re
import shutil
import signal
import subprocess
import unittest

import support
from operator_run import FOLDER, result
from support import BIN, DOMAIN, ROOT, SESSION

try:
    import yaml
except ImportError:
    raise unittest.SkipTest("no python3-yaml here")

CI = ROOT / "deploy/ci"
OCI = ROOT / "deploy/oci"


class Recipes(support.Case):
    def setUp(self):
        super().setUp()
        if shutil.which("jq") is None:
            self.skipTest("no jq here")

    def stand_in(self):
        """The folder of a stand-in server that returns the result kept by operator_run.py. It lies where a job that
        builds has its own."""
        server = self.folder / "build/release/bin/eti-server"
        server.parent.mkdir(parents=True)
        server.write_text(f'#!/bin/sh\nwhile [ "$1" != --operator ]; do shift; done\nexec cat "{FOLDER}/$2.json"\n')
        server.chmod(0o755)
        return server.parent

    def shell(self, line, **environment):
        """Runs a recipe's line as a runner does, with the programs under test in PATH, in a folder of its own."""
        (self.folder / "deploy").mkdir(exist_ok=True)
        if not (self.folder / "deploy/ci").exists():
            shutil.copytree(CI, self.folder / "deploy/ci")
        return subprocess.run(["sh", "-ec", line], cwd=self.folder, capture_output=True, text=True, timeout=300,
                              env={**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}", **environment})

    def assert_intubated(self, done):
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("intubated: ", done.stdout)
        self.assertTrue(json.loads((self.folder / "result.json").read_text())["success"])

    def test_github_workflow_intubates(self):
        job, = yaml.safe_load((CI / "github.yaml").read_text())["jobs"].values()
        lines = [step["run"] for step in job["steps"] if "run" in step]
        for scenario in job["strategy"]["matrix"]["scenario"]:
            self.assertTrue((ROOT / f"deploy/data/scenarios/{scenario}.yaml").is_file())
        install, intubate = lines
        for package in re.findall(r"/(neoeti-\w+)_\*\.deb", install):
            self.assertIn(f"eti_package({package[7:]} ", (ROOT / "cmake/package.cmake").read_text())
        self.assert_intubated(self.shell(intubate.replace("${{ matrix.scenario }}", "term")))

    def test_gitlab_job_intubates(self):
        job = yaml.safe_load((CI / "gitlab.yaml").read_text())["intubation"]
        for line in job["before_script"]:
            program = line.split()[0]
            self.assertTrue((ROOT / program).is_file() or shutil.which(program), line)
        options = set(re.findall(r"-D(\w+)", " ".join(job["before_script"])))
        known = re.findall(r"option\((\w+)", (ROOT / "CMakeLists.txt").read_text())
        self.assertEqual(options, {"ETI_CLIENT", "ETI_TESTS"} & set(known))
        line, = job["script"]
        self.stand_in()  # which the line must prefer to the one in PATH
        self.assert_intubated(self.shell(line, SCENARIO="term"))
        self.assertEqual(json.loads((self.folder / "result.json").read_text()), result("expert"))

    def test_judge_script_fails_on_unmet_expectation(self):
        path = f"{self.stand_in()}:{os.environ['PATH']}"
        done = self.shell("deploy/ci/judge.sh term no_lift", PATH=path)
        self.assertEqual(done.returncode, 1)
        self.assertIn("not intubated: ", done.stderr)
        done = self.shell("deploy/ci/judge.sh term expert", PATH=path, ETI_STATE_HASH="0000000000000000")
        self.assertEqual(done.returncode, 1)
        self.assertIn("different bits: ", done.stderr)
        bits = result("expert")["state_hash"]
        self.assert_intubated(self.shell("deploy/ci/judge.sh term expert", PATH=path, ETI_STATE_HASH=bits))
        self.assertNotEqual(self.shell("deploy/ci/judge.sh nobody").returncode, 0)


class Containers(support.Case):
    def test_container_file_references_existing_paths(self):
        text = (OCI / "Containerfile").read_text()
        self.assertEqual(set(re.findall(r"^FROM \S+ AS (\S+)$", text, re.M)),
                         {"build", "build-tools", "tools", "server"})
        for line in re.findall(r"^COPY (?!--from)(.*)$", text, re.M):
            for source in line.split()[:-1]:
                self.assertTrue((ROOT / source).exists(), source)
        # The server's stages copy every folder that its build reads, and no more.
        last = text.split(" AS server\n")[1]
        self.assertIn("USER neoeti\n", last)
        entry = json.loads(re.search(r"^ENTRYPOINT (.*)$", last, re.M).group(1))
        self.assertEqual(entry[0], "eti-server")
        offered = support.run("eti-server", "--help").stdout
        for option in entry[1:]:
            self.assertIn(option, offered)

    def test_health_check_follows_simulation_loop(self):
        server = subprocess.Popen([BIN / "eti-server", "--session", SESSION, "--domain", str(DOMAIN)],
                                  stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(server.wait)
        self.addCleanup(server.kill)

        def health():
            return subprocess.run([OCI / "healthcheck.sh", str(server.pid)], stdout=subprocess.PIPE).returncode
        support.wait_until(lambda: health() == 0, "a healthy loop")
        server.send_signal(signal.SIGSTOP)
        self.assertEqual(health(), 1)
        server.send_signal(signal.SIGCONT)
        self.assertEqual(health(), 0)
        server.terminate()
        self.assertEqual(server.wait(support.PATIENCE), 0)
        self.assertEqual(health(), 1)


if __name__ == "__main__":
    unittest.main()
