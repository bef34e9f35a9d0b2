#!/usr/bin/python3
"""A run across several hosts gives the numbers of one on this machine, and outlives a host."""

import os
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from namespaces import Hosts, why_not
from run_under_test import SCENE, TOP, Run, descendants, still_running

COUPLET = os.environ["COUPLET"]
FLAG = TOP / "deploy" / "scenes" / "turek-hron-fsi1" / "scene.txtpb"
# Coarse, and cut at once by a large step: two ranks, a few coupling iterations.
FLAG_SETTINGS = ["flow.navier_stokes.grid.y.uniform.cells=41", "time.step=0.01"]
WHY_NOT = why_not()


@unittest.skipIf(WHY_NOT, WHY_NOT)
class HostsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="couplet keys ")
        cls.addClassCleanup(folder.cleanup)
        cls.keys = Path(folder.name) / "keys"
        subprocess.run([COUPLET, "keys", cls.keys], check=True, capture_output=True)

    def setUp(self):
        self.hosts = Hosts(4)
        self.addCleanup(self.hosts.close)

    def start(self, *arguments, **options):
        run = Run(COUPLET, *arguments, **options)
        self.addCleanup(run.close)
        return run

    def start_on(self, file, *arguments, **options):
        return self.start("--hosts", str(file), "--keys", str(self.keys), *arguments, **options)

    def expect_the_same(self, run, whole):
        for one in (run, whole):
            code, errors = one.end(300)
            self.assertEqual(code, 0, errors)
        self.assertEqual((run.out / "history.csv").read_bytes(), (whole.out / "history.csv").read_bytes())

    def test_a_fold_across_three_hosts(self):
        run = self.start_on(self.hosts.file(flow=[(0, 1)], solid=2, coupler=1), "--steps", "60")
        self.expect_the_same(run, self.start("--steps", "60"))
        log = (run.out / "log.txt").read_text()
        for host in (0, 2):
            self.assertIn(f"listening tcp://{self.hosts.address(self.hosts.names[host])}:", log)

    def test_a_flow_on_ranks_of_two_hosts(self):
        common = {"scene": FLAG, "common": FLAG_SETTINGS}
        run = self.start_on(self.hosts.file(flow=[(0, 1), (1, 1)], solid=2, coupler=2), "--steps", "3", "--flow-ranks", "2", **common)
        self.expect_the_same(run, self.start("--steps", "3", "--flow-ranks", "2", "--solid-threads", "1", **common))

    def test_a_host_that_is_lost(self):
        settings = ["output.checkpoints={every_steps: 25}", "coupling.heartbeat_deadline=2"]
        run = self.start_on(self.hosts.file(flow=[(0, 1)], solid=2, coupler=1, spare=[3]), "--steps", "120", settings=settings, restarts=3)
        run.wait_for_steps(40)
        self.hosts.lose(2)
        self.expect_the_same(run, self.start("--steps", "120", settings=settings))
        self.assertEqual(run.summary()["restarts"], 1)
        self.assertIn("takes its place", (run.out / "log.txt").read_text())

    def test_no_spare_host(self):
        run = self.start_on(self.hosts.file(flow=[(0, 1)], solid=2, coupler=1), "--steps", "5000", settings=["coupling.heartbeat_deadline=2"],
                            restarts=3)
        run.wait_for_steps(20)
        self.hosts.lose(2)
        code, errors = run.end(60)
        self.assertEqual(code, 4)
        self.assertIn("no spare host is left", errors[-1])
        self.assertEqual(len(run.history()[1][0]), len(run.history()[0]))

    def test_nothing_outlives_a_killed_launcher(self):
        run = self.start_on(self.hosts.file(flow=[(0, 1)], solid=2, coupler=1), "--steps", "5000")
        run.wait_for_steps(10)
        started = descendants(run.process.pid)
        everywhere = [int(pid) for name in self.hosts.names
                      for pid in subprocess.run(["ip", "netns", "pids", name], capture_output=True, text=True).stdout.split()]
        self.assertGreaterEqual(len(everywhere), 3)
        run.process.kill()
        run.process.wait()
        self.wait_for_end_of([*started, *everywhere])

    def wait_for_end_of(self, processes):
        deadline = time.monotonic() + 15
        while left := still_running(processes):
            self.assertLess(time.monotonic(), deadline, f"{left} still run")
            time.sleep(0.05)

    def test_interrupt_ends_the_run_in_good_order(self):
        run = self.start_on(self.hosts.file(flow=[(0, 1)], solid=2, coupler=1), "--steps", "5000")
        run.wait_for_steps(10)
        run.process.send_signal(2)
        code, errors = run.end(60)
        self.assertEqual(code, 0, errors)
        self.assertEqual(run.summary()["status"], "stopped")

    def test_a_wrong_file_is_refused(self):
        file = self.hosts.file(flow=[(0, 1)], solid=2, coupler=1)
        for text, complaint in (("flow { slots: 0 }", "name"), ("solid { name: \"a\" }\nsolid { name: \"b\" }", "solid"),
                                (file.read_text().replace("{command}", ""), "{command}"), ("nonsense: 1", "nonsense")):
            file.write_text(text)
            done = subprocess.run([COUPLET, "run", SCENE, "--hosts", file, "--keys", self.keys, "--out", file.parent / "run"],
                                  capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(complaint, done.stderr)
            self.assertIn(str(file), done.stderr)

    def test_hosts_without_keys_are_refused(self):
        done = subprocess.run([COUPLET, "run", SCENE, "--hosts", self.hosts.file(flow=[(0, 1)], solid=2, coupler=1)], capture_output=True,
                              text=True, timeout=60)
        self.assertEqual(done.returncode, 2)
        self.assertIn("couplet keys", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
