#!/usr/bin/python3
"""Vocal fold in its own 1D glottal flow: equilibria, growth rates, and the dissertation's Tables 5.2 and 5.3 beside ours (about 60 minutes)."""

import json
import math
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy

from cases import CASES, UNDAMPED

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import stored_runs as runs  # noqa: E402

SCENE = HERE.parents[2] / "deploy" / "scenes" / "vocal-fold-hybrid" / "scene.txtpb"


def run_case(case, couplet, out, extra):
    """Runs a case unless its folder holds the same finished run; returns its folder and exit code."""
    settings = UNDAMPED + case.settings + extra
    if case.kind == "cycle":
        settings += [f"output.quantity[{i}].window={case.window}" for i in range(5)]
    if "output.results_start=0" not in settings:
        # Only the numbers are wanted here, not the fields.
        settings += ["output.results_start=1e-9", "output.results_interval=1e3"]
    return out / case.name, runs.run(couplet, SCENE, out / case.name, settings, ["--solid-threads", "1"])


def equilibrium(history):
    last = history["time"] > history["time"][-1] - 0.01
    return {
        "exit_opening": (-history["exit.y"][last].mean(), "m", history["exit.y"][last].std()),
        "inlet_opening": (-history["inlet.y"][last].mean(), "m", history["inlet.y"][last].std()),
        "flow_rate": (history["flow.rate"][last].mean(), "m^3/s", history["flow.rate"][last].std()),
    }


def growth(history, mode):
    """Growth rate [1/s] of one mode after a small push: slope of the logarithm of a demodulated amplitude.

    The signal is multiplied by exp(-i 2 pi f t) with f the line of the mode and averaged under a Hann window of 0.16 s,
    which keeps lines 20 Hz apart below 1e-3 of each other.
    """
    band = (65, 90) if mode == 1 else (115, 138)
    column = "exit.x" if mode == 1 else "exit.y"
    time = numpy.arange(0.22, history["time"][-1], 2e-4)
    signal = numpy.interp(time, history["time"], history[column])
    signal -= signal.mean()
    spectrum = numpy.abs(numpy.fft.rfft(signal * numpy.hanning(len(signal)), 8 * len(signal)))
    frequency = numpy.fft.rfftfreq(8 * len(signal), 2e-4)
    inside = (frequency > band[0]) & (frequency < band[1])
    line = frequency[inside][spectrum[inside].argmax()]
    width = int(0.16 / 2e-4)
    window = numpy.hanning(width) / numpy.hanning(width).sum()
    envelope = numpy.abs(numpy.convolve(signal * numpy.exp(-2j * math.pi * line * time), window, "valid"))
    centre = time[width // 2: width // 2 + len(envelope)]
    slope, residual = numpy.polyfit(centre, numpy.log(envelope), 1, full=True)[:2]
    scatter = math.sqrt(residual[0] / len(centre)) if len(residual) else 0.0
    return {
        f"growth_rate_mode_{mode}": (slope[0], "1/s", scatter),
        f"frequency_mode_{mode}": (line, "Hz", 0.0),
    }


def measure(case, folder, code):
    if code != case.exit_code or code != 0:
        return {"exit_code": (code, "1", 0.0)}
    if case.kind == "equilibrium":
        return equilibrium(runs.read_history(folder))
    if case.kind == "growth":
        return growth(runs.read_history(folder), int(case.name[-1]))
    summary = json.loads((folder / "summary.json").read_text())
    numbers = {name: (q["value"], q["unit"], q.get("spread") or 0.0) for name, q in summary["quantities"].items() if q["value"] is not None}
    # The dissertation's d is the largest opening; `amplitude` is the mean of the openings of all cycles.
    history = runs.read_history(folder)
    inside = history["time"] > history["time"][-1] - case.window
    numbers["largest_opening"] = (-history["exit.y"][inside].min(), "m", numbers["amplitude"][2] if "amplitude" in numbers else 0.0)
    return numbers


def rows_of(case, folder, code):
    cost = runs.core_seconds(folder)
    for quantity, (value, unit, spread) in measure(case, folder, code).items():
        reference, source = case.reference.get(quantity, (None, ""))
        band = case.band.get(quantity)
        verdict = "" if band is None else "inside" if band[0] <= value <= band[1] else "outside"
        if quantity == "exit_code" and code != case.exit_code:
            verdict = f"outside: expected exit code {case.exit_code}"
        error = (value - reference) / abs(reference) if reference else None
        yield {
            "case": case.name, "quantity": quantity, "value": value, "unit": unit, "spread": spread, "reference": reference,
            "relative_error": error, "band": band, "verdict": verdict, "source": source, "core_seconds": cost, "start": case.start,
            "window": case.window if case.kind == "cycle" else None, "mesh": case.mesh,
        }


def print_table(rows):
    print(f"{'case':28} {'quantity':22} {'ours':>12} {'spread':>10} {'reference':>12} {'verdict':>9}  start; window; mesh; source")
    for row in rows:
        reference = "" if row["reference"] in (None, 0) else f"{row['reference']:.5g}"
        where = "; ".join(str(x) for x in (row["start"], row["window"], row["mesh"], row["source"]) if x)
        print(f"{row['case']:28} {row['quantity']:22} {row['value']:12.5g} {row['spread']:10.2g} {reference:>12} {row['verdict']:>9}  {where}")


def main():
    parser = runs.arguments(__doc__, "vocal-fold-hybrid")
    parser.add_argument("--jobs", type=int, default=2, help="runs at the same time, one thread each")
    options = parser.parse_args()
    chosen = [case for case in CASES if not options.only or any(case.name.startswith(start) for start in options.only)]
    if not chosen:
        sys.exit("no case has such a name; the names are: " + ", ".join(case.name for case in CASES))
    out = Path(options.out).resolve()
    out.mkdir(parents=True, exist_ok=True)
    print(f"{len(chosen)} runs, about {sum(case.minutes for case in chosen) / options.jobs:.0f} minutes", flush=True)

    def work(case):
        folder, code = run_case(case, options.couplet, out, options.set)
        print(f"  {case.name}: exit code {code}", flush=True)
        return list(rows_of(case, folder, code))

    with ThreadPoolExecutor(options.jobs) as pool:
        rows = [row for case_rows in pool.map(work, chosen) for row in case_rows]
    print_table(rows)
    if options.json:
        Path(options.json).write_text(json.dumps(rows, indent=1))
    outside = [row for row in rows if row["verdict"].startswith("outside")]
    print(f"{len(rows) - len(outside)} rows inside or without a band, {len(outside)} outside")
    return 1 if outside else 0


if __name__ == "__main__":
    sys.exit(main())
