#!/usr/bin/python3
"""The Python module for participants: what becomes of failures, of arrays and of the command line, without a socket."""

import argparse
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

PARTICIPANTS = Path(__file__).resolve().parents[4] / "deploy" / "participant"
sys.path.insert(0, str(PARTICIPANTS))

import couplet_participant as module  # noqa: E402
from couplet_participant import Failure, Opened, Participant, Session, Surface, v1  # noqa: E402
from liquid_column import LiquidColumn  # noqa: E402
from mass_spring_wall import Wall, face_mass, shape_functions  # noqa: E402

TRIANGLE = Surface(np.eye(3), [[0, 1, 2]])


class Doubling(Participant):
    """Twice the force, or the failure that a test puts here."""

    trouble = None

    def __init__(self, options=None):
        self.closed = []

    def open(self, request):
        return Opened(TRIANGLE, ["force"], {"displacement": np.zeros((3, 3))})

    def solve_step(self, step, fields):
        if self.trouble is not None:
            raise self.trouble
        return {"displacement": 2 * fields["force"]}

    def accept_step(self, step):
        pass

    def close(self, reason):
        self.closed.append(reason)


class SessionCase(unittest.TestCase):
    def setUp(self):
        self.participant = Doubling()
        self.session = Session(self.participant, "doubling")
        self.number = 0

    def ask(self, body, arrays=None, change=lambda request, frames: None, **fields):
        """The reply to the next request, and its frames."""
        self.number += 1
        request = v1.Request(sequence=self.number)
        message = getattr(request, body)
        message.SetInParent()
        for name, value in fields.items():
            setattr(message, name, value)
        frames = module.pack(request, arrays or {})
        change(request, frames)
        frames[0] = request.SerializeToString()
        frames = self.session.answer(frames)
        return v1.Reply.FromString(frames[0]), frames

    def open(self):
        self.ask("hello", protocol=1)
        return self.ask("open_scene")[0]

    def solve(self, force=np.ones((3, 3)), **options):
        return self.ask("solve_step", {"force": force}, duration=0.1, **options)

    def expect_failure(self, reply, kind, words):
        self.assertEqual(v1.Failure.Kind.Name(reply.failure.kind), kind)
        self.assertIn(words, reply.failure.sentence)


class SessionTest(SessionCase):
    def test_fields_come_back(self):
        self.open()
        reply, frames = self.solve()
        self.assertEqual([header.name for header in reply.array], ["displacement"])
        np.testing.assert_array_equal(np.frombuffer(frames[1]), np.full(9, 2.0))

    def test_checksum_is_that_of_the_protocol(self):
        self.assertEqual(module.crc32c(b"123456789"), 0xE3069283)

    def test_accepting_with_nothing_to_tell_is_an_answer(self):
        self.open()
        self.solve()
        self.assertEqual(self.ask("accept_step")[0].WhichOneof("body"), "step_accepted")

    def test_numerics_in_a_step_may_be_tried_again(self):
        self.open()
        self.participant.trouble = Failure("NUMERICS", "diverged at node 7")
        self.expect_failure(self.solve()[0], "NUMERICS", "node 7")
        self.participant.trouble = None
        self.assertEqual(self.solve()[0].WhichOneof("body"), "step_solved")
        self.ask("accept_step")
        self.ask("close")
        self.assertIsNone(self.session.failure or self.session.step_failure)

    def test_what_is_not_finite_is_numerics(self):
        self.open()
        self.expect_failure(self.solve(np.full((3, 3), np.inf))[0], "NUMERICS", "not a number")
        self.assertEqual(self.session.state, "opened")

    def test_other_failures_leave_only_close(self):
        for trouble, kind, words in ((Failure("SCENE", "no such material"), "SCENE", "no such material"),
                                     (PermissionError(13, "Permission denied", "/x"), "FILE", "Permission denied"),
                                     (KeyError("speed"), "BUG", "KeyError")):
            self.setUp()
            self.open()
            self.participant.trouble = trouble
            sys.stderr, kept = open(os.devnull, "w"), sys.stderr
            self.expect_failure(self.solve()[0], kind, words)
            sys.stderr.close()
            sys.stderr = kept
            self.participant.trouble = None
            self.expect_failure(self.solve()[0], "PEER", "not allowed in state failed")
            self.assertEqual(self.ask("close", reason="over")[0].WhichOneof("body"), "closed")
            self.assertEqual(self.participant.closed, ["over"])
            self.assertEqual(self.session.failure.kind, kind)

    def test_bad_arrays_are_refused(self):
        def header(**values):
            return lambda request, frames: [setattr(request.array[0], name, value) for name, value in values.items()]

        def reshape(*shape):
            return lambda request, frames: request.array[0].ClearField("shape") or request.array[0].shape.extend(shape)

        for change, words in ((header(crc32c=1), "damaged"), (lambda r, f: r.array[0].ClearField("crc32c"), "checksum"),
                              (header(scalar_type=v1.ArrayHeader.INT64), "type"), (reshape(4, 3), "72 bytes"), (reshape(-3, -3), "bytes"),
                              (reshape(9), "bytes"), (reshape(2**40, 2**40), "bytes"), (header(name="push"), "force is missing")):
            self.setUp()
            self.open()
            self.expect_failure(self.solve(change=change)[0], "PEER", words)
        self.setUp()
        self.open()
        self.expect_failure(self.solve(np.ones((4, 3)))[0], "PEER", "one row for each of 3 nodes")

    def test_a_surface_travels_both_ways(self):
        surface = Surface(np.arange(12.0).reshape(4, 3), [[0, 1, 2], [1, 3, 2]], [1, 0], ["a", "b"], {"tip": 3})
        names = v1.SurfaceNames(region=surface.region)
        names.marker.add(name="tip", node=3)
        request = v1.Request()
        again = module.surface_of(module.unpack(request, module.pack(request, module.arrays_of(surface))), names)
        np.testing.assert_array_equal(again.node_position, surface.node_position)
        self.assertEqual([list(face) for face in again.faces], surface.faces)
        self.assertEqual((list(again.face_region), again.region, again.marker), ([1, 0], ["a", "b"], {"tip": 3}))


class ExampleTest(unittest.TestCase):
    def test_face_of_the_wall(self):
        np.testing.assert_allclose([shape_functions(0.3, -0.2).sum(), face_mass(6.0).sum()], [1, 6], rtol=1e-14)
        np.testing.assert_allclose(face_mass(6.0).sum(axis=0), 6 * np.array([-1 / 12] * 4 + [1 / 3] * 4), rtol=1e-14)

    def make_wall(self, *words):
        parser = argparse.ArgumentParser()
        Wall.add_options(parser)
        wall = Wall(parser.parse_args(words))
        return wall, wall.open(module.OpenRequest(None, "", "", "", None))

    def test_normal_of_the_wall_points_up(self):
        _, opened = self.make_wall("--faces", "3", "2")
        areas = [np.cross(p[1] - p[0], p[3] - p[0]) for p in (opened.surface.node_position[face] for face in opened.surface.faces)]
        np.testing.assert_allclose(areas, np.tile([0, 0.02 * 0.01 / 6, 0], (6, 1)), atol=1e-18)

    def test_wall_in_a_vacuum_is_exact(self):
        wall, opened = self.make_wall("--rest", "1e-3", "--mass", "2", "--stiffness", "50")
        n_nodes = len(opened.surface.node_position)
        for i in range(20):
            for duration in (0.07, 0.05):  # the first is not accepted and leaves no trace
                fields = wall.solve_step(module.Step(i, 1, 0.05 * i, duration), {"force": np.zeros((n_nodes, 3))})
            wall.accept_step(i)
        np.testing.assert_allclose(fields["displacement"][:, 1], 1e-3 * (1 - np.cos(5.0)), atol=1e-16)

    def test_pressure_on_the_wall_gives_the_acceleration_of_its_mass(self):
        wall, opened = self.make_wall("--mass", "2", "--stiffness", "1e-6")
        liquid = LiquidColumn(argparse.Namespace(height=0.1, density=100.0))
        liquid.open(module.OpenRequest(None, "", "", "", opened.surface))
        n_nodes = len(opened.surface.node_position)
        lifted = np.tile([0, 0.5 * 1e-4, 0], (n_nodes, 1))
        force = liquid.solve_step(module.Step(1, 1, 0, 0.01), {"displacement": lifted})["force"]
        np.testing.assert_allclose(force.sum(axis=0), [0, -100 * 0.1 * 0.02 * 0.01 * 0.5, 0], atol=1e-12)
        fields = wall.solve_step(module.Step(1, 1, 0, 0.01), {"force": force})
        np.testing.assert_allclose(fields["velocity"][:, 1], -0.01 * 5 * 0.5, rtol=1e-6)


class CommandLineTest(unittest.TestCase):
    def run_wall(self, *words, **environment):
        return subprocess.run([str(PARTICIPANTS / "mass_spring_wall.py"), *words], capture_output=True, text=True, timeout=60,
                              env={**os.environ, **environment})

    def expect_line(self, result, code, words):
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertIn(words, result.stderr)

    def test_refusals_are_one_line(self):
        self.expect_line(self.run_wall("serve", "--listen", "tcp://0.0.0.0:*"), 2, "--key")
        self.expect_line(self.run_wall("--colour", "red", "serve"), 2, "--help")
        self.expect_line(self.run_wall("--mass", "-1", "serve"), 2, "--mass: -1.0 is not above 0")
        self.expect_line(self.run_wall("serve", "--listen", "ipc:///no/such/folder/socket"), 4, "cannot bind")
        self.expect_line(self.run_wall("serve", "--wait", "0.1"), 4, "no coupler has come")

    def test_classes_are_made_where_nothing_can_be_kept(self):
        with tempfile.TemporaryDirectory() as folder:
            blocked = Path(folder) / "a file"
            blocked.touch()
            result = self.run_wall("serve", "--wait", "0.1", XDG_CACHE_HOME=str(blocked))
            self.expect_line(result, 4, "no coupler has come")
            kept = self.run_wall("serve", "--wait", "0.1", XDG_CACHE_HOME=folder)
            self.expect_line(kept, 4, "no coupler has come")
            self.assertEqual(len(list(Path(folder).glob("couplet/messages-*/couplet/v1/exchange_pb2.py"))), 1)

    def test_a_missing_compiler_of_messages_is_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            result = self.run_wall("serve", XDG_CACHE_HOME=folder, PATH=folder)
            self.expect_line(result, 5, "protobuf-compiler")


if __name__ == "__main__":
    unittest.main()
