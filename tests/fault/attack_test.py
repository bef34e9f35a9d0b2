#!/usr/bin/python3
"""What strangers can do to a run, and what a peer that means no good can do to a server: nothing is obeyed, nothing falls over."""

import os
import re
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import zmq

from run_under_test import SCENE, SETTINGS, TOP, Run, interrupt

COUPLET = os.environ["COUPLET"]
PROGRAMS = Path(COUPLET).parent
SCHEMA = tempfile.TemporaryDirectory(prefix="couplet schema ")
subprocess.run(["protoc", "-I", TOP / "proto", "--python_out", SCHEMA.name, *(TOP / "proto").glob("couplet/v1/*.proto")], check=True)
sys.path.insert(0, SCHEMA.name)
from couplet.v1 import exchange_pb2 as v1  # noqa: E402

SOON = 20  # [s] for a busy machine; usually below 1
MEMORY = 400 * 1024  # [kB] that a server of this scene never needs, however large the message is that it is promised


def host_and_port(address):
    host, _, port = address.removeprefix("tcp://").rpartition(":")
    return host, int(port)


def raw(address):
    return socket.create_connection(host_and_port(address), timeout=SOON)


def greeting(mechanism):
    """The first 64 bytes of ZMTP 3.1."""
    return b"\xff" + bytes(8) + b"\x7f" + b"\x03\x01" + mechanism.ljust(20, b"\0") + bytes(32)


def knock(address, configure=lambda link: None, frames=(b"obey me",)):
    """A ZeroMQ client says something and is not answered."""
    with zmq.Context() as context, context.socket(zmq.DEALER) as link:
        link.linger = 0
        configure(link)
        link.connect(address)
        link.send_multipart(list(frames))
        assert not link.poll(300), f"{address} has answered a stranger: {link.recv_multipart()}"


def with_plain_password(link):
    link.plain_username, link.plain_password = b"coupler", b"please"


def with_another_key(server_key):
    def configure(link):
        link.curve_publickey, link.curve_secretkey = zmq.curve_keypair()
        link.curve_serverkey = server_key
    return configure


class Relay:
    """Passes bytes between a coupler and a server, and keeps those of the coupler."""

    def __init__(self, server, change=lambda data: data):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.address = "tcp://127.0.0.1:%d" % self.listener.getsockname()[1]
        self.server, self.change, self.kept = server, change, b""
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        coupler, _ = self.listener.accept()
        server = raw(self.server)
        threading.Thread(target=self.pass_on, args=(server, coupler, False), daemon=True).start()
        self.pass_on(coupler, server, True)

    def pass_on(self, source, sink, is_coupler):
        try:
            while data := source.recv(1 << 16):
                if is_coupler:
                    data = self.change(data)
                    self.kept += data
                sink.sendall(data)
        except OSError:
            pass
        finally:
            sink.close()

    def close(self):
        self.listener.close()


class Keys(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="couplet keys ")
        cls.addClassCleanup(folder.cleanup)
        cls.keys = Path(folder.name) / "keys"
        subprocess.run([COUPLET, "keys", cls.keys], check=True, capture_output=True)


class StrangerTest(Keys):
    """A run across tcp with keys, and somebody else who reaches its addresses."""

    SETTINGS = ["coupling.listen=tcp://127.0.0.1:*"]

    def attack(self, stranger, lines):
        """Once in the midst of a run; `lines` is what the log must say of it, None where ZeroMQ itself drops the connection in silence."""
        run = Run(COUPLET, "--keys", str(self.keys), settings=self.SETTINGS)
        self.addCleanup(run.close)
        run.wait_for_steps(10)
        addresses = re.findall(r"listening (tcp://\S+)", (run.out / "log.txt").read_text())
        self.assertEqual(len(addresses), 2)
        for address in addresses:
            stranger(address)
        run.wait_for_steps(run.n_rows() + 10)
        interrupt(run)
        code, errors = run.end(60)
        self.assertEqual(code, 0, errors)
        undisturbed = Run(COUPLET, "--steps", str(run.n_rows()))
        self.addCleanup(undisturbed.close)
        self.assertEqual(undisturbed.end(600)[0], 0)
        self.assertNotIn("restarts", run.summary())
        self.assertEqual((run.out / "history.csv").read_bytes(), (undisturbed.out / "history.csv").read_bytes())
        said = re.findall(r"tcp://\S+: a program that .*", (run.out / "log.txt").read_text())
        if lines is not None:
            self.assertTrue(said)
            self.assertLessEqual(len(said), 2 * lines, said)

    def test_another_key(self):
        def stranger(address):
            for name in ("flow-server", "solid-server"):  # whichever it is, the stranger knows its public key
                knock(address, with_another_key((self.keys / f"{name}.pub").read_bytes().strip()))
        self.attack(stranger, 20)

    def test_no_key(self):
        self.attack(knock, 20)

    def test_a_password_instead_of_a_key(self):
        self.attack(lambda address: knock(address, with_plain_password), 20)

    def test_another_protocol(self):
        def stranger(address):
            for words in (b"GET / HTTP/1.1\r\n\r\n", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", os.urandom(4096)):
                with raw(address) as link:
                    link.sendall(words)
        self.attack(stranger, None)

    def test_half_a_greeting_and_silence(self):
        held = []

        def stranger(address):
            for _ in range(50):
                link = raw(address)
                link.sendall(greeting(b"CURVE")[:40])
                held.append(link)
        self.attack(stranger, None)
        for link in held:
            link.close()

    def test_a_handshake_of_noise(self):
        def stranger(address):
            with raw(address) as link:
                link.sendall(greeting(b"CURVE") + b"\x04" + bytes([200]) + b"\x05HELLO" + os.urandom(194))
        self.attack(stranger, None)

    def test_what_was_recorded(self):
        """The bytes of a real session, sent once more while it goes on and after it: the server has new keys for each connection."""
        with tempfile.TemporaryDirectory() as folder:
            servers, relays, out = [], [], Path(folder) / "run"
            common = [word for setting in SETTINGS for word in ("--set", setting)]
            try:
                for name in ("flow", "solid"):
                    server = subprocess.Popen([PROGRAMS / f"{name}-server", "serve", SCENE, "--keys", self.keys, *common],
                                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
                    servers.append(server)
                    relays.append(Relay(server.stdout.readline().split()[1]))
                coupler = subprocess.Popen([PROGRAMS / "coupler", "run", SCENE, "--flow", relays[0].address, "--solid", relays[1].address,
                                            "--out", out, "--keys", self.keys, "--steps", "60", "--quiet", *common])
                deadline = time.monotonic() + SOON
                while not (out / "history.csv").exists() or (out / "history.csv").read_text().count("\n") < 10:
                    self.assertLess(time.monotonic(), deadline)
                    time.sleep(0.01)
                for relay in relays:
                    with raw(relay.server) as link:
                        link.sendall(relay.kept)
                        link.settimeout(0.3)
                        answer = b""
                        try:
                            while data := link.recv(1 << 16):
                                answer += data
                        except OSError:
                            pass
                    # A greeting (64 bytes) and WELCOME (170) at most: nothing that was said in the session.
                    self.assertLess(len(answer), 300)
                self.assertEqual(coupler.wait(120), 0)
                self.assertEqual([server.wait(SOON) for server in servers], [0, 0])
                self.assertEqual((out / "history.csv").read_text().count("\n"), 61)
            finally:
                for process in servers:
                    process.kill()
                    process.communicate()
                for relay in relays:
                    relay.close()


class PeerTest(unittest.TestCase):
    """The first one that speaks to a server on this machine is its peer; whatever it says, the server refuses it in words."""

    def setUp(self):
        self.server = subprocess.Popen([PROGRAMS / "solid-server", "serve", SCENE, "--wait", str(SOON)], stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, text=True)
        self.address = self.server.stdout.readline().split()[1]
        self.context = zmq.Context()
        self.link = self.context.socket(zmq.DEALER)
        self.link.linger = 0
        self.link.connect(self.address)

    def tearDown(self):
        self.link.close()
        self.context.term()
        if self.server.poll() is None:
            self.server.kill()
        self.server.communicate()

    def say(self, *frames):
        self.link.send_multipart([frame if isinstance(frame, bytes) else frame.SerializeToString() for frame in frames])

    def answer(self):
        self.assertTrue(self.link.poll(1000 * SOON), "no answer")
        return v1.Reply.FromString(self.link.recv_multipart()[0])

    def ask(self, *frames):
        self.say(*frames)
        return self.answer()

    def expect_refusal(self, reply):
        self.assertEqual(reply.WhichOneof("body"), "failure", reply)
        self.assertTrue(reply.failure.sentence)

    def expect_good_order(self, codes=(2, 4)):
        """It did not fall over, took no memory for promises, and ends with one line when its peer goes."""
        status = Path(f"/proc/{self.server.pid}/status").read_text()
        peak = int(re.search(r"VmHWM:\s+(\d+)", status).group(1)) if "VmHWM" in status else 0
        self.assertLess(peak, MEMORY)
        self.link.close()
        _, errors = self.server.communicate(timeout=SOON)
        self.assertIn(self.server.returncode, codes, errors)
        self.assertEqual(len(errors.strip().splitlines()), 1, errors)
        for word in ("terminate", "what()", "Assertion", "bug"):
            self.assertNotIn(word, errors)

    def hello(self, sequence=1, protocol=1):
        return v1.Request(sequence=sequence, hello=v1.Hello(protocol=protocol, run="attack"))

    def test_garbage(self):
        self.expect_refusal(self.ask(os.urandom(300)))
        self.expect_good_order()

    def test_nothing_in_a_frame(self):
        self.expect_refusal(self.ask(b""))
        self.expect_good_order()

    def test_half_a_request(self):
        self.expect_refusal(self.ask(self.hello().SerializeToString()[:-3]))
        self.expect_good_order()

    def test_another_version(self):
        self.expect_refusal(self.ask(self.hello(protocol=2)))
        self.expect_good_order()

    def test_a_number_that_was_left_out(self):
        self.assertEqual(self.ask(self.hello()).WhichOneof("body"), "welcome")
        self.expect_refusal(self.ask(v1.Request(sequence=9, accept_step=v1.AcceptStep(step=1))))
        self.expect_good_order()

    def test_an_old_number(self):
        self.assertEqual(self.ask(self.hello()).WhichOneof("body"), "welcome")
        self.expect_refusal(self.ask(self.hello(sequence=0)))
        self.assertEqual(self.ask(self.hello()).WhichOneof("body"), "welcome")  # the same again: the kept reply
        self.expect_good_order()

    def test_a_request_at_the_wrong_time(self):
        self.assertEqual(self.ask(self.hello()).WhichOneof("body"), "welcome")
        self.expect_refusal(self.ask(v1.Request(sequence=2, solve_step=v1.SolveStep(step=1, iteration=1, start=0, duration=1))))
        self.expect_good_order()

    def test_absurd_shapes(self):
        self.assertEqual(self.ask(self.hello()).WhichOneof("body"), "welcome")
        sequence = 2
        for shape in ([2**62, 3], [-1, 3], [0, 0], [2**31, 2**31, 2**31], [], [1] * 1000, [5, 3]):
            request = v1.Request(sequence=sequence, solve_step=v1.SolveStep(step=1, iteration=1, start=0, duration=1))
            request.array.add(name="force", scalar_type=v1.ArrayHeader.FLOAT64, shape=shape, unit="N", crc32c=1)
            self.expect_refusal(self.ask(request, bytes(24)))
            sequence += 1
        self.expect_good_order()

    def test_more_frames_than_arrays(self):
        self.expect_refusal(self.ask(self.hello(), *[b"x"] * 5000))
        self.expect_good_order()

    def test_a_frame_without_end(self):
        """A length of 2^62 bytes in a frame header of ZMTP: the connection is dropped, nothing is reserved."""
        self.assertEqual(self.ask(self.hello()).WhichOneof("body"), "welcome")
        with raw(self.address) as link:
            link.sendall(greeting(b"NULL"))
            ready = b"\x05READY" + b"\x0bSocket-Type" + struct.pack(">I", 6) + b"DEALER" + b"\x08Identity" + struct.pack(">I", 0)
            link.sendall(b"\x04" + bytes([len(ready)]) + ready)
            link.sendall(b"\x02" + struct.pack(">Q", 2**62) + b"data")
            link.settimeout(SOON)
            while link.recv(1 << 16):
                pass  # until the server hangs up
        self.assertEqual(self.ask(self.hello()).WhichOneof("body"), "welcome", "it still serves its peer")
        self.expect_good_order()

    def test_a_server_goes_on_when_a_second_one_speaks(self):
        self.assertEqual(self.ask(self.hello()).WhichOneof("body"), "welcome")
        for frames in ([self.hello().SerializeToString()], [b""], [os.urandom(1000)] * 100):
            knock(self.address, frames=frames)
        self.assertEqual(self.ask(self.hello()).WhichOneof("body"), "welcome")
        self.link.close()
        _, errors = self.server.communicate(timeout=SOON)
        self.assertEqual(self.server.returncode, 4)
        self.assertEqual(len(errors.strip().splitlines()), 2, errors)


class AddressTest(unittest.TestCase):
    def test_no_other_machine_without_keys(self):
        for program in ("flow-server", "solid-server"):
            done = subprocess.run([PROGRAMS / program, "serve", SCENE, "--listen", "tcp://0.0.0.0:*"], capture_output=True, text=True, timeout=SOON)
            self.assertEqual(done.returncode, 2)
            self.assertIn("--keys", done.stderr)
            self.assertNotIn("listening", done.stdout)


if __name__ == "__main__":
    unittest.main(verbosity=2)
