"""Programs that are timed: processor seconds of a child, the fastest of a few runs."""

import os
import subprocess
import time
from dataclasses import dataclass

SHORT = 2.0  # [s]; what takes less is run again
REPEATS = 3


@dataclass
class Timed:
    code: int
    output: str  # what it printed, both streams
    core_seconds: float  # user and system
    wall_seconds: float


def run(command, folder, environment=None):
    """Runs a command in a folder; its own processor time, whatever else the machine does."""
    with open(folder / "output.txt", "w+") as output:
        start = time.perf_counter()
        child = subprocess.Popen(command, cwd=folder, stdout=output, stderr=subprocess.STDOUT,
                                 env={**os.environ, **(environment or {})})
        _, status, usage = os.wait4(child.pid, 0)
        wall = time.perf_counter() - start
        child.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        return Timed(child.returncode, output.read(), usage.ru_utime + usage.ru_stime, wall)


def fastest(once, repeats=REPEATS):
    """The run with the least processor time: `once` is called again while it is short."""
    best = once()
    for _ in range(repeats - 1):
        if best.core_seconds > SHORT or best.code != 0:
            break
        again = once()
        if again.core_seconds < best.core_seconds:
            best = again
    return best
