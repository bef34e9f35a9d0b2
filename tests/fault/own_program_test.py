#!/usr/bin/python3
"""A program of the user's own that is not there, says nothing, ends, crashes or fails: one clear sentence that names it, and the promised exit code."""

import os
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

from run_under_test import Run, still_running, descendants

COUPLET = os.environ["COUPLET"]
PARTICIPANTS = Path(__file__).resolve().parents[2] / "deploy" / "participant"
SCENE = PARTICIPANTS / "wall_channel.txtpb"

# A wall with a fault of its own, as the rest of a program that has imported the module.
FAULTY = """#!/usr/bin/python3
import os, time
from couplet_participant import Failure, serve
from mass_spring_wall import Wall
class Faulty(Wall):
    def solve_step(self, step, fields):
        if step.step == 5:
            {fault}
        return super().solve_step(step, fields)
serve(Faulty)
"""


class OwnProgramTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="couplet own ")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def start(self, *words):
        run = Run(COUPLET, *words, scene=SCENE, common=())
        self.addCleanup(run.close)
        return run

    def expect(self, code, *texts, words, within=60):
        """The run ends with that code and one line that holds all the texts."""
        run = self.start(*words)
        found, lines = run.end(within)
        self.assertEqual(found, code, lines)
        self.assertEqual(len(lines), 1, lines)
        for text in texts:
            self.assertIn(text, lines[0])
        return run

    def program(self, text, name="own.py"):
        path = self.folder / name
        path.write_text(text)
        path.chmod(0o755)
        return f"'{path}'"

    def faulty(self, fault):
        return self.program(FAULTY.format(fault=fault))

    def test_what_is_no_program_is_refused_before_anything_starts(self):
        for command, text in (("no-such-program --fast", "there is no program no-such-program"), ("./nowhere/solid", "there is no program"),
                              (str(SCENE), "chmod +x"), ("a && b", "into a script"), ("'open", "close its quotes"), (" ", "names no program"),
                              ("/", "cannot be started")):
            for option in ("--solid", "--flow"):
                run = self.expect(2, option, text, words=[option, command])
                self.assertFalse(run.out.exists())

    def test_what_does_not_go_together_is_refused(self):
        wall = str(PARTICIPANTS / "mass_spring_wall.py")
        self.expect(2, "--solid", "over ZeroMQ", "leave --transport mpi out", words=["--solid", wall, "--transport", "mpi"])
        self.expect(2, "--flow", "add --transport zmq", words=["--flow", wall, "--set", "coupling.transport=MPI"])
        self.expect(2, "--solid-threads", "which --solid replaces", words=["--solid", wall, "--solid-threads", "2"])
        self.expect(2, "--solid", "the scene has no flow", words=["--solid", wall, "--set", "flow="])

    def test_one_that_ends_at_once_is_lost(self):
        for option in ("--solid", "--flow"):
            run = self.expect(4, f'{option[2:]} "true"', "before it said where it listens", words=[option, "true"])
            self.assertEqual(run.summary()["status"], "failed")
            self.assertEqual(run.summary()["own_programs"], {option[2:]: "true"})

    def test_one_that_says_nothing_is_lost_in_time(self):
        command = "sh -c 'sleep 300'"
        self.expect(4, command, "did not say within 30 s where it listens", words=["--solid", command], within=60)

    def test_its_own_words_and_code_are_those_of_the_run(self):
        wall = f"{PARTICIPANTS}/mass_spring_wall.py --mass 0"
        self.expect(2, wall, "--mass: 0.0 is not above 0", words=["--solid", wall])
        missing = self.program("#!/usr/bin/python3\nimport numpy.nothing_there\n")
        self.expect(4, missing, "No module named 'numpy.nothing_there'", words=["--solid", missing])
        crashing = "sh -c 'kill -SEGV $$'"
        self.expect(4, crashing, "crashed", words=["--solid", crashing])

    def test_what_happens_in_a_step_names_the_program(self):
        for fault, code, text in (("raise Failure('SCENE', 'no such spring', 'node 7', 'buy one')", 2, "node 7: no such spring; buy one"),
                                  ("raise Failure('NUMERICS', 'diverged')", 3, "diverged"), ("open('/no/such/file')", 5, "/no/such/file"),
                                  ("os._exit(0)", 4, "lost"), ("os._exit(7)", 4, "ended with code 7"), ("1 / 0", 70, "ZeroDivisionError"),
                                  ("os.kill(os.getpid(), 9)", 4, "was killed (signal 9")):
            command = self.faulty(fault)
            run = self.expect(code, command, text, words=["--solid", command])
            self.assertEqual(run.n_rows(), 4)

    def test_a_step_that_fails_once_is_tried_again_with_half_its_duration(self):
        command = self.faulty("if step.duration > 4e-4: raise Failure('NUMERICS', 'too far')")
        run = self.start("--solid", command, "--steps", "8")
        self.assertEqual(run.end(60), (0, []))
        self.assertIn("too far", (run.out / "log.txt").read_text())
        names, rows = run.history()
        self.assertLess(min(row[1] for row in rows), 4e-4)

    def test_one_that_is_killed_or_frozen_is_lost(self):
        wall = str(PARTICIPANTS / "mass_spring_wall.py")
        for number, text in ((signal.SIGKILL, "was killed"), (signal.SIGSTOP, "stopped by a signal")):
            run = self.start("--solid", wall, "--set", "coupling.heartbeat_deadline=2", "--set", "time.end=100")
            run.wait_for_steps(10)
            pids = descendants(run.process.pid)
            run.send("mass_spring_wal", number)  # the kernel keeps 15 letters
            code, lines = run.end(15)
            self.assertEqual(code, 4, lines)
            self.assertIn(text, lines[0])
            self.assertIn(wall, lines[0])
            self.assertEqual(still_running(pids), [])

    def test_the_check_of_what_is_no_program_is_refused(self):
        for command, text in (("no-such-program", "there is no program"), ("", "names no program")):
            result = subprocess.run([COUPLET, "check-participant", command], capture_output=True, text=True, timeout=60)
            self.assertEqual((result.returncode, len(result.stderr.splitlines())), (2, 1), result.stderr)
            self.assertIn(text, result.stderr)


if __name__ == "__main__":
    unittest.main()
