#!/usr/bin/python3
"""Loses a program of a coupled run at a random moment, again and again (200 times in about an hour and a half), and compares every run
with one that lost nothing: history to the last byte, stored states to the last bit. Prints a row for each loss and their medians."""

import argparse
import csv
import hashlib
import os
import random
import signal
import statistics
import sys
import time
from pathlib import Path

import meshio

from run_under_test import PROGRAMS, Run, cut_connections, descendants, name_of, still_running

COLUMNS = ["loss", "program", "how", "moment [s]", "writes a checkpoint", "detected after [s]", "started again after [s]", "back after [s]",
           "times started again", "exit code", "identical"]
WAYS = ("killed", "frozen", "cut off")
LOOK = 0.002  # [s] between two looks at a run
GIVEN_UP = 300  # [s]


def settings(options):
    return [f"output.checkpoints={{every_steps: {options.checkpoint_every}}}", f"coupling.heartbeat_deadline={options.heartbeat}"]


def start(options):
    return Run(options.couplet, "--steps", str(options.steps), settings=settings(options), restarts=3)


def fingerprint(run):
    """Of the history and of all states that a reader of the results finds."""
    found = hashlib.sha256((run.out / "history.csv").read_bytes())
    for name in ("flow", "fold"):
        with meshio.xdmf.TimeSeriesReader(run.out / "results" / f"{name}.xmf") as reader:
            found.update(reader.read_points_cells()[0].tobytes())
            for state in range(reader.num_steps):
                at, data, _ = reader.read_data(state)
                found.update(f"{at!r}".encode())
                for field in sorted(data):
                    found.update(field.encode() + data[field].tobytes())
    return found.hexdigest()


def programs_of(run):
    return {name: pid for pid in descendants(run.process.pid) if (name := name_of(pid)) in PROGRAMS}


def wait_until(holds, run):
    """Whether it came to hold before the run ended."""
    deadline = time.monotonic() + GIVEN_UP
    while not holds():
        if run.process.poll() is not None:
            return False
        if time.monotonic() > deadline:
            raise TimeoutError(f"nothing happened for {GIVEN_UP} s in {run.out}")
        time.sleep(LOOK)
    return True


def lose(run, program, how):
    """False when the program had just ended."""
    try:
        pid = programs_of(run)[program]
        if how == "cut off":
            return cut_connections(pid) > 0
        os.kill(pid, signal.SIGKILL if how == "killed" else signal.SIGSTOP)
        return True
    except (KeyError, OSError):
        return False


def lose_once(options, number, whole, chance):
    """A row of the table; None when the run had ended or not begun at the moment that was drawn."""
    program, how, moment = chance.choice(PROGRAMS), chance.choice(WAYS), chance.uniform(0.05, 0.95) * whole["seconds"]
    waits_for_checkpoint = chance.random() < 0.25
    run = start(options)
    try:
        begun = time.monotonic()
        if not wait_until(lambda: time.monotonic() - begun > moment and len(programs_of(run)) == len(PROGRAMS), run):
            return None
        unfinished = lambda: any((run.out / "checkpoint").glob("*.part"))  # noqa: E731
        if waits_for_checkpoint and not wait_until(unfinished, run):
            return None
        before, n_rows = programs_of(run), run.n_rows()
        lost_at = time.monotonic()
        if not lose(run, program, how):
            return None
        is_writing = unfinished()
        others = [pid for name, pid in before.items() if name != program]

        def since(holds):
            return time.monotonic() - lost_at if wait_until(holds, run) else float("nan")

        detected = since(lambda: len(still_running(others)) < len(others))
        restarted = since(lambda: len(still_running(before.values())) == 0 and len(programs_of(run)) == len(PROGRAMS))
        back = since(lambda: run.n_rows() > n_rows)
        code, _ = run.end(GIVEN_UP)
        identical = code == 0 and fingerprint(run) == whole["fingerprint"]
        return dict(zip(COLUMNS, [number, program, how, f"{moment:.2f}", is_writing, f"{detected:.3f}", f"{restarted:.3f}", f"{back:.3f}",
                                  run.summary()["restarts"], code, identical]))
    finally:
        run.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--couplet", required=True, help="the couplet command")
    parser.add_argument("--losses", type=int, default=200)
    parser.add_argument("--first", type=int, default=1, help="number of the first one: a study can be done in parts")
    parser.add_argument("--steps", type=int, default=3000, help="of each run; 3000 take about 20 s")
    parser.add_argument("--checkpoint-every", type=int, default=100, help="steps")
    parser.add_argument("--heartbeat", type=float, default=2, help="a program that gives no sign of life for so long is lost [s]")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="writes the table here; rows of an earlier part stay")
    options = parser.parse_args()

    run = start(options)
    begun = time.monotonic()
    code, lines = run.end(GIVEN_UP)
    if code != 0:
        sys.exit(f"the run that nothing is lost of failed: {lines}")
    whole = {"seconds": time.monotonic() - begun, "fingerprint": fingerprint(run)}
    run.close()
    print(f"a run that nothing is lost of takes {whole['seconds']:.1f} s", flush=True)

    rows = []
    for number in range(options.first, options.first + options.losses):
        for attempt in range(100):
            row = lose_once(options, number, whole, random.Random(f"{options.seed} {number} {attempt}"))
            if row:
                break
        rows.append(row)
        print(", ".join(str(value) for value in row.values()), flush=True)
        if options.out:
            is_new = not options.out.exists()
            with open(options.out, "a", newline="") as file:
                table = csv.DictWriter(file, COLUMNS)
                if is_new:
                    table.writeheader()
                table.writerow(row)

    n_same = sum(row["identical"] for row in rows)
    print(f"{n_same} of {len(rows)} runs ended with the same history and states")
    for how in WAYS:
        chosen = [row for row in rows if row["how"] == how]
        if chosen:
            found = {name: [float(row[name]) for row in chosen] for name in COLUMNS[5:8]}
            print(f"{how} ({len(chosen)}): " + ", ".join(f"{name} {statistics.median(values):.2f}, at most {max(values):.2f}"
                                                         for name, values in found.items()))
    return 0 if n_same == len(rows) else 1


if __name__ == "__main__":
    sys.exit(main())
