#!/usr/bin/python3
"""A job of Slurm on three nodes is stopped by its time limit and goes on in a second one to the numbers of a run that was never stopped."""

import os
import re
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from namespaces import NETWORK
from run_under_test import SCENE, SETTINGS
from slurm import Slurm, why_not

COUPLET = os.environ["COUPLET"]
WHY_NOT = why_not()
STEPS = 2_000_000  # never reached within a minute
JOB_TAKES = 240  # [s] its limit of one minute and what Slurm adds to it


@unittest.skipIf(WHY_NOT, WHY_NOT)
class SlurmTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.slurm = Slurm(3, 2)
        cls.addClassCleanup(cls.slurm.close)

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="couplet-job-")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def submit(self, *arguments):
        settings = [word for setting in [*SETTINGS, "output.checkpoints={}"] for word in ("--set", setting)]
        done = self.slurm.on(self.slurm.hosts.names[0], COUPLET, "submit", SCENE, "--slurm", "--nodes", "3", "--cpus", "2", "--network", f"{NETWORK}.0/24",
                             "--no-report", *settings, *arguments, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return re.search(r"Submitted batch job (\d+)", done.stdout).group(1)

    def wait_for(self, job, out):
        deadline = time.monotonic() + JOB_TAKES
        while not self.slurm.is_over(job):
            self.assertLess(time.monotonic(), deadline, self.words_of(out))
            time.sleep(0.2)

    def words_of(self, out):
        return "\n".join(file.read_text()[-3000:] for file in [*out.glob("slurm-*.txt"), out / "log.txt"] if file.exists())

    def rows(self, out):
        return (out / "history.csv").read_text().splitlines()

    def end_and_go_on(self, *limit, end):
        out = self.folder / "run"
        job = self.submit("--out", out, "--steps", str(STEPS), *limit)
        end(job, out)
        self.wait_for(job, out)
        self.assertIn('"status": "stopped"', (out / "summary.json").read_text(), self.words_of(out))
        n_first = len(self.rows(out))
        self.assertGreater(n_first, 10)
        self.wait_for(self.submit("--out", out, "--resume", out, "--steps", "100"), out)
        self.assertIn('"status": "finished"', (out / "summary.json").read_text(), self.words_of(out))
        found = self.rows(out)
        self.assertEqual(len(found), n_first + 100)
        log = (out / "log.txt").read_text()
        for host in (0, 2):
            self.assertIn(f"listening tcp://{self.slurm.hosts.address(self.slurm.hosts.names[host])}:", log)

        whole = self.folder / "whole"
        settings = [word for setting in SETTINGS for word in ("--set", setting)]
        done = subprocess.run([COUPLET, "run", SCENE, "--out", whole, "--steps", str(len(found) - 1), "--quiet", "--no-report", *settings])
        self.assertEqual(done.returncode, 0)
        self.assertEqual(self.rows(whole), found)

    def test_the_signal_of_a_time_limit(self):
        """What Slurm sends a minute before the end, without the wait for it."""
        def end(job, out):
            deadline = time.monotonic() + JOB_TAKES
            while not (out / "history.csv").exists() or len(self.rows(out)) < 50:
                self.assertLess(time.monotonic(), deadline, self.words_of(out))
                time.sleep(0.1)
            self.slurm.say("scancel", "--batch", "--signal=TERM", job)
        self.end_and_go_on(end=end)

    @unittest.skipUnless(os.environ.get("COUPLET_LONG_TESTS"), "takes two minutes: set COUPLET_LONG_TESTS=1")
    def test_a_time_limit(self):
        self.end_and_go_on("--time", "2", end=lambda job, out: None)


if __name__ == "__main__":
    unittest.main(verbosity=2)
