#!/usr/bin/python3
"""A wall of masses on springs that does one thing wrong: wrong_participant.py FAULT serve ... FAULTS says what there is, and
which rule of check_participant.py must notice."""

import os
import random
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[4] / "deploy" / "participant"))

import couplet_participant as module  # noqa: E402
import mass_spring_wall  # noqa: E402

FAULTS = {}


def fault(rule):
    """Registers a class, or a function that spoils the module, by its name with - for _."""
    def add(thing):
        FAULTS[thing.__name__.strip("_").replace("_", "-")] = rule, thing
        return thing
    return add


class Wall(mass_spring_wall.Wall):
    __doc__ = mass_spring_wall.Wall.__doc__


def replace(owner, name):
    """Puts a function in the place of another one, which it is given first."""
    before = getattr(owner, name)

    def put(after):
        setattr(owner, name, lambda *words, **named: after(before, *words, **named))
    return put


# ---- start and end

@fault("listening ADDRESS")
def ends_at_once():
    sys.exit(0)


@fault("listening ADDRESS")
def says_nothing():
    module.print = lambda *words, **named: sys.exit(3)


@fault("other machines")
def listens_to_all():
    def with_a_key(before, kind, words):
        options = before(kind, [*words, "--key", "none"])
        options.key = None
        return options
    replace(module, "read_command_line")(with_a_key)


@fault("serves the first program")
def obeys_everybody():
    @replace(module.Channel, "receive")
    def receive(before, channel):
        channel.peer = None
        return before(channel)


@fault("coupler has gone")
def waits_for_ever():
    class Deaf(module.Channel):
        def receive(self):
            self.connection = -2  # which never ends
            return super().receive()
    module.Channel = Deaf


@fault("coupler is frozen")
def has_no_heartbeat():
    for name in ("HEARTBEAT_IVL", "HEARTBEAT_TIMEOUT", "HEARTBEAT_TTL"):
        setattr(module.zmq, name, module.zmq.LINGER)


@fault("peak_memory_bytes")
def close_tells_nothing():
    @replace(module.Session, "close")
    def close(before, session, request, arrays, reply):
        before(session, request, arrays, reply)
        del reply.closed.quantity[:]


@fault("ends with code 0")
def ends_with_code_1():
    @replace(module, "serve_one_session")
    def serve(before, *words):
        before(*words)
        os._exit(1)


@fault("ends with code 0")
def never_ends():
    @replace(module, "serve_one_session")
    def serve(before, *words):
        before(*words)
        time.sleep(100)


@fault("may be closed at once")
def cannot_be_closed_early():
    @replace(module.Session, "close")
    def close(before, session, request, arrays, reply):
        if session.state != "accepted":
            raise module.Failure("PEER", "not yet")
        before(session, request, arrays, reply)


# ---- hello and open

@fault("welcome with protocol 1")
def speaks_protocol_7():
    @replace(module.Session, "hello")
    def hello(before, session, request, arrays, reply):
        before(session, request, arrays, reply)
        reply.welcome.protocol = 7


@fault("another protocol")
def takes_any_protocol():
    @replace(module.Session, "hello")
    def hello(before, session, request, arrays, reply):
        request.protocol = 1
        before(session, request, arrays, reply)


class OddSurface(Wall):
    def open(self, request):
        opened = super().open(request)
        self.spoil(opened.surface, opened)
        return opened


@fault("sound surface")
class node_outside(OddSurface):
    def spoil(self, surface, opened):
        surface.faces[0][0] = len(surface.node_position)


@fault("sound surface")
class node_twice(OddSurface):
    def spoil(self, surface, opened):
        surface.faces[0][0] = surface.faces[0][1]


@fault("sound surface")
class face_of_five(OddSurface):
    def spoil(self, surface, opened):
        surface.faces[0] = surface.faces[0][:5]


@fault("sound surface")
class region_outside(OddSurface):
    def spoil(self, surface, opened):
        surface.region = []


@fault("sound surface")
class marker_outside(OddSurface):
    def spoil(self, surface, opened):
        surface.marker["far"] = 10**6


@fault("sound surface")
class position_not_finite(OddSurface):
    def spoil(self, surface, opened):
        surface.node_position[0, 0] = np.nan


@fault("sound surface")
class starts_late(OddSurface):
    def spoil(self, surface, opened):
        opened.time = 0.5


@fault("sound surface")
class unprintable_region(OddSurface):
    def spoil(self, surface, opened):
        surface.region = ["the wall"]


@fault("sound surface")
def wrong_checksum():
    replace(module, "crc32c")(lambda before, data: before(data) ^ 1)


@fault("sound surface")
def wrong_shape():
    @replace(module, "pack")
    def pack(before, reply, arrays):
        frames = before(reply, arrays)
        for header in reply.array:
            if len(header.shape) == 2:
                header.shape[0] += 1
        return [reply.SerializeToString(), *frames[1:]]


# ---- steps

@fault("a step: each offered field")
class returns_one_field_less(Wall):
    def solve_step(self, step, fields):
        solved = super().solve_step(step, fields)
        del solved["velocity"]
        return solved


@fault("a step: each offered field")
class is_not_finite(Wall):
    def solve_step(self, step, fields):
        return {name: np.full_like(array, np.nan) for name, array in super().solve_step(step, fields).items()}


@fault("last accepted state")
class starts_from_the_last_trial(Wall):
    def solve_step(self, step, fields):
        solved = super().solve_step(step, fields)
        self.state = self.trial
        return solved


@fault("equal bits for equal requests")
class is_never_the_same(Wall):
    def solve_step(self, step, fields):
        return {name: array * (1 + 1e-15 * random.random()) for name, array in super().solve_step(step, fields).items()}


@fault("half its duration")
class cannot_take_half_a_step(Wall):
    duration = None

    def solve_step(self, step, fields):
        self.duration = step.duration = self.duration or step.duration
        return super().solve_step(step, fields)


@fault("same names")
class changes_its_names(Wall):
    def accept_step(self, step):
        super().accept_step(step)
        return {f"energy_{step}": 1.0}


@fault("same names")
def accepts_without_a_word():
    module.REPLY["accept_step"] = "welcome"

    @replace(module.Session, "accept_step")
    def accept(before, session, request, arrays, reply):
        session.participant.accept_step(request.step)
        reply.ClearField("welcome")


# ---- numbers and states

@fault("repeated number")
def serves_repeats_again():
    @replace(module.Session, "answer")
    def answer(before, session, frames):
        number = module.v1.Request.FromString(frames[0]).sequence
        session.sequence -= number == session.sequence
        session.state = "solved" if session.state == "accepted" else session.state
        return before(session, frames)


@fault("old number")
def serves_old_numbers():
    @replace(module.Session, "answer")
    def answer(before, session, frames):
        session.sequence = module.v1.Request.FromString(frames[0]).sequence - 1
        return before(session, frames)


@fault("old number")
def fails_at_old_numbers():
    @replace(module.Session, "answer")
    def answer(before, session, frames):
        if module.v1.Request.FromString(frames[0]).sequence < session.sequence:
            session.state = "failed"
        return before(session, frames)


@fault("number that is too large")
def does_not_miss_a_number():
    @replace(module.Session, "answer")
    def answer(before, session, frames):
        session.sequence = max(session.sequence, module.v1.Request.FromString(frames[0]).sequence - 1)
        return before(session, frames)


def allow(state, body):
    module.NEXT_STATE[state, body] = state


@fault("in state connected")
def opens_before_hello():
    allow("connected", "open_scene")


@fault("in state opened")
def accepts_nothing():
    allow("opened", "accept_step")
    Wall.accept_step = lambda self, step: None


@fault("in state solved")
def writes_a_trial():
    allow("solved", "write_checkpoint")


@fault("in state accepted")
def accepts_twice():
    allow("accepted", "accept_step")


@fault("in state greeted")
def recovers_from_refusals():
    @replace(module.Session, "fail")
    def fail(before, session, number, failure):
        state = session.state
        frames = before(session, number, failure)
        session.state = state
        return frames


@fault("in state greeted")
def fails_without_a_kind():
    @replace(module.Session, "describe")
    def describe(before, number, failure):
        reply = module.v1.Reply.FromString(before(number, failure)[0])
        reply.failure.ClearField("kind")
        return [reply.SerializeToString()]
    module.Session.describe = staticmethod(module.Session.describe)


# ---- checkpoints

@fault("continues from it")
class forgets_its_velocity(Wall):
    def open(self, request):
        opened = super().open(request)
        self.state[1] = 0
        opened.fields = self.fields(self.state)
        return opened


@fault("continues from it")
class forgets_the_last_digits(Wall):
    def open(self, request):
        opened = super().open(request)
        self.state = self.state.astype(np.float32).astype(float)
        return opened


@fault("continues from it")
class forgets_the_time(Wall):
    def open(self, request):
        opened = super().open(request)
        opened.time = 0.0
        return opened


@fault("continues from it")
class writes_another_file(Wall):
    def write_checkpoint(self, path):
        super().write_checkpoint(path + ".npy")
        os.path.getsize = lambda path: 1


@fault("cannot be written or read")
class does_not_mind_a_torn_checkpoint(Wall):
    def open(self, request):
        try:
            return super().open(request)
        except (ValueError, EOFError):
            request.resume_from = ""
            return super().open(request)


# ---- damaged messages

@fault("is not a request")
def dies_of_garbage():
    @replace(module.Session, "answer")
    def answer(before, session, frames):
        module.v1.Request.FromString(frames[0])
        return before(session, frames)


@fault("is not a request")
def answers_garbage_by_a_number():
    @replace(module.Session, "fail")
    def fail(before, session, number, failure):
        return before(session, number or session.sequence, failure)


@fault("damaged, misshapen or missing")
def believes_any_checksum():
    class Any:
        def __eq__(self, other):
            return True

        def __ne__(self, other):
            return False

    checksum = module.crc32c
    replace(module, "unpack")(lambda before, request, frames: with_checksum(lambda data: Any(), lambda: before(request, frames)))

    def with_checksum(function, work):
        module.crc32c = function
        try:
            return work()
        finally:
            module.crc32c = checksum


@fault("damaged, misshapen or missing")
def believes_any_number_of_rows():
    @replace(module.Session, "solve_step")
    def solve(before, session, request, arrays, reply):
        arrays["force"] = np.resize(arrays.get("force", np.zeros((1, 3))), (session.n_nodes, 3))
        return before(session, request, arrays, reply)


@fault("damaged, misshapen or missing")
def dies_of_a_wrong_shape():
    @replace(module.Session, "serve")
    def serve(before, session, request, frames):
        for header, frame in zip(request.array, frames[1:]):
            np.frombuffer(frame).reshape(tuple(header.shape)) if header.name == "force" else None
        return before(session, request, frames)


def main():
    name = sys.argv.pop(1)
    _, thing = FAULTS[name]
    kind = thing if isinstance(thing, type) else Wall
    if kind is Wall:
        thing()
    module.serve(kind, sys.argv[1:])


if __name__ == "__main__":
    main()
