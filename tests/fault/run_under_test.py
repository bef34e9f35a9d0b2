"""A run of the vocal fold that a test starts, watches and disturbs. Only processes that descend from it are ever touched."""

import csv
import ctypes
import json
import os
import signal
import socket
import subprocess
import tempfile
import time
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
SCENE = TOP / "deploy" / "scenes" / "vocal-fold-hybrid" / "scene.txtpb"
FLOW_SCENE = TOP / "tests" / "fault" / "vortices.txtpb"
PROGRAMS = ("coupler", "flow-server", "solid-server")

# Implicit coupling and fields that are stored often: much is going on when something happens.
SETTINGS = ["coupling.scheme=SERIAL_IMPLICIT", "output.results_start=0", "output.results_interval=1e-4", "time.end=10"]
PIDFD_GETFD = 438  # the system call, on every architecture; Python has no name for it
START_DEADLINE = 90  # [s] for a busy machine; usually below 1


class Run:
    """`couplet run` in a folder of its own."""

    def __init__(self, couplet, *arguments, settings=(), scene=SCENE, common=SETTINGS, restarts=0):
        self.temporary = tempfile.TemporaryDirectory(prefix="couplet fault ")
        self.out = Path(self.temporary.name) / "run"
        command = [couplet, "run", str(scene), "--out", str(self.out), "--quiet", "--no-report", "--restarts", str(restarts), *arguments]
        for setting in [*common, *settings]:
            command += ["--set", setting]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()
        self.temporary.cleanup()

    def wait_for_steps(self, n_steps):
        """Returns when so many steps are on disk."""
        deadline = time.monotonic() + START_DEADLINE
        while self.n_rows() < n_steps:
            if self.process.poll() is not None:
                raise AssertionError(f"the run ended before its {n_steps}th step: {self.process.communicate()[1]}")
            if time.monotonic() > deadline:
                raise AssertionError(f"no {n_steps} steps within {START_DEADLINE} s")
            time.sleep(0.02)

    def n_rows(self):
        history = self.out / "history.csv"
        return max(0, history.read_text().count("\n") - 1) if history.exists() else 0

    def pid_of(self, program):
        """Process id of one of the three programs of this run."""
        return next(pid for pid in descendants(self.process.pid) if name_of(pid) == program)

    def send(self, program, number):
        os.kill(self.pid_of(program), number)

    def pids_of(self, program):
        """All processes of a program of this run, oldest first."""
        return sorted(pid for pid in descendants(self.process.pid) if name_of(pid) == program)

    def end(self, within):
        """Exit code and lines on standard error; fails when the run does not end in time [s]."""
        started = time.monotonic()
        try:
            errors = self.process.communicate(timeout=within)[1]
        except subprocess.TimeoutExpired:
            raise AssertionError(f"the run did not end within {within} s") from None
        self.seconds_to_end = time.monotonic() - started
        return self.process.returncode, errors.strip().splitlines()

    def summary(self):
        return json.loads((self.out / "summary.json").read_text())

    def history(self):
        """Rows of history.csv as numbers; a torn line would not be one."""
        with open(self.out / "history.csv", newline="") as file:
            rows = list(csv.reader(file))
        return rows[0], [[float(value) for value in row] for row in rows[1:]]


def cut_connections(pid):
    """Shuts down every stream socket of a process, as a network that breaks does; how many they were."""
    n_cut = 0
    process = os.pidfd_open(pid)
    try:
        for entry in Path(f"/proc/{pid}/fd").iterdir():
            try:
                if not os.readlink(entry).startswith("socket:"):
                    continue
            except OSError:
                continue  # a file that was closed while we looked
            copy = ctypes.CDLL(None, use_errno=True).syscall(PIDFD_GETFD, process, int(entry.name), 0)
            if copy < 0:
                continue
            with socket.socket(fileno=copy) as end:
                try:
                    end.shutdown(socket.SHUT_RDWR)
                    n_cut += 1
                except OSError:
                    pass  # one that listens, or is not connected
    finally:
        os.close(process)
    return n_cut


def name_of(pid):
    try:
        return Path(f"/proc/{pid}/comm").read_text().strip()
    except OSError:
        return ""


def descendants(pid):
    """All processes that a process has started, and those that they have started."""
    found = []
    try:
        for thread in Path(f"/proc/{pid}/task").iterdir():
            for child in (thread / "children").read_text().split():
                found += [int(child), *descendants(int(child))]
    except OSError:
        pass  # it has ended while we looked
    return found


def still_running(pids):
    """Those that live; a zombie has ended and only waits for its parent."""
    alive = []
    for pid in pids:
        try:
            state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
        except OSError:
            continue
        if state not in "ZX":
            alive.append(pid)
    return alive


def interrupt(run):
    run.process.send_signal(signal.SIGINT)
