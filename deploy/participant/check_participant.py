#!/usr/bin/python3
"""Tells whether a program keeps to the protocol of proto/README.md: starts it once for each rule, talks to it as the coupler
does and as the coupler never would, and prints one line a rule.

It shares no line with couplet_participant.py but the classes of the messages: a mistake of one would be excused by the other."""

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import zmq
from google.protobuf import message, text_format

from couplet_messages import exchange_pb2 as v1

DONE, COMMAND_LINE_WRONG, PARTICIPANT_WRONG = 0, 2, 4
START = 60  # [s] until it says where it listens
REPLY = 300  # [s] for the answer to a request
END = 10  # [s] from the reply to close, until the program has ended
HEARTBEAT = 8  # [s] the default of `serve --heartbeat`
TOLERANCE = 1e-6  # of a solution, where a solver may start its iterations from another guess
FACE_SIZES = (3, 4, 6, 8)
SURFACE_TYPES = {"node_position": v1.ArrayHeader.FLOAT64, "face_offset": v1.ArrayHeader.INT64, "face_node": v1.ArrayHeader.INT64,
                 "face_region": v1.ArrayHeader.INT64}
REPLIES = {"hello": "welcome", "open_scene": "scene_ready", "solve_step": "step_solved", "accept_step": "step_accepted",
           "write_checkpoint": "checkpoint_written", "close": "closed"}


class Broken(Exception):
    """A rule that is not kept; the text says what the program does instead."""


class NotReached(Exception):
    """The rule could not be looked at, because another one is not kept."""


def make_crc_table():
    table = []
    for byte in range(256):
        for _ in range(8):
            byte = byte >> 1 ^ 0x82F63B78 * (byte & 1)
        table.append(byte)
    return table


CRC_TABLE = make_crc_table()


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc = crc >> 8 ^ CRC_TABLE[crc & 0xFF ^ byte]
    return crc ^ 0xFFFFFFFF


def is_name(text):
    return bool(text) and all(" " < letter <= "~" for letter in text)


def require(holds, otherwise):
    if not holds:
        raise Broken(otherwise)


def read_arrays(reply, frames):
    """{name: array} of a reply; Broken for one that is not what the protocol says."""
    require(len(reply.array) == len(frames) - 1, f"announces {len(reply.array)} arrays and brings {len(frames) - 1}")
    arrays = {}
    for header, frame in zip(reply.array, frames[1:]):
        name, shape = header.name, tuple(header.shape)
        require(is_name(name), f"an array has the name {name!r}, which is not printable")
        require(name not in arrays, f"array {name} comes twice")
        wanted = SURFACE_TYPES.get(name, v1.ArrayHeader.FLOAT64)
        n_dimensions = 1 if wanted == v1.ArrayHeader.INT64 else 2
        require(header.scalar_type == wanted, f"array {name} has not the type {v1.ArrayHeader.ScalarType.Name(wanted)}")
        require(len(shape) == n_dimensions and min(shape) >= 0, f"array {name} has the shape {shape} and not {n_dimensions} numbers")
        require(8 * int(np.prod(shape)) == len(frame), f"array {name} of shape {shape} has {len(frame)} bytes")
        require(header.HasField("crc32c"), f"array {name} comes without its checksum crc32c")
        require(header.crc32c == crc32c(frame), f"array {name} has the checksum {header.crc32c:#010x}, its bytes have {crc32c(frame):#010x}")
        arrays[name] = np.frombuffer(frame, "<i8" if n_dimensions == 1 else "<f8").reshape(shape)
        require(n_dimensions == 1 or np.isfinite(arrays[name]).all(), f"array {name} holds what is not a number")
    return arrays


class Program:
    """The program under test, started for one session."""

    def __init__(self, bench, extra=(), listen=None):
        self.folder = tempfile.TemporaryDirectory(prefix="couplet-check-")
        self.errors = open(Path(self.folder.name) / "errors.txt", "w+", encoding="utf-8", errors="replace")
        listen = listen or f"ipc://{self.folder.name}/socket"
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *filter(None, [os.environ.get("PYTHONPATH")])])}
        self.process = subprocess.Popen([*bench.command, "serve", "--listen", listen, *extra, *bench.scene_words], stdin=subprocess.DEVNULL,
                                        stdout=subprocess.PIPE, stderr=self.errors, env=environment, start_new_session=True)
        self.printed = b""

    def address(self):
        """What it prints after `listening`."""
        deadline = time.monotonic() + START
        os.set_blocking(self.process.stdout.fileno(), False)
        while time.monotonic() < deadline:
            has_ended = self.process.poll() is not None
            self.printed += self.process.stdout.read() or b""
            for line in self.printed.decode(errors="replace").split("\n")[:-1]:
                if line.startswith("listening "):
                    return line.removeprefix("listening ").strip()
            if has_ended:
                raise Broken(f"{self.how_it_ended()} before it printed `listening ADDRESS`")
            time.sleep(0.01)
        raise Broken(f"did not print `listening ADDRESS` within {START} s")

    def how_it_ended(self):
        code = self.process.poll()
        self.errors.seek(0)
        lines = [line for line in self.errors.read().splitlines() if line.strip()]
        said = f' ("{lines[-1].strip()[:200]}")' if lines else ""
        return (f"was ended by signal {-code}" if code < 0 else f"ended with code {code}") + said

    def end(self, within):
        """Exit code; Broken when it does not end by itself in time [s]."""
        try:
            return self.process.wait(within)
        except subprocess.TimeoutExpired:
            raise Broken(f"still runs {within:g} s later") from None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        self.process.stdout.close()
        self.errors.close()
        self.folder.cleanup()


class Talk:
    """A coupler of our own, connected to a program."""

    def __init__(self, program, address):
        self.program, self.number = program, 0
        self.context = zmq.Context()
        self.socket = self.context.socket(zmq.DEALER)
        self.socket.setsockopt(zmq.LINGER, 0)
        self.socket.setsockopt(zmq.HEARTBEAT_IVL, 2000)
        self.socket.connect(address)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.context.destroy(linger=0)

    def send(self, frames):
        self.socket.send_multipart(frames)

    def receive(self, to, within=REPLY):
        """Reply and frames; Broken when there is none."""
        deadline = time.monotonic() + within
        while not self.socket.poll(50):
            if self.program.process.poll() is not None and not self.socket.poll(50):
                raise Broken(f"{self.program.how_it_ended()} in place of an answer to {to}")
            if time.monotonic() > deadline:
                raise Broken(f"gave no answer to {to} within {within:g} s")
        frames = self.socket.recv_multipart()
        try:
            reply = v1.Reply.FromString(frames[0])
        except message.DecodeError:
            raise Broken(f"answers {to} by what is not a Reply") from None
        require(reply.WhichOneof("body") is not None, f"answers {to} by a Reply that says nothing: its body is not set")
        return reply, frames

    def ask_anything(self, body, arrays=None, change=lambda request, frames: None, number=None, **fields):
        """The reply to a request, whatever it is, and its frames. `change` spoils the request before it is sent; `number`
        takes the place of the next sequence number."""
        self.number = self.number + 1 if number is None else self.number
        request = v1.Request(sequence=self.number if number is None else number)
        getattr(request, body).SetInParent()
        getattr(request, body).MergeFrom(type(getattr(request, body))(**fields))
        frames = [b""]
        for name, array in (arrays or {}).items():
            is_index = SURFACE_TYPES.get(name) == v1.ArrayHeader.INT64
            frames.append(np.ascontiguousarray(array, "<i8" if is_index else "<f8").tobytes())
            request.array.add(name=name, scalar_type=SURFACE_TYPES.get(name, v1.ArrayHeader.FLOAT64), shape=np.shape(array),
                              unit="SI", crc32c=crc32c(frames[-1]))
        change(request, frames)
        frames[0] = request.SerializeToString()
        self.send(frames)
        reply, frames = self.receive(body)
        require(reply.sequence == request.sequence, f"answers {body} number {request.sequence} by a reply with number {reply.sequence}")
        return reply, frames

    def ask(self, body, arrays=None, **fields):
        """The reply that must not be a Failure, and its arrays."""
        reply, frames = self.ask_anything(body, arrays, **fields)
        if reply.HasField("failure"):
            where = f"{reply.failure.where}: " if reply.failure.where else ""
            raise Broken(f'answers {body} by the failure "{where}{reply.failure.sentence}"')
        require(reply.WhichOneof("body") == REPLIES[body], f"answers {body} by {reply.WhichOneof('body')}")
        return getattr(reply, REPLIES[body]), read_arrays(reply, frames)

    def expect_failure(self, what, reply, kinds=()):
        require(reply.HasField("failure"), f"answers {what} by {reply.WhichOneof('body')} in place of a Failure")
        failure = reply.failure
        require(failure.kind != v1.Failure.KIND_UNSPECIFIED, f"its Failure to {what} has no kind")
        require(failure.sentence.strip(), f"its Failure to {what} has no sentence")
        kind = v1.Failure.Kind.Name(failure.kind)
        require(not kinds or kind in kinds, f'its Failure to {what} is of kind {kind} and not {" or ".join(kinds)} ("{failure.sentence[:150]}")')

    def expect_only_close(self, after):
        """The session has failed: all but close is refused, and close ends the program."""
        self.expect_failure(f"hello after {after}", self.ask_anything("hello", protocol=1)[0])
        reply, _ = self.ask_anything("close", reason="over")
        require(reply.HasField("closed"), f"answers close after {after} by {reply.WhichOneof('body')}")
        self.program.end(END)


class Bench:
    """What all rules share: the command, the scene, a surface for the one who is opened last, and loads."""

    def __init__(self, command, scene, scene_folder, scene_words, peer_surface):
        self.command, self.scene, self.scene_folder, self.scene_words = command, scene, scene_folder, scene_words
        self.peer_surface = peer_surface  # SurfaceNames and arrays, or None
        self.step = scene.time.step
        self.run_folder = None

    def talk(self, **options):
        return Conversation(self, **options)


class Conversation:
    """A program that was started, and a coupler that has brought it to some state."""

    def __init__(self, bench, resume_from=""):
        self.bench, self.resume_from = bench, resume_from
        self.n_solved = self.n_accepted = 0

    def __enter__(self):
        self.program = Program(self.bench).__enter__()
        try:
            self.talk = Talk(self.program, self.program.address())
        except Broken as fault:
            self.program.__exit__()
            raise NotReached(str(fault)) from None
        return self

    def __exit__(self, *_):
        self.talk.__exit__()
        self.program.__exit__()

    def open_fields(self):
        names, arrays = self.bench.peer_surface or (None, {})
        fields = {"scene": self.bench.scene, "scene_folder": self.bench.scene_folder, "resume_from": self.resume_from}
        return {**fields, "surface": names} if names else fields, arrays

    def open(self):
        fields, arrays = self.open_fields()
        self.talk.ask("hello", protocol=1, run="check", commit="none")
        self.ready, self.fields = self.talk.ask("open_scene", arrays, **fields)
        self.position = self.fields["node_position"]
        self.start = self.ready.time
        return self

    def load(self, end, factor=1.0):
        """The fields that it needs: a small smooth motion that grows with time, or small forces."""
        size = np.ptp(self.position, axis=0).max() or 1.0
        shape = np.sin(3 * self.position / size + [0.3, 0.7, 1.1])
        rate = 1e-6 * size / self.bench.step  # [m/s]
        values = {"displacement": rate * end * shape, "velocity": rate * shape}
        return {name: factor * values.get(name, 1e-6 * shape) for name in self.ready.needs}

    def solve(self, factor=1.0, part=1.0, **options):
        """The offered fields after a step, or a part of one, from the accepted state."""
        end = self.start + part * self.bench.step
        self.n_solved += 1
        self.last_end = end
        return self.talk.ask("solve_step", self.load(end, factor), **self.interval(part), **options)[1]

    def interval(self, part=1.0):
        return {"step": self.n_accepted + 1, "iteration": self.n_solved, "start": self.start, "duration": part * self.bench.step}

    def accept(self):
        reply, _ = self.talk.ask("accept_step", step=self.n_accepted + 1)
        self.n_accepted, self.n_solved, self.start = self.n_accepted + 1, 0, self.last_end
        return [quantity.name for quantity in reply.quantity]

    def bring_to(self, state):
        """Asks what leads there."""
        if state != "connected":
            self.talk.ask("hello", protocol=1, run="check", commit="none")
        if state in ("opened", "solved", "accepted"):
            fields, arrays = self.open_fields()
            self.ready, self.fields = self.talk.ask("open_scene", arrays, **fields)
            self.position, self.start = self.fields["node_position"], self.ready.time
        if state in ("solved", "accepted"):
            self.solve()
        if state == "accepted":
            self.accept()

    def request(self, body, folder):
        """Arrays and fields of a request that would be right in its own state."""
        if body == "hello":
            return {}, {"protocol": 1}
        if body == "open_scene":
            fields, arrays = self.open_fields()
            return arrays, fields
        if body == "solve_step":
            return (self.load(self.start), self.interval()) if hasattr(self, "ready") else ({}, {"step": 1, "duration": self.bench.step})
        if body == "write_checkpoint":
            return {}, {"path": str(Path(folder) / "early")}
        return {}, {"step": 1}


RULES = []


def rule(sentence, section):
    """Adds a rule: what a good program does, and where proto/README.md says so."""
    def add(check):
        RULES.append((sentence, section, check))
        return check
    return add


def same_bits(first, second, where):
    for name in first:
        require(name in second, f"field {name} is missing {where}")
        require(first[name].tobytes() == second[name].tobytes(), f"field {name} differs by up to "
                f"{np.abs(first[name] - second[name]).max() if first[name].shape == second[name].shape else 'its shape'} {where}")


def prepared(bench, **options):
    """A conversation with an opened scene; NotReached when that fails, since other rules tell about it."""
    class Prepared(Conversation):
        def __enter__(self):
            super().__enter__()
            try:
                return self.open()
            except Broken as fault:
                self.__exit__()
                raise NotReached(str(fault)) from None
    return Prepared(bench, **options)


@rule("prints `listening ADDRESS` and can be reached there", "Finding and losing each other")
def check_listening(bench):
    with Program(bench) as program:
        with Talk(program, program.address()) as talk:
            talk.ask_anything("hello", protocol=1)


@rule("refuses an address that other machines can reach, without keys", "Finding and losing each other")
def check_local(bench):
    with Program(bench, listen="tcp://0.0.0.0:*") as program:
        try:
            address = program.address()
        except Broken:
            require(program.process.poll() not in (0, None), "neither listens there nor ends with a code that tells of it")
            return
        raise Broken(f"listens at {address}, where whoever comes first is obeyed")


@rule("answers hello by welcome with protocol 1", "Session")
def check_hello(bench):
    with bench.talk() as c:
        welcome, _ = c.talk.ask("hello", protocol=1, run="check", commit="none")
        require(welcome.protocol == 1, f"says protocol {welcome.protocol}")
        require(welcome.program, "does not say what program it is")


@rule("refuses another protocol", "Versions")
def check_version(bench):
    with bench.talk() as c:
        reply, _ = c.talk.ask_anything("hello", protocol=2, run="check", commit="of tomorrow")
        c.talk.expect_failure("hello with protocol 2", reply)
        c.talk.expect_only_close("a refused hello")


@rule("opens a scene with a sound surface, and says what it needs and offers", "Messages")
def check_open(bench):
    with bench.talk() as c:
        c.open()
        ready, arrays = c.ready, c.fields
        require("node_position" in arrays, "brings no node_position")
        n_nodes = len(arrays["node_position"])
        require(n_nodes > 0 and arrays["node_position"].shape[1] == 3, f"node_position has the shape {arrays['node_position'].shape}")
        require(ready.needs, "needs no field: nothing would reach it")
        require(ready.offers, "offers no field")
        for name in (*ready.needs, *ready.offers):
            require(is_name(name) and name not in SURFACE_TYPES, f"{name!r} cannot be the name of a field")
        for name in ready.offers:
            require(name in arrays, f"offers {name} but does not bring it")
            require(len(arrays[name]) == n_nodes, f"{name} has {len(arrays[name])} rows for {n_nodes} nodes")
        require(abs(ready.time) < 1e-12, f"starts at t = {ready.time:g} s and not at 0")
        check_faces(arrays, ready.surface, n_nodes)


def check_faces(arrays, names, n_nodes):
    for region in names.region:
        require(is_name(region), f"a region has the name {region!r}, which is not printable")
    for marker in names.marker:
        require(is_name(marker.name), f"a marker has the name {marker.name!r}, which is not printable")
        require(0 <= marker.node < n_nodes, f"marker {marker.name} is node {marker.node} of {n_nodes}")
    offset, node, region = (arrays.get(name, np.zeros(0, int)) for name in ("face_offset", "face_node", "face_region"))
    if not len(node) and len(offset) <= 1 and not len(region):
        return
    require(len(offset) > 1 and offset[0] == 0, "face_offset does not begin with 0")
    require(np.isin(np.diff(offset), FACE_SIZES).all(), "face_offset has faces with another number of nodes than 3, 4, 6 or 8")
    require(offset[-1] == len(node), f"face_offset ends with {offset[-1]}, face_node has {len(node)} entries")
    require(0 <= node.min() and node.max() < n_nodes, f"face_node goes from {node.min()} to {node.max()}, there are {n_nodes} nodes")
    require(len(region) == len(offset) - 1, f"face_region has {len(region)} entries for {len(offset) - 1} faces")
    require(0 <= region.min() and region.max() < len(names.region), f"face_region goes up to {region.max()}, there are {len(names.region)} regions")
    for first, last in zip(offset, offset[1:]):
        require(len(set(node[first:last])) == last - first, f"a face names a node twice: {list(node[first:last])}")


@rule("solves a step: each offered field, one row a node, finite", "Session")
def check_solve(bench):
    with prepared(bench) as c:
        fields = c.solve()
        for name in c.ready.offers:
            require(name in fields, f"offers {name} but does not return it")
            require(len(fields[name]) == len(c.position), f"{name} has {len(fields[name])} rows for {len(c.position)} nodes")


@rule("solves always from the last accepted state", "Session")
def check_accepted_state(bench):
    with prepared(bench) as c:
        for _ in range(2):
            first = c.solve()
            other = c.solve(factor=3.0)
            again = c.solve()
            for name in first:
                apart = max(np.abs(first[name] - other[name]).max(), TOLERANCE * np.abs(first[name]).max())
                difference = np.abs(again[name] - first[name]).max()
                require(difference <= 1e-3 * apart, f"{name} of the same step differs by {difference:.3g} when it is asked for again after "
                        "other loads: it remembers a trial that was not accepted")
            c.accept()


@rule("gives equal bits for equal requests in equal order", "Session")
def check_equal_bits(bench):
    found = []
    for _ in range(2):
        with prepared(bench) as c:
            found.append([])
            for part in (1.0, 0.5):
                found[-1] += [c.solve(), c.solve(2.0), c.solve(1.5, part)]
                c.accept()
    for k, (first, second) in enumerate(zip(*found)):
        same_bits(first, second, f"between two sessions, at their solve-step number {k + 1}")


@rule("tries a step again with half its duration", "Session")
def check_half_step(bench):
    with prepared(bench) as c:
        c.solve()
        half = c.solve(part=0.5)
        c.accept()
        c.solve()
    with prepared(bench) as c:
        direct = c.solve(part=0.5)
    for name in direct:
        difference = np.abs(half[name] - direct[name]).max()
        require(difference <= 1e-3 * max(np.abs(direct[name] - c.fields[name]).max(), TOLERANCE * np.abs(direct[name]).max()),
                f"{name} after half a step differs by {difference:.3g} when a whole one was tried before")


@rule("accepts steps and reports the same names for history.csv each time", "Session")
def check_accept(bench):
    with prepared(bench) as c:
        c.solve()
        first = c.accept()
        require(len(set(first)) == len(first), f"reports a name twice: {first}")
        require(all(map(is_name, first)), f"a name is not printable: {first}")
        c.solve()
        second = c.accept()
        require(first == second, f"reports {first} and then {second}")


@rule("answers a repeated number by the reply that it kept, and computes nothing", "Session")
def check_repeated(bench):
    with prepared(bench) as c:
        once = [c.solve()]
        c.accept()
        once.append(c.solve())
    with prepared(bench) as c:
        arrays, end = c.load(c.start + bench.step), c.start + bench.step
        c.n_solved = 1
        first = c.talk.ask_anything("solve_step", arrays, **c.interval())[1]
        again = c.talk.ask_anything("solve_step", arrays, number=c.talk.number, **c.interval())[1]
        require(first == again, "answers a repeated solve-step by other bytes")
        # Even if what it asks for is something else: the number counts.
        other = c.talk.ask_anything("accept_step", number=c.talk.number, step=1)[1]
        require(first == other, "serves a request whose number was answered already")
        c.last_end = end
        c.accept()
        c.talk.ask_anything("accept_step", number=c.talk.number, step=1)
        same_bits(once[1], c.solve(), "after requests that were repeated: they were served twice")


@rule("answers an old number by a Failure and goes on", "Session")
def check_old_number(bench):
    with prepared(bench) as c:
        expected = c.solve()
    with prepared(bench) as c:
        c.talk.expect_failure("an old number", c.talk.ask_anything("hello", number=1, protocol=1)[0], ["PEER"])
        try:
            same_bits(expected, c.solve(), "after an old number was refused")
        except Broken as fault:
            raise Broken(f"does not go on after an old number: {fault}") from None


@rule("answers a number that is too large by a Failure, takes it over and has failed", "Session")
def check_skipped_number(bench):
    with prepared(bench) as c:
        c.talk.number += 2
        reply, first = c.talk.ask_anything("solve_step", c.load(bench.step), number=c.talk.number, **c.interval())
        c.talk.expect_failure("a number that skips one", reply, ["PEER"])
        again = c.talk.ask_anything("solve_step", c.load(bench.step), number=c.talk.number, **c.interval())[1]
        require(first == again, "does not keep its refusal under that number")
        c.talk.expect_only_close("a number that skips one")


ALLOWED = {"connected": ["hello"], "greeted": ["open_scene"], "opened": ["solve_step"], "solved": ["solve_step", "accept_step"],
           "accepted": ["solve_step", "write_checkpoint"]}


def add_table_rule(state):
    @rule(f"refuses in state {state} all but {', '.join(ALLOWED[state])} and close", "Session")
    def check(bench):
        for body in REPLIES:
            if body in ALLOWED[state] or body == "close":
                continue
            with bench.talk() as c, tempfile.TemporaryDirectory() as folder:
                try:
                    c.bring_to(state)
                except Broken as fault:
                    raise NotReached(str(fault)) from None
                arrays, fields = c.request(body, folder)
                reply, _ = c.talk.ask_anything(body, arrays, **fields)
                c.talk.expect_failure(f"{body} in state {state}", reply)
                arrays, fields = c.request(ALLOWED[state][0], folder)
                reply, _ = c.talk.ask_anything(ALLOWED[state][0], arrays, **fields)
                c.talk.expect_failure(f"{ALLOWED[state][0]} after a refused {body}", reply)
                c.talk.expect_only_close(f"a refused {body}")


for _state in ALLOWED:
    add_table_rule(_state)


@rule("may be closed at once", "Session")
def check_early_close(bench):
    for state in ("connected", "greeted", "opened", "solved"):
        with bench.talk() as c:
            try:
                c.bring_to(state)
            except Broken as fault:
                raise NotReached(str(fault)) from None
            c.talk.ask("close", reason="the coupler gives up")
            code = c.program.end(END)
            require(code == 0, f"ends with code {code} when it is closed in state {state}")


@rule("writes a checkpoint and continues from it with equal bits", "Session")
def check_checkpoint(bench):
    with tempfile.TemporaryDirectory(prefix="couplet-check-") as folder:
        path = Path(folder) / "solver.checkpoint"
        with prepared(bench) as c:
            for _ in range(2):
                accepted = c.solve()
                c.accept()
            written, _ = c.talk.ask("write_checkpoint", path=str(path))
            require(path.is_file(), f"wrote no file of the very name it was given, {path.name}")
            require(written.bytes == path.stat().st_size, f"says that it wrote {written.bytes} bytes, the file has {path.stat().st_size}")
            then, end = c.solve(), c.start
        with prepared(bench, resume_from=str(path)) as c:
            require(abs(c.ready.time - end) < 1e-9 * bench.step + 1e-12 * end, f"resumes at t = {c.ready.time:g} s, the checkpoint was written at {end:g} s")
            for name in c.ready.offers:
                difference = np.abs(c.fields[name] - accepted[name]).max()
                require(difference <= TOLERANCE * np.abs(accepted[name]).max(), f"offers {name} that differs by {difference:.3g} from the accepted one after resuming")
            c.n_accepted = 2
            same_bits(then, c.solve(), "between a run that was resumed and one that was not")


@rule("answers by a Failure of kind FILE when a checkpoint cannot be written or read", "Session")
def check_bad_checkpoint(bench):
    with tempfile.TemporaryDirectory(prefix="couplet-check-") as folder:
        with prepared(bench) as c:
            c.solve()
            c.accept()
            reply, _ = c.talk.ask_anything("write_checkpoint", path=f"{folder}/no such folder/checkpoint")
            c.talk.expect_failure("a checkpoint in a folder that is not there", reply, ["FILE"])
            c.talk.expect_only_close("a checkpoint that cannot be written")
        torn = Path(folder) / "torn"
        torn.write_bytes(b"this is no checkpoint")
        for path, what in ((f"{folder}/nothing", "a checkpoint that is not there"), (str(torn), "a file that is no checkpoint")):
            with bench.talk(resume_from=path) as c:
                c.talk.ask("hello", protocol=1)
                fields, arrays = c.open_fields()
                reply, _ = c.talk.ask_anything("open_scene", arrays, **fields)
                c.talk.expect_failure(f"resuming from {what}", reply, ["FILE", "SCENE"])
                c.talk.expect_only_close(f"resuming from {what}")


@rule("answers what is not a request by a Failure with number 0", "Session")
def check_garbage(bench):
    for frames, what in (([b"\xff\xfe\xfd garbage"], "bytes that are no message"), ([b""], "an empty message"),
                         ([v1.Request(sequence=3).SerializeToString()], "a request that asks for nothing")):
        with prepared(bench) as c:
            c.talk.send(frames)
            reply, _ = c.talk.receive(what)
            c.talk.expect_failure(what, reply, ["PEER"])
            require(reply.sequence == 0, f"answers {what} by number {reply.sequence}")
            c.talk.expect_only_close(what)


def spoil(**values):
    return lambda request, frames: [setattr(request.array[0], name, value) for name, value in values.items()]


def without(name):
    return lambda request, frames: request.array[0].ClearField(name)


def reshape(*shape):
    def change(request, frames):
        request.array[0].ClearField("shape")
        request.array[0].shape.extend(shape)
    return change


def drop_array(request, frames):
    del request.array[0]
    del frames[1]


def flip_bit(request, frames):
    frames[1] = bytes([frames[1][0] ^ 1]) + frames[1][1:]


SPOILED = [
    ("an array with one bit that is wrong", flip_bit), ("an array without checksum", without("crc32c")),
    ("an array of no type", without("scalar_type")), ("an array of the wrong type", spoil(scalar_type=v1.ArrayHeader.INT64)),
    ("an array of a shape that its bytes do not fit", reshape(2, 3)), ("an array of a negative shape", reshape(-1, -3)),
    ("an array of an impossible size", reshape(2**61, 8)), ("a needed field that is missing", drop_array),
    ("an array that is announced and does not come", lambda request, frames: frames.pop()),
    ("an array that comes and was not announced", lambda request, frames: frames.append(b"12345678")),
    ("an array of the wrong name", spoil(name="colour"))]


@rule("refuses arrays that are damaged, misshapen or missing, and does not crash", "Messages")
def check_bad_arrays(bench):
    for what, change in SPOILED:
        with prepared(bench) as c:
            request = v1.Request(sequence=c.talk.number + 1)
            request.solve_step.MergeFrom(v1.SolveStep(**c.interval()))
            frames = [b""]
            for name, array in c.load(bench.step).items():
                frames.append(array.astype("<f8").tobytes())
                request.array.add(name=name, scalar_type=v1.ArrayHeader.FLOAT64, shape=array.shape, crc32c=crc32c(frames[-1]))
            change(request, frames)
            frames[0] = request.SerializeToString()
            c.talk.number += 1
            c.talk.send(frames)
            reply, _ = c.talk.receive(what)
            c.talk.expect_failure(what, reply, ["PEER"])
            c.talk.expect_only_close(what)
    with prepared(bench) as c:
        longer = {name: np.vstack([array, array[:1]]) for name, array in c.load(bench.step).items()}
        c.talk.expect_failure("a field with a row too many", c.talk.ask_anything("solve_step", longer, **c.interval())[0], ["PEER"])
        c.talk.expect_only_close("a field with a row too many")


@rule("serves the first program that speaks to it and nobody else", "Finding and losing each other")
def check_second_program(bench):
    with prepared(bench) as c:
        expected = c.solve()
    with prepared(bench) as c:
        with Talk(c.program, c.talk.socket.getsockopt_string(zmq.LAST_ENDPOINT)) as intruder:
            intruder.send([v1.Request(sequence=c.talk.number + 1, close=v1.Close(reason="intruder")).SerializeToString()])
            require(not intruder.socket.poll(500), "answers a second program")
            same_bits(expected, c.solve(), "when a second program speaks in between")


@rule("answers close with seconds and peak_memory_bytes, and ends with code 0", "Session")
def check_close(bench):
    with prepared(bench) as c:
        c.solve()
        c.accept()
        closed, _ = c.talk.ask("close", reason="finished")
        told = {quantity.name: quantity.value for quantity in closed.quantity}
        for name in ("seconds", "peak_memory_bytes"):
            require(name in told, f"does not tell {name}")
            require(np.isfinite(told[name]) and told[name] >= 0, f"tells {told[name]} {name}")
        code = c.program.end(END)
        require(code == 0, f"ends with code {code}")


@rule("ends with code 4 when the coupler has gone", "Finding and losing each other")
def check_gone(bench):
    with prepared(bench) as c:
        c.solve()
        c.talk.__exit__()
        code = c.program.end(HEARTBEAT + END)
        require(code == 4, f"ends with code {code}")


FROZEN_COUPLER = """
import os, signal, sys, zmq
socket = zmq.Context().socket(zmq.DEALER)
socket.connect(sys.argv[1])
socket.send(bytes.fromhex(sys.argv[2]))
socket.recv_multipart()
os.kill(os.getpid(), signal.SIGSTOP)
"""


@rule("ends with code 4 when the coupler is frozen", "Finding and losing each other")
def check_frozen(bench):
    with Program(bench) as program:
        hello = v1.Request(sequence=1, hello=v1.Hello(protocol=1)).SerializeToString()
        try:
            address = program.address()
        except Broken as fault:
            raise NotReached(str(fault)) from None
        coupler = subprocess.Popen([sys.executable, "-c", FROZEN_COUPLER, address, hello.hex()])
        try:
            deadline = time.monotonic() + START
            while Path(f"/proc/{coupler.pid}/stat").read_text().rpartition(")")[2].split()[0] != "T":
                require(time.monotonic() < deadline, "does not answer hello")
                time.sleep(0.05)
            code = program.end(HEARTBEAT + END)
            require(code == 4, f"ends with code {code}")
        finally:
            coupler.kill()
            coupler.wait()


def open_peer(program, scene, scene_folder):
    """Names and arrays of the surface of solid-server for a scene; None when the scene has no solid."""
    if not program or not scene.HasField("solid"):
        return None
    with Conversation(Bench([program], scene, scene_folder, [], None)) as c:
        c.open()
        return c.ready.surface, {name: c.fields[name] for name in SURFACE_TYPES}


def check(bench, patterns=(), out=sys.stdout):
    """Looks at every rule, or at those whose sentence holds one of the patterns. Returns how many are broken."""
    n_broken = n_kept = 0
    for sentence, section, look in RULES:
        if patterns and not any(pattern in sentence for pattern in patterns):
            continue
        try:
            look(bench)
            n_kept += 1
            line = f"ok     {sentence}"
        except Broken as fault:
            n_broken += 1
            line = f'wrong  {sentence}: {fault} (proto/README.md, "{section}")'
        except NotReached as fault:
            n_broken += 1
            line = f'wrong  {sentence}: not reached, because it {fault} (proto/README.md, "{section}")'
        print(line, file=out, flush=True)
    print(f"{n_broken} of {n_broken + n_kept} rules are broken" if n_broken else f"all {n_kept} rules are kept", file=out, flush=True)
    return n_broken


def main():
    parser = argparse.ArgumentParser(description=__doc__, prog="couplet check-participant")
    parser.add_argument("--scene", type=argparse.FileType(), required=True, help="resolved scene that is opened; -: from standard input")
    parser.add_argument("--scene-file", help="where that scene comes from: the program is told, and relative paths start there")
    parser.add_argument("--solid-server", help="whose surface a flow is given")
    parser.add_argument("--rule", action="append", default=[], help="only rules that hold this text")
    parser.add_argument("command", nargs="+", metavar="WORD", help="the program and its own options")
    options = parser.parse_args()
    for text in options.rule:
        if not any(text in sentence for sentence, _, _ in RULES):
            print(f"couplet: check-participant: --rule {text}: no rule holds this text; without --rule all are listed", file=sys.stderr)
            return COMMAND_LINE_WRONG
    scene = text_format.Parse(options.scene.read(), v1.OpenScene().scene)
    scene_file = Path(options.scene_file or options.scene.name).absolute()
    try:
        peer = open_peer(options.solid_server, scene, str(scene_file.parent))
        bench = Bench(options.command, scene, str(scene_file.parent), [str(scene_file)], peer)
        return PARTICIPANT_WRONG if check(bench, options.rule) else DONE
    except OSError as error:
        print(f"couplet: check-participant: {options.command[0]}: {error.strerror}; write the program as a shell would start it", file=sys.stderr)
        return COMMAND_LINE_WRONG
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
