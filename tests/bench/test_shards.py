# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Sharded sweeps: merged they equal a single run byte by byte, on any runner; tables that cannot be merged are
rejected."""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(os.environ.get("ETI_BIN", ROOT / "build/release/bin"))
BENCH = BIN / "eti-bench"
FLEET = ROOT / "deploy/fleet"
# Small, quick, and without timings in its table.
SWEEP = ["stability", "--quick", "--only", "sets"]


def run(*command, **environment):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True,
                          env={**os.environ, **environment})


class Shards(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="eti-test-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def good(self, *command, **environment):
        done = run(*command, **environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def in_one(self):
        self.good(BENCH, *SWEEP, "--out", self.folder / "one")
        return (self.folder / "one/stability.csv").read_bytes()

    def in_shards(self, count, name="many"):
        for index in range(count):
            self.good(BENCH, *SWEEP, "--out", self.folder / name, "--shard", f"{index}/{count}")
        return sorted((self.folder / name).glob(f"shard-*-of-{count}"))

    def merged(self, shards):
        self.good(BENCH, "merge", self.folder / "merged", *shards)
        return (self.folder / "merged/stability.csv").read_bytes()

    def test_merged_shards_equal_single_run(self):
        whole = self.in_one()
        self.assertGreater(whole.count(b"\n"), 10)
        for count in (1, 2, 3):
            shards = self.in_shards(count)
            self.assertEqual(len(shards), count)
            self.assertEqual(self.merged(reversed(shards)), whole)
        rows = [(shard / "stability.csv").read_text().count("\n") - 1 for shard in shards]
        self.assertLessEqual(max(rows) - min(rows), 1, "an even share each")

    def test_tables_with_timings_merge(self):
        """All other columns are equal: two tables, in which a run may write several rows."""
        sweep = ["accuracy", "--quick", "--only", "tube"]
        self.good(BENCH, *sweep, "--out", self.folder / "one")
        for index in range(2):
            self.good(BENCH, *sweep, "--out", self.folder / "many", "--shard", f"{index}/2")
        self.good(BENCH, "merge", self.folder / "merged", *(self.folder / "many").iterdir())
        for table, own in (("accuracy.csv", r",[^,]*$"), ("accuracy-forces.csv", r"$^")):
            one, merged = (re.sub(own, "", (self.folder / name / table).read_text(), flags=re.M)
                           for name in ("one", "merged"))
            self.assertEqual(one, merged)

    def test_incompatible_shards_are_refused(self):
        shards = self.in_shards(2)
        other = self.folder / "other"
        self.good(BENCH, "stability", "--quick", "--only", "fluid", "--out", other, "--shard", "1/2")
        unfinished = self.folder / "unfinished"
        shutil.copytree(shards[1], unfinished)
        (unfinished / "shard.json").unlink()
        torn = self.folder / "torn"
        shutil.copytree(shards[1], torn)
        text = (torn / "stability.csv").read_text()
        (torn / "stability.csv").write_text(text.replace("\n1,", "\n2,", 1))
        another_build = self.folder / "another"
        shutil.copytree(shards[1], another_build)
        manifest = json.loads((another_build / "shard.json").read_text())
        manifest["sweep"]["build"] = "elsewhere"
        (another_build / "shard.json").write_text(json.dumps(manifest))
        for given, said in (([shards[0]], "shard 1 of 2 is not among"), ([shards[0], shards[0]], "are both shard 0"),
                            ([shards[0], other / "shard-1-of-2"], "different sweeps"),
                            ([shards[0], unfinished], "is incomplete"), ([shards[0], torn], "stability.csv:2"),
                            ([shards[0], another_build], "different sweeps, settings or builds")):
            done = run(BENCH, "merge", self.folder / "merged", *given)
            self.assertEqual(done.returncode, 1)
            self.assertIn(said, done.stderr)
            self.assertFalse((self.folder / "merged").exists())
        for text in ("2/2", "-1/2", "1", "/2", "a/b", "0/0", "1/2x", "99999999999999999999/2"):
            done = run(BENCH, *SWEEP, "--shard=" + text, "--out", self.folder / "none")
            self.assertEqual(done.returncode, 1, text)
            self.assertIn("not a shard I/N", done.stderr)

    def test_slurm_array_equals_single_run(self):
        task = {"ETI_BENCH": str(BENCH), "SLURM_ARRAY_TASK_COUNT": "2", "SLURM_CPUS_PER_TASK": "1"}
        for index in range(2):
            self.good(FLEET / "slurm.sh", *SWEEP, "--out", self.folder / "many", SLURM_ARRAY_TASK_ID=str(index), **task)
        self.assertEqual(self.merged((self.folder / "many").iterdir()), self.in_one())
        refused = run(FLEET / "slurm.sh", *SWEEP)
        self.assertIn("sbatch --array=0-N", refused.stderr)
        refused = run(FLEET / "slurm.sh", *SWEEP, SLURM_ARRAY_TASK_ID="1", SLURM_ARRAY_TASK_MIN="1", **task)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("--array=0-1", refused.stderr)

    def test_slurm_script_is_clean(self):
        self.good("bash", "-n", FLEET / "slurm.sh")
        if shutil.which("shellcheck") is None:
            self.skipTest("no shellcheck here")
        done = run("shellcheck", FLEET / "slurm.sh")
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_kubernetes_job_equals_single_run(self):
        job = yaml.safe_load((FLEET / "kubernetes.yaml").read_text())
        self.assertEqual((job["apiVersion"], job["kind"]), ("batch/v1", "Job"))
        self.assertEqual(job["spec"]["completionMode"], "Indexed")
        container, = job["spec"]["template"]["spec"]["containers"]
        self.assertEqual({"name": "SHARDS", "value": str(job["spec"]["completions"])}, container["env"][0])
        mounted = {mount["name"] for mount in container["volumeMounts"]}
        self.assertEqual(mounted, {volume["name"] for volume in job["spec"]["template"]["spec"]["volumes"]})
        # Its command, with a smaller sweep and folders of this test in place of its volumes.
        script, = container["args"]
        self.assertEqual(script.count("stability --out /results"), 1)
        script = script.replace("stability --out /results", " ".join([*SWEEP, "--out", str(self.folder / "many")]))
        for index in range(2):
            self.good(*container["command"], script, JOB_COMPLETION_INDEX=str(index), SHARDS="2",
                      PATH=f"{BIN}:{os.environ['PATH']}")
        self.assertEqual(self.merged((self.folder / "many").iterdir()), self.in_one())

    def test_sharded_newborn_sweep_equals_single_sweep(self):
        """With a stand-in for eti-anatomy that builds nothing: a sum over its options represents a newborn."""
        builder = self.folder / "eti-anatomy"
        builder.write_text("""#!/bin/sh
[ $1 = check ] && exec echo '{"invariants": []}'
echo "{\\"particles\\": $(echo "${*%--out*}" | cksum | cut -d' ' -f1)}"
""")
        builder.chmod(0o755)
        script = ROOT / "tests/validation/anatomy/sweep.py"
        sweep = [sys.executable, "-B", script, "--weights", "1", "3", "--spacing-mm", "3.5"]
        one, files = self.folder / "one.csv", [self.folder / f"{index}.csv" for index in range(2)]
        here = {"ETI_BIN": str(self.folder)}
        whole = self.good(*sweep, "--out", one, **here).stdout
        for index, file in enumerate(files):
            self.good(*sweep, "--out", file, "--shard", f"{index}/2", **here)
        merged = self.good(*sweep, "--out", self.folder / "all.csv", "--merge", *reversed(files))
        self.assertEqual((self.folder / "all.csv").read_bytes(), one.read_bytes())
        self.assertEqual(len({row.split(",")[10] for row in one.read_text().splitlines()[1:]}), 2, "two newborns")
        self.assertEqual(merged.stdout.splitlines()[-1], whole.splitlines()[-1])
        self.assertIn("1 of 2 newborns are in none", run(*sweep, "--merge", files[0]).stderr)
        self.assertIn("another shard's", run(*sweep, "--merge", files[0], files[0]).stderr)


if __name__ == "__main__":
    unittest.main()
