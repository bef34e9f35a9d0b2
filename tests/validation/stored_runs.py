"""Runs of a validation: each in a folder of its own, finished ones are used again; and the table that comes out."""

import argparse
import csv
import json
import os
import subprocess
from pathlib import Path

import numpy


def arguments(doc, name):
    """The options that every validation takes."""
    parser = argparse.ArgumentParser(description=doc)
    parser.add_argument("--couplet", required=True, help="the couplet command")
    parser.add_argument("--json", help="write the rows to this file")
    parser.add_argument("--out", default=f"runs/validate/{name}", help="folder of the runs; finished ones are used again")
    parser.add_argument("--only", action="append", default=[], help="run the cases whose names start with this")
    parser.add_argument("--set", action="append", default=[], help="a setting for every run")
    return parser


def run(couplet, scene, folder, settings, options=()):
    """Runs a scene unless its folder holds the same finished run; returns the exit code."""
    command = [couplet, "run", str(scene), "--out", str(folder), "--quiet", *options]
    for setting in settings:
        command += ["--set", setting]
    stamp = folder / "command.txt"
    if stamp.exists() and stamp.read_text() == "\n".join(command) and (folder / "exit_code.txt").exists():
        return int((folder / "exit_code.txt").read_text())
    if folder.exists():
        subprocess.run(["rm", "-r", str(folder)], check=True)
    done = subprocess.run(command, capture_output=True, text=True)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "console.txt").write_text(done.stdout + done.stderr)
    stamp.write_text("\n".join(command))
    (folder / "exit_code.txt").write_text(str(done.returncode))
    return done.returncode


def run_text(couplet, text, folder, settings=(), options=()):
    """Writes a scene beside its folder and runs it, anew when the text is another one; returns the exit code."""
    scene = folder.with_name(folder.name + ".txtpb")
    if not scene.exists() or scene.read_text() != text:
        scene.parent.mkdir(parents=True, exist_ok=True)
        scene.write_text(text)
        (folder / "exit_code.txt").unlink(missing_ok=True)
    return run(couplet, scene, folder, settings, ["--no-report", *options])


def read_history(folder):
    """The columns of history.csv by name, without units."""
    with open(folder / "history.csv") as file:
        names = [name.split(" [")[0] for name in next(csv.reader(file))]
    values = numpy.loadtxt(folder / "history.csv", delimiter=",", skiprows=1, ndmin=2)
    return {name: values[:, i] for i, name in enumerate(names)}


def read_reference(path, words=()):
    """The columns of a table by name; those named in `words` hold words, the others numbers."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: numpy.array([row[name] if name in words else float(row[name]) for row in rows]) for name in rows[0]}


def core_seconds(folder):
    summary = folder / "summary.json"
    return json.loads(summary.read_text()).get("core_seconds", 0) if summary.exists() else 0


def last_words(folder):
    """What a run that failed said last."""
    lines = (folder / "console.txt").read_text().strip().splitlines()
    return lines[-1] if lines else "nothing was said"


def cores():
    return os.cpu_count() or 1


def row(case, quantity, value, reference, source, folder, band=None, **varied):
    """A line of the table. `band`: the interval in which the value is expected."""
    error = (value - reference) / abs(reference) if reference else None
    verdict = "" if band is None else "inside" if band[0] <= value <= band[1] else "outside"
    return {"case": case, "quantity": quantity, "value": value, "reference": reference, "relative_error": error, "band": band,
            "verdict": verdict, "source": source, "core_seconds": core_seconds(folder), **varied}


def report(rows, json_file):
    """Prints the table, writes it where asked; the exit code of the validation."""
    print(f"{'case':24} {'quantity':28} {'ours':>12} {'reference':>12} {'error':>9} {'verdict':>8} {'core s':>9}  source")
    for r in rows:
        reference = "" if r["reference"] is None else f"{r['reference']:.6g}"
        error = "" if r["relative_error"] is None else f"{r['relative_error']:+.2%}"
        print(f"{r['case']:24} {r['quantity']:28} {r['value']:12.6g} {reference:>12} {error:>9} {r['verdict']:>8} {r['core_seconds']:9.0f}  "
              f"{r['source']}")
    if json_file:
        Path(json_file).write_text(json.dumps(rows, indent=1, default=float) + "\n")  # NumPy's numbers are not Python's
    n_outside = sum(r["verdict"] == "outside" for r in rows)
    print(f"{len(rows) - n_outside} rows inside or without a band, {n_outside} outside")
    return 1 if n_outside else 0


def report_cases(cases, json_file):
    """The rows of every case, of which one may end with a RuntimeError without stopping the others; as report."""
    rows, failures = [], []
    for name, case in cases.items():
        try:
            for row_of_case in case():
                rows.append(row_of_case)
        except RuntimeError as failure:
            failures.append(f"{name}: {failure}")
    code = report(rows, json_file)
    for failure in failures:
        print(failure)
    return 1 if failures else code
