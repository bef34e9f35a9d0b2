#!/usr/bin/python3
"""Whatever goes wrong, a run ends in time, with the promised exit code and one clear last line, and leaves readable results."""

import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from xml.etree import ElementTree

import h5py
import meshio
import numpy

from run_under_test import FLOW_SCENE, PROGRAMS, SCENE, Run, cut_connections, descendants, interrupt, still_running

COUPLET = os.environ["COUPLET"]
ENDS_WITHIN = 10  # [s] from the loss of a program to the end of the run: the promise of the contract
HEARTBEAT = 2  # [s] a frozen program is given up after this time


class FaultCase(unittest.TestCase):
    def start(self, *arguments, **options):
        run = Run(COUPLET, *arguments, **options)
        self.addCleanup(run.close)
        return run

    def expect_readable_results(self, run, n_steps):
        """All that was written before stays readable."""
        summary = run.summary()
        self.assertEqual(summary["status"], "failed")
        self.assertTrue(summary["failure"])
        names, rows = run.history()
        self.assertGreaterEqual(len(rows), n_steps)
        self.assertTrue(all(len(row) == len(names) for row in rows))
        pictures = sorted((run.out / "results").glob("*.xmf"))
        self.assertEqual([picture.stem for picture in pictures], ["flow", "fold"])
        for picture in pictures:
            with h5py.File(picture.with_suffix(".h5")) as file:
                self.assertGreater(int(file["n_states"][()].ravel()[0]), 0)
        with meshio.xdmf.TimeSeriesReader(pictures[1]) as reader:
            points, _ = reader.read_points_cells()
            self.assertGreater(reader.num_steps, 0)
            for state in range(reader.num_steps):
                self.assertEqual(reader.read_data(state)[1]["displacement"].shape, points.shape)


class LossTest(FaultCase):
    """kill -9 and kill -STOP of each of the three programs, over each transport; the cases are added below."""

    def lose(self, transport, program, number, within):
        run = self.start("--transport", transport, settings=[f"coupling.heartbeat_deadline={HEARTBEAT}"])
        run.wait_for_steps(40)
        pids = descendants(run.process.pid)
        run.send(program, number)
        code, lines = run.end(within)
        self.assertEqual(code, 4, lines)
        self.assertEqual(still_running(pids), [])
        self.assertEqual(len(lines), 1, "one last line says what happened")
        self.expect_readable_results(run, 40)
        return lines[0]


def add_loss_tests():
    def make(transport, program, number, within, words):
        def test(self):
            line = self.lose(transport, program, number, within)
            self.assertTrue(any(word in line for word in words), line)
        return test

    for transport in ("zmq", "mpi"):
        for program in PROGRAMS:
            name = f"{program.replace('-', '_')}_over_{transport}"
            setattr(LossTest, f"test_killed_{name}",
                    make(transport, program, signal.SIGKILL, ENDS_WITHIN, ("was killed (signal 9",)))
            setattr(LossTest, f"test_frozen_{name}",
                    make(transport, program, signal.SIGSTOP, HEARTBEAT + ENDS_WITHIN, ("stopped by a signal", "sign of life", "lost")))


add_loss_tests()


class FlowRanksTest(FaultCase):
    """A flow on several ranks: what happens to one of them ends all."""

    def start_flow(self, *arguments, n_ranks=2, settings=()):
        return self.start("--flow-ranks", str(n_ranks), *arguments, scene=FLOW_SCENE, common=(), settings=settings)

    def expect_readable_states(self, run, n_states):
        """Every state that the results name is complete, for those who read flow.h5 and for those who read the .xmf."""
        results = run.out / "results"
        with h5py.File(results / "flow.h5") as file:
            self.assertGreaterEqual(len(file["state"]), n_states)
            for name in file["state"]:
                state = file["state"][name]
                self.assertEqual(state["time"].shape, (1,))
                self.assertEqual(state["flow/velocity"][()].shape, (32, 32, 32, 3))
        listing = ElementTree.parse(results / "flow.xmf")
        self.assertGreaterEqual(len(listing.findall(".//Time")), n_states)
        for item in listing.iter("DataItem"):
            name, _, place = item.text.partition(":")
            with h5py.File(results / name) as file:
                self.assertEqual(file[place][()].shape, tuple(int(n) for n in item.get("Dimensions").split()))

    def lose(self, which, number, within):
        run = self.start_flow(settings=[f"coupling.heartbeat_deadline={HEARTBEAT}"])
        run.wait_for_steps(15)
        ranks = run.pids_of("flow-server")
        self.assertEqual(len(ranks), 2)
        os.kill(ranks[which], number)
        code, lines = run.end(within)
        self.assertEqual(code, 4, lines)
        self.assertEqual(still_running(ranks), [])
        self.assertEqual(len(lines), 1, lines)
        self.assertEqual(run.summary()["status"], "failed")
        self.expect_readable_states(run, 15)
        return lines[0]

    def test_killed_first_rank(self):
        self.assertIn("was killed (signal 9", self.lose(0, signal.SIGKILL, ENDS_WITHIN))

    def test_killed_last_rank(self):
        self.assertIn("was killed (signal 9", self.lose(1, signal.SIGKILL, ENDS_WITHIN))

    def test_frozen_rank(self):
        self.assertIn("stopped by a signal", self.lose(1, signal.SIGSTOP, HEARTBEAT + ENDS_WITHIN))

    def test_interrupt_writes_a_checkpoint_to_continue_from(self):
        run = self.start_flow()
        run.wait_for_steps(5)
        interrupt(run)
        code, lines = run.end(ENDS_WITHIN)
        self.assertEqual(code, 0, lines)
        self.assertEqual(run.summary()["status"], "stopped")
        rows = len(run.history()[1])
        resumed = self.start_flow("--resume", str(run.out), "--steps", "3", n_ranks=1)
        self.assertEqual(resumed.end(60)[0], 0)
        self.assertEqual(len(resumed.history()[1]), rows + 3)

    def test_a_wrong_scene_is_one_line(self):
        run = self.start_flow(settings=["flow.navier_stokes.decomposition={x: 3}"])
        code, lines = run.end(60)
        self.assertEqual(code, 2)
        self.assertEqual(lines, ["couplet: --flow-ranks: 2 is not the number of blocks in the scene, 3; leave out --flow-ranks, or "
                                 "flow.navier_stokes.decomposition"])

    def test_what_is_no_number_on_one_rank_ends_all(self):
        """Only one of the ranks meets it; all must end with it."""
        force = "abs(t-0.95)<0.06 && x>4 ? 0/0 : 0"
        run = self.start_flow(settings=["flow.navier_stokes.decomposition={x: 2}", f'flow.navier_stokes.body_force.expression.x="{force}"'])
        code, lines = run.end(60)
        self.assertEqual(code, 3, lines)
        self.assertEqual(len(lines), 1, lines)
        self.assertRegex(lines[0], r"cell \(\d+, \d+, \d+\) at .*: the velocity at t = [\d.]+ s is not a number")
        self.assertEqual(run.summary()["status"], "failed")
        self.expect_readable_states(run, 8)

    def test_a_flow_that_blows_up_is_a_numerical_failure_on_all_ranks(self):
        run = self.start_flow(settings=["flow.navier_stokes.smallest_step=0.05",
                                        "flow.navier_stokes.body_force.expression.x=\"exp(min(t,20))*sin(y)\""])
        code, lines = run.end(120)
        self.assertEqual(code, 3, lines)
        self.assertEqual(len(lines), 1, lines)
        self.assertIn("; ", lines[0], "what to do next")


class LauncherTest(FaultCase):
    def test_nothing_outlives_a_killed_launcher(self):
        for transport in ("zmq", "mpi"):
            with self.subTest(transport):
                run = self.start("--transport", transport)
                run.wait_for_steps(5)
                pids = descendants(run.process.pid)
                self.assertGreaterEqual(len(pids), 3)
                run.process.kill()
                deadline = time.monotonic() + ENDS_WITHIN
                while still_running(pids) and time.monotonic() < deadline:
                    time.sleep(0.05)
                self.assertEqual(still_running(pids), [])

    def test_interrupt_ends_the_run_in_good_order(self):
        for transport in ("zmq", "mpi"):
            with self.subTest(transport):
                run = self.start("--transport", transport)
                run.wait_for_steps(5)
                interrupt(run)
                code, lines = run.end(ENDS_WITHIN)
                self.assertEqual(code, 0, lines)
                self.assertEqual(run.summary()["status"], "stopped")

    def test_a_killed_run_continues_from_its_checkpoint_with_the_same_numbers(self):
        settings = ["output.checkpoints={every_steps: 25}"]
        whole = self.start("--steps", "120", settings=settings)
        self.assertEqual(whole.end(600)[0], 0)
        run = self.start(settings=settings)
        run.wait_for_steps(60)
        run.send("solid-server", signal.SIGKILL)
        self.assertEqual(run.end(ENDS_WITHIN)[0], 4)
        resumed = self.start("--resume", str(run.out), "--steps", "70", settings=settings)
        self.assertEqual(resumed.end(600)[0], 0)
        expected, found = whole.history()[1], resumed.history()[1]
        n_rows = min(len(expected), len(found))
        self.assertGreater(n_rows, 60)
        self.assertEqual(found[:n_rows], expected[:n_rows])


class SurvivalTest(FaultCase):
    """A run that loses a program goes on by itself to the numbers of one that lost nothing."""

    SETTINGS = ["output.checkpoints={every_steps: 25}", f"coupling.heartbeat_deadline={HEARTBEAT}"]
    STEPS = 150

    def start_whole(self, *arguments, restarts=3):
        return self.start("--steps", str(self.STEPS), *arguments, settings=self.SETTINGS, restarts=restarts)

    def expect_the_same(self, run, n_restarts):
        code, lines = run.end(600)
        self.assertEqual(code, 0, lines)
        self.assertEqual(run.summary()["status"], "finished")
        self.assertEqual(run.summary()["restarts"], n_restarts)
        whole = self.start_whole()
        self.assertEqual(whole.end(600)[0], 0)
        self.assertEqual((run.out / "history.csv").read_bytes(), (whole.out / "history.csv").read_bytes())
        for found, expected in zip(self.states(run), self.states(whole), strict=True):
            for a, b in zip(found, expected, strict=True):
                self.assertEqual(a[0], b[0])
                numpy.testing.assert_array_equal(a[1], b[1])

    def states(self, run):
        """Time and displacement of every stored state, as a reader of the .xmf finds them, of both surfaces."""
        for name in ("flow", "fold"):
            with meshio.xdmf.TimeSeriesReader(run.out / "results" / f"{name}.xmf") as reader:
                reader.read_points_cells()
                yield [(time, data["displacement"]) for time, data, _ in map(reader.read_data, range(reader.num_steps))]

    def lose(self, disturb, *arguments, after=60):
        run = self.start_whole(*arguments)
        run.wait_for_steps(after)
        disturb(run)
        self.expect_the_same(run, 1)

    def test_a_damaged_checkpoint_is_passed_over(self):
        def disturb(run):
            newest = sorted((run.out / "checkpoint").glob("step-*[0-9]"))[-1]
            with open(newest / "solid.h5", "r+b") as file:
                file.seek(1000)
                file.write(b"\xff" * 8)
            run.send("coupler", signal.SIGKILL)
        self.lose(disturb, after=55)

    def test_before_the_first_checkpoint(self):
        self.lose(lambda run: run.send("flow-server", signal.SIGKILL), after=5)

    def test_a_connection_that_is_cut(self):
        self.lose(lambda run: self.assertGreater(cut_connections(run.pid_of("solid-server")), 0), "--transport", "zmq")

    def test_twice(self):
        run = self.start_whole()
        for step in (40, 90):
            run.wait_for_steps(step)
            run.send("solid-server", signal.SIGKILL)
            while run.n_rows() >= step:  # until it has been taken back to its checkpoint
                time.sleep(0.01)
        self.expect_the_same(run, 2)

    def test_a_run_that_is_lost_again_and_again_is_given_up(self):
        run = self.start_whole(restarts=2)
        deadline = time.monotonic() + 120
        while run.process.poll() is None and time.monotonic() < deadline:
            for pid in run.pids_of("solid-server"):
                os.kill(pid, signal.SIGKILL)
            time.sleep(0.01)
        code, lines = run.end(10)
        self.assertEqual(code, 4)
        self.assertEqual(len(lines), 1, lines)
        self.assertIn("lost 3 times in a row before it came to its next checkpoint", lines[0])
        self.assertIn("killed (signal 9", lines[0])


def add_survival_tests():
    def make(transport, program, number):
        return lambda self: self.lose(lambda run: run.send(program, number), "--transport", transport)

    for program in PROGRAMS:
        name = program.replace("-", "_")
        setattr(SurvivalTest, f"test_killed_{name}_over_zmq", make("zmq", program, signal.SIGKILL))
        setattr(SurvivalTest, f"test_frozen_{name}_over_zmq", make("zmq", program, signal.SIGSTOP))
    SurvivalTest.test_killed_solid_server_over_mpi = make("mpi", "solid-server", signal.SIGKILL)


add_survival_tests()


class RefusalTest(FaultCase):
    def test_a_wrong_scene_is_refused_with_every_complaint_before_anything_starts(self):
        text = SCENE.read_text().replace("density: 1040", "density: -1").replace("elements_x: 6", "elemnts_x: 6")
        with tempfile.TemporaryDirectory(prefix="couplet fault ") as folder:
            scene = Path(folder) / "scene.txtpb"
            scene.write_text(text)
            run = self.start(scene=scene)
            code, lines = run.end(60)
        self.assertEqual(code, 2)
        self.assertEqual(len(lines), 3, lines)
        self.assertRegex(lines[0], r"scene\.txtpb:\d+:\d+: .*elemnts_x.*elements_x")
        self.assertRegex(lines[1], r"scene\.txtpb:\d+:\d+: .*density: -1 is not above 0")
        self.assertFalse(run.out.exists())

    def test_a_folder_that_cannot_be_written_is_a_file_failure(self):
        done = subprocess.run([COUPLET, "run", str(SCENE), "--out", "/dev/null/run"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 5)
        self.assertIn("/dev/null/run", done.stderr)

    def test_a_scene_whose_path_has_no_folder_runs(self):
        with tempfile.TemporaryDirectory(prefix="couplet fault ") as folder:
            (Path(folder) / "scene.txtpb").write_text(SCENE.read_text())
            done = subprocess.run([COUPLET, "run", "scene.txtpb", "--out", "run", "--steps", "1", "--quiet", "--no-report"],
                                  cwd=folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue((Path(folder) / "run" / "summary.json").exists())

    def test_a_run_is_not_overwritten_unasked(self):
        run = self.start("--steps", "2")
        self.assertEqual(run.end(60)[0], 0)
        again = subprocess.run([COUPLET, "run", str(SCENE), "--out", str(run.out)], capture_output=True, text=True)
        self.assertEqual(again.returncode, 2)
        self.assertIn("already holds a run", again.stderr)

    def test_a_model_without_equilibrium_is_a_numerical_failure_with_advice(self):
        run = self.start(settings=["flow.glottis.model=B2", "solid.body[0].vocal_fold.medial_thickness=3.5e-3",
                                   "flow.glottis.exit_pressure=0"])
        code, lines = run.end(300)
        self.assertEqual(code, 3, lines)
        self.assertRegex(lines[-1], "diverged|does not converge")
        self.assertIn("; ", lines[-1], "what to do next")
        self.expect_readable_results(run, 1)


if __name__ == "__main__":
    sys.exit(unittest.main(verbosity=2))
