"""Take part in a run of Couplet: derive from Participant, then call serve(YourClass). README.md beside this file shows how.

Sockets, sequence numbers, checksums, the table of states and lost couplers are done here; a solver sees numpy arrays only."""

import argparse
import os
import pathlib
import resource
import signal
import sys
import threading
import time
import traceback
from dataclasses import dataclass, field

import numpy as np
import zmq
import zmq.utils.z85
from crc32c import crc32c
from zmq.utils.monitor import recv_monitor_message

from couplet_messages import exchange_pb2 as v1

PROTOCOL = 1
EXIT_CODES = {"SCENE": 2, "NUMERICS": 3, "PEER": 4, "FILE": 5, "BUG": 70}
UNITS = {"force": "N", "displacement": "m", "velocity": "m/s"}
SURFACE_ARRAYS = ("node_position", "face_offset", "face_node", "face_region")
# The state after a request that succeeds; close is always possible (proto/README.md, "Session").
NEXT_STATE = {("connected", "hello"): "greeted", ("greeted", "open_scene"): "opened", ("opened", "solve_step"): "solved",
              ("solved", "solve_step"): "solved", ("solved", "accept_step"): "accepted",
              ("accepted", "solve_step"): "solved", ("accepted", "write_checkpoint"): "accepted"}
REPLY = {"hello": "welcome", "open_scene": "scene_ready", "solve_step": "step_solved", "accept_step": "step_accepted",
         "write_checkpoint": "checkpoint_written", "close": "closed"}


class Failure(Exception):
    """What ends a run, or with kind NUMERICS in solve_step only this step, which is then tried again with half its duration.

    kind: SCENE, NUMERICS, PEER, FILE or BUG; it becomes the exit code of the run. sentence: what happened, with the value that
    was found. where: field, file, element or time. advice: what to do next."""

    def __init__(self, kind, sentence, where="", advice=""):
        super().__init__((f"{where}: " if where else "") + sentence + (f"; {advice}" if advice else ""))
        self.kind, self.sentence, self.where, self.advice = kind, sentence, where, advice


@dataclass
class Surface:
    """Nodes and faces of the interface. The order of the nodes is that of all fields of its participant."""

    node_position: np.ndarray  # (n_nodes, 3) reference position [m]
    faces: list = field(default_factory=list)  # nodes of each face, corners then midsides; its normal points into the fluid
    face_region: list = field(default_factory=list)  # (n_faces) index into `region`; empty: all 0
    region: list = field(default_factory=lambda: ["surface"])  # names
    marker: dict = field(default_factory=dict)  # name: node


@dataclass
class OpenRequest:
    scene: object  # message couplet.v1.Scene, complete and checked
    scene_folder: str  # relative paths in the scene start here
    run_folder: str  # results go to run_folder/results; empty: write nothing
    resume_from: str  # checkpoint to continue from; empty: start at t = 0
    surface: Surface | None  # of the other participant, for the one that is opened last: the flow


@dataclass
class Opened:
    surface: Surface
    needs: list  # names of the fields that solve_step is given: a solid needs force
    fields: dict  # name: (n_nodes, 3) of the accepted state; solve_step must return the same names
    time: float = 0.0  # of the accepted state [s]


@dataclass
class Step:
    step: int  # 1, 2, 3, ...
    iteration: int  # 1, 2, 3, ...
    start: float  # [s]
    duration: float  # [s]


class Participant:
    """A solver. SI units. Any method may raise Failure; a MemoryError is a NUMERICS, an OSError a FILE, the rest a BUG."""

    @staticmethod
    def add_options(parser):
        """Options of the command line, for argparse; they stand before `serve`."""

    def __init__(self, options):
        """options: what argparse has found."""

    def open(self, request):
        """Builds the model and returns Opened. With request.resume_from a ValueError, KeyError or EOFError means that this
        checkpoint cannot be read."""
        raise NotImplementedError

    def solve_step(self, step, fields):
        """Solves from step.start over step.duration, always from the last accepted state, given the needed fields at the end
        of the step, {name: (n_nodes, 3)}. Returns the offered fields at the end of the step and keeps the result aside."""
        raise NotImplementedError

    def accept_step(self, step):
        """Makes the last result the accepted state. Returns {name: value or (value, unit)} for history.csv, always the same
        names, or None. step: its number."""
        raise NotImplementedError

    def write_checkpoint(self, path):
        """Writes the accepted state to that very path, so that open with resume_from continues with equal bits."""
        raise NotImplementedError

    def close(self, reason):
        """Completes files. Also called when the coupler is lost."""


def as_failure(error):
    if isinstance(error, Failure):
        return error
    if isinstance(error, MemoryError):
        return Failure("NUMERICS", "out of memory", advice="use a coarser mesh")
    if isinstance(error, OSError):
        return Failure("FILE", error.strerror or str(error), str(error.filename or ""), "check the path and its permissions")
    traceback.print_exception(error)
    return Failure("BUG", f"{type(error).__name__}: {error}", advice="mend that program; log.txt holds the place")


def pack(reply, arrays):
    """The frames of a reply with its arrays, {name: array}."""
    frames = []
    for name, array in arrays.items():
        is_index = name in SURFACE_ARRAYS[1:]
        array = np.ascontiguousarray(array, "<i8" if is_index else "<f8")
        frames.append(array.tobytes())
        reply.array.add(name=name, scalar_type=v1.ArrayHeader.INT64 if is_index else v1.ArrayHeader.FLOAT64, shape=array.shape,
                        unit=UNITS.get(name, "m" if name == "node_position" else ""), crc32c=crc32c(frames[-1]))
    return [reply.SerializeToString(), *frames]


def unpack(request, frames):
    """The arrays of a request, {name: array}. Raises Failure for one that is not what its header says."""
    arrays = {}
    for header, frame in zip(request.array, frames[1:]):
        def refuse(what):
            raise Failure("PEER", f"array '{header.name}' {what}", request.WhichOneof("body"), "mend the program that sends it")
        is_index, shape = header.name in SURFACE_ARRAYS[1:], tuple(header.shape)
        if header.name in arrays or not header.name:
            refuse("comes twice or has no name")
        if header.scalar_type != (v1.ArrayHeader.INT64 if is_index else v1.ArrayHeader.FLOAT64):
            refuse("has the wrong type")
        if len(shape) != (1 if is_index else 2) or min(shape) < 0 or 8 * int(np.prod(shape, dtype=object)) != len(frame):
            refuse(f"of shape {shape} comes with {len(frame)} bytes")
        if not header.HasField("crc32c") or crc32c(frame) != header.crc32c:
            refuse("was damaged on its way, or comes without its checksum")
        arrays[header.name] = np.frombuffer(frame, "<i8" if is_index else "<f8").reshape(shape).copy()
    return arrays


def surface_of(arrays, names):
    """The surface among the arrays, or None."""
    if "node_position" not in arrays:
        return None
    offset = arrays.get("face_offset", np.zeros(1, int))
    faces = [arrays["face_node"][first:last] for first, last in zip(offset, offset[1:])]
    return Surface(arrays["node_position"], faces, arrays.get("face_region", []), list(names.region),
                   {marker.name: marker.node for marker in names.marker})


def arrays_of(surface):
    """The four arrays of a surface."""
    sizes = [len(face) for face in surface.faces]
    region = surface.face_region if len(surface.face_region) else np.zeros(len(sizes))
    return {"node_position": surface.node_position, "face_offset": np.cumsum([0, *sizes]),
            "face_node": np.concatenate([*map(np.ravel, surface.faces), []]), "face_region": region}


class Session:
    """Answers requests, each of them a list of frames, by calls to a participant."""

    def __init__(self, participant, program):
        self.participant, self.program = participant, program
        self.state, self.sequence, self.kept = "connected", 0, []
        self.failure = self.step_failure = None  # the first; that of the last solve
        self.is_open = False

    def answer(self, frames):
        """The frames of the reply."""
        try:
            request = v1.Request.FromString(frames[0])
            if request.WhichOneof("body") is None or len(request.array) != len(frames) - 1:
                raise ValueError
        except Exception:
            return self.fail(0, Failure("PEER", "a message is not a request", "session", "check who speaks to this address"))
        number = request.sequence
        if number == self.sequence > 0:
            return self.kept
        if number <= self.sequence:
            late = Failure("PEER", f"request {number} comes after request {self.sequence} was answered", "session")
            return self.describe(number, late)
        self.kept, self.sequence = self.serve(request, frames), number
        return self.kept

    def serve(self, request, frames):
        body = request.WhichOneof("body")
        try:
            if request.sequence != self.sequence + 1:
                raise Failure("PEER", f"request {request.sequence} follows request {self.sequence}", "session", "number them 1, 2, 3, ...")
            next_state = "closed" if body == "close" else NEXT_STATE.get((self.state, body))
            if next_state is None:
                raise Failure("PEER", f"{body} is not allowed in state {self.state}", "session", "see the table of states in proto/README.md")
            reply = v1.Reply(sequence=request.sequence)
            getattr(reply, REPLY[body]).SetInParent()  # it may have nothing to say
            arrays = getattr(self, body)(getattr(request, body), unpack(request, frames), reply) or {}
            self.state = next_state
            return pack(reply, arrays)
        except Exception as error:
            failure = as_failure(error)
            if body == "solve_step" and failure.kind == "NUMERICS":
                self.state, self.step_failure = "opened", failure
                return self.describe(request.sequence, failure)
            return self.fail(request.sequence, failure)

    def fail(self, number, failure):
        self.state, self.failure = "failed", self.failure or failure
        return self.describe(number, failure)

    @staticmethod
    def describe(number, failure):
        told = v1.Failure(kind=v1.Failure.Kind.Value(failure.kind), sentence=failure.sentence, where=failure.where, advice=failure.advice)
        return [v1.Reply(sequence=number, failure=told).SerializeToString()]

    def hello(self, request, arrays, reply):
        if request.protocol != PROTOCOL:
            raise Failure("PEER", f"the coupler (commit {request.commit}) speaks protocol {request.protocol}, {self.program} speaks {PROTOCOL}",
                          "hello", "build all programs from the same sources")
        reply.welcome.protocol, reply.welcome.program = PROTOCOL, self.program
        reply.welcome.ranks = reply.welcome.threads = 1

    def open_scene(self, request, arrays, reply):
        self.is_open = True  # one that fails in open is closed as well
        surface = surface_of(arrays, request.surface)
        try:
            opened = self.participant.open(OpenRequest(request.scene, request.scene_folder, request.run_folder, request.resume_from, surface))
        except (ValueError, KeyError, EOFError) as error:
            if not request.resume_from:
                raise
            raise Failure("FILE", f"cannot be continued from ({type(error).__name__}: {error})", request.resume_from, "resume from another checkpoint") from error
        self.needs, self.offers, self.n_nodes = list(opened.needs), list(opened.fields), len(opened.surface.node_position)
        reply.scene_ready.time = opened.time
        reply.scene_ready.needs.extend(self.needs)
        reply.scene_ready.offers.extend(self.offers)
        reply.scene_ready.surface.region.extend(opened.surface.region)
        for name, node in opened.surface.marker.items():
            reply.scene_ready.surface.marker.add(name=name, node=node)
        return {**arrays_of(opened.surface), **self.checked(opened.fields)}

    def solve_step(self, request, arrays, reply):
        for name in self.needs:
            if name not in arrays or len(arrays[name]) != self.n_nodes:
                raise Failure("PEER", f"field {name} is missing or has not one row for each of {self.n_nodes} nodes", "solve-step")
        started = time.perf_counter()
        solved = self.participant.solve_step(Step(request.step, request.iteration, request.start, request.duration), arrays)
        reply.step_solved.seconds = time.perf_counter() - started
        self.step_failure = None
        return self.checked(solved, f"t = {request.start + request.duration:g} s")

    def checked(self, fields, when="open-scene"):
        if set(fields) != set(self.offers):
            raise ValueError(f"{self.program} offers {self.offers} but returns {list(fields)}")
        for name, array in fields.items():
            if np.ndim(array) != 2 or len(array) != self.n_nodes:
                raise ValueError(f"field {name} has the shape {np.shape(array)} for {self.n_nodes} nodes")
            if not np.isfinite(array).all():
                raise Failure("NUMERICS", f"field {name} holds what is not a number", when, "use a smaller step")
        return fields

    def accept_step(self, request, arrays, reply):
        for name, told in (self.participant.accept_step(request.step) or {}).items():
            value, unit = told if isinstance(told, tuple) else (told, "1")
            reply.step_accepted.quantity.add(name=name, value=value, unit=unit)

    def write_checkpoint(self, request, arrays, reply):
        self.participant.write_checkpoint(request.path)
        reply.checkpoint_written.bytes = os.path.getsize(request.path)

    def close(self, request, arrays, reply):
        self.close_participant(request.reason)
        memory = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        reply.closed.quantity.add(name="seconds", value=time.process_time(), unit="s")
        reply.closed.quantity.add(name="peak_memory_bytes", value=memory, unit="1")

    def close_participant(self, reason):
        if self.is_open:
            self.is_open = False
            self.participant.close(reason)


def read_key(path):
    try:
        key = path.read_bytes().strip()
        zmq.utils.z85.decode(key)
    except (OSError, ValueError) as error:
        raise Failure("FILE", f"cannot read this key: {error}", str(path), "make keys with `couplet keys DIR`") from None
    if len(key) != 40:
        raise Failure("FILE", "holds no key: one is 40 printable characters", str(path), "make keys with `couplet keys DIR`")
    return key


class Gate:
    """Encrypts a server's link and lets in the coupler alone, whose public key lies beside the server's secret key."""

    def __init__(self, server, key):
        path = pathlib.Path(key)
        secret, self.coupler = read_key(path), zmq.utils.z85.decode(read_key(path.with_name("coupler.pub")))
        if path.stat().st_mode & 0o077:
            raise Failure("FILE", "other users may use this secret key", str(path), f"chmod 600 {path}")
        server.curve_secretkey, server.curve_publickey, server.curve_server = secret, zmq.curve_public(secret), True
        server.zap_domain = b"couplet"
        self.requests = server.context.socket(zmq.REP)  # ZeroMQ asks here who may come in: ZAP, https://rfc.zeromq.org/spec/27/
        self.requests.bind("inproc://zeromq.zap.01")
        threading.Thread(target=self.answer_all, daemon=True).start()

    def answer_all(self):
        while True:
            frames = self.requests.recv_multipart()
            is_known = len(frames) > 6 and frames[5] == b"CURVE" and frames[6] == self.coupler
            status = [b"200", b"OK"] if is_known else [b"400", b"unknown key"]
            if not is_known:
                print("a program with another key, or none, was turned away", file=sys.stderr, flush=True)
            self.requests.send_multipart([b"1.0", frames[1] if len(frames) > 1 else b"", *status, b"", b""])


class Channel:
    """A ROUTER socket that serves the first program that speaks to it, and notices when that one is lost."""

    def __init__(self, options):
        self.heartbeat, self.deadline = options.heartbeat, time.monotonic() + options.wait
        self.socket = zmq.Context.instance().socket(zmq.ROUTER)
        quarter = max(1, int(250 * options.heartbeat))  # [ms] a silent peer is found after three quarters of the time
        for option, value in ((zmq.HEARTBEAT_IVL, quarter), (zmq.HEARTBEAT_TIMEOUT, 2 * quarter), (zmq.HEARTBEAT_TTL, 4 * quarter),
                              (zmq.ROUTER_MANDATORY, 1), (zmq.LINGER, 2000), (zmq.SNDTIMEO, 2 * 4 * quarter)):
            self.socket.setsockopt(option, value)
        self.gate = Gate(self.socket, options.key) if options.key else None
        self.monitor = self.socket.get_monitor_socket(zmq.EVENT_DISCONNECTED)
        self.peer = self.connection = None
        self.is_lost = False
        try:
            self.socket.bind(options.listen)
        except zmq.ZMQError as error:
            raise Failure("PEER", f"cannot bind: {error.strerror}", options.listen, "choose a free address, for example tcp://127.0.0.1:*")
        self.address = self.socket.getsockopt_string(zmq.LAST_ENDPOINT)

    def receive(self):
        """The frames of the next request, or None after a moment. Raises Failure when the coupler is lost."""
        while self.socket.poll(100):
            sender, *frames = self.socket.recv_multipart(copy=False)
            if self.peer is None and frames:
                self.peer, self.connection = sender.bytes, frames[0].get(zmq.SRCFD)
            if sender.bytes == self.peer and frames:
                return [frame.bytes for frame in frames]
        while self.monitor.poll(0):
            event = recv_monitor_message(self.monitor)
            self.is_lost |= self.peer is not None and event["value"] == self.connection
        if self.is_lost:
            raise Failure("PEER", "the coupler is lost: it ended, was killed, or gave no sign of life for "
                          f"{self.heartbeat:g} s", self.address, "its own last line says why")
        if self.peer is None and time.monotonic() > self.deadline:
            raise Failure("PEER", "no coupler has come", self.address, "start it with this address, or wait longer with --wait")
        return None

    def send(self, frames):
        try:
            self.socket.send_multipart([self.peer, *frames])
        except zmq.ZMQError:
            raise Failure("PEER", "the coupler is lost", self.address, "its own last line says why") from None


class CommandLine(argparse.ArgumentParser):
    def error(self, message):
        print(f"{self.prog}: {message}; --help says what is possible", file=sys.stderr)
        sys.exit(2)


def read_command_line(kind, words):
    parser = CommandLine(prog=os.path.basename(sys.argv[0]), description=kind.__doc__)
    kind.add_options(parser)
    serving = parser.add_subparsers(required=True, metavar="serve", dest="verb").add_parser("serve", help="serve one session of a coupler, then end")
    serving.add_argument("scene", nargs="?", help="scene of the run; the coupler sends it, so it is not read here")
    serving.add_argument("--listen", default="tcp://127.0.0.1:*", metavar="ADDRESS", help="bind there: tcp://127.0.0.1:*, ipc://PATH, ipc://@NAME")
    serving.add_argument("--heartbeat", type=float, default=8, help="seconds without sign of life after which the coupler is lost")
    serving.add_argument("--wait", type=float, default=60, help="seconds to wait for the coupler to come")
    serving.add_argument("--key", metavar="FILE", help="secret key of the server whose place it takes (couplet keys), beside coupler.pub: encrypt, and "
                         "obey the coupler alone; must be given where other machines can reach the address")
    options = parser.parse_args(words)
    host = options.listen.removeprefix("tcp://").rpartition(":")[0]
    is_local = options.listen.startswith("ipc://") or host in ("localhost", "[::1]", "lo") or (host.startswith("127.") and host.replace(".", "").isdigit())
    if not is_local and not options.key:
        parser.error(f"--listen {options.listen} leaves this machine, and without keys anybody there can read and send what he likes; "
                     "make keys with `couplet keys DIR` and give --key, or stay on this machine: tcp://127.0.0.1:*")
    return options


def serve_one_session(kind, options, program):
    stop = []
    for number in (signal.SIGTERM, signal.SIGINT):  # a second one ends at once
        signal.signal(number, lambda number, _: (stop.append(number), signal.signal(number, signal.SIG_DFL)))
    session = Session(kind(options), program)
    channel = Channel(options)
    print("listening", channel.address, flush=True)
    try:
        while session.state != "closed":
            frames = channel.receive()
            if frames:
                channel.send(session.answer(frames))
            if stop and session.state != "closed":
                raise Failure("PEER", "asked to end by a signal", advice="results are complete up to the last step")
    except Failure as end:
        session.close_participant(str(end))
        raise session.failure or end
    if session.failure or session.step_failure:
        raise session.failure or session.step_failure


def serve(kind, words=None):
    """Runs the command line `[OPTIONS] serve --listen ADDRESS [SCENE]` for a class derived from Participant, and ends the
    program: 0, or the exit code of the failure with one last line on standard error. words: instead of sys.argv."""
    program = os.path.basename(sys.argv[0])
    options = read_command_line(kind, words)
    try:
        serve_one_session(kind, options, program)
    except Exception as error:
        failure = as_failure(error)
        print(f"{program}: {failure}", file=sys.stderr, flush=True)
        sys.exit(EXIT_CODES[failure.kind])
    sys.exit(0)
