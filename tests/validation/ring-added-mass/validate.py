#!/usr/bin/python3
"""Elastic ring in a liquid of 0.1, 1 and 10 times its inertia: frequency, loss and coupling iterations on finer and finer grids (about 20 minutes; --quick 1 minute)."""

import sys
from pathlib import Path

import numpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import body_forces as forces  # noqa: E402
import stored_runs as runs  # noqa: E402

SCENE = HERE.parents[2] / "deploy" / "scenes" / "ring-added-mass" / "scene.txtpb"
SOURCE = "exact: ring as a continuum, inviscid liquid"
CELLS = [52, 104, 208]  # across the box of 3.12 m; the gap is 0.45 m wide
STEPS = 100  # a period
BANDS = {14: (0.01, 3), 140: (0.01, 4), 1400: (0.02, 5)}  # of the frequency, relative; most iterations in the mean


def swing(time, value):
    """Angular frequency by the upward and downward crossings of 0, but for the first, and the share of the amplitude that a period loses."""
    at = numpy.flatnonzero(value[:-1] * value[1:] < 0)
    crossing = (time[at] - value[at] * (time[at + 1] - time[at]) / (value[at + 1] - value[at]))[1:]
    count = numpy.arange(len(crossing))
    peaks = [numpy.abs(value[(time >= a) & (time <= b)]).max() for a, b in zip(crossing[:-1], crossing[1:])]
    halves = numpy.polyfit(count[1:], numpy.log(peaks), 1)[0]
    return numpy.pi / numpy.polyfit(count, crossing, 1)[0], 1 - numpy.exp(2 * halves)


def rows_of(options, density, exact, cells):
    step = 2 * numpy.pi / exact / STEPS
    name = f"density-{density:g}-{cells}"
    settings = [f"flow.fluid.density={density:g}", f"flow.fluid.viscosity={1e-7 * density:g}", f"time.step={step:.9g}",
                f"time.end={4 * STEPS * step:.9g}", f"output.results_interval={4 * STEPS * step:.9g}"]
    settings += [f"flow.navier_stokes.grid.{axis}.uniform.cells={cells}" for axis in "xy"]
    history, folder = forces.solve(options, SCENE, name, settings)
    varied = {"mesh": f"{0.45 * cells / 3.12:.1f} cells in the gap", "dt": step}
    frequency, loss = swing(history["time"], (history["side.x"] - history["top.y"]) / 2)
    relative, most = BANDS[round(density)]
    is_finest = cells == CELLS[-1]
    iterations = history["iterations"].mean()
    yield runs.row(name, "angular_frequency", frequency, exact, SOURCE, folder, (exact * (1 - relative), exact * (1 + relative)) if is_finest else None, **varied)
    yield runs.row(name, "loss_a_period", loss, None, "share of the amplitude; no damping is meant", folder, **varied)
    yield runs.row(name, "iterations_mean", iterations, None, "coupling iterations of a step", folder, (0, most) if is_finest else None, **varied)


def main():
    parser = runs.arguments(__doc__, "ring-added-mass")
    parser.add_argument("--quick", action="store_true", help="the coarsest grid")
    options = parser.parse_args()
    table = runs.read_reference(HERE / "reference.csv")
    cases = {}
    for density, exact in zip(table["density"], table["frequency"]):
        for cells in CELLS[:1] if options.quick else CELLS:
            name = f"density-{density:g}-{cells}"
            if not options.only or any(name.startswith(start) for start in options.only):
                cases[name] = lambda d=density, e=exact, c=cells: rows_of(options, d, e, c)
    return runs.report_cases(cases, options.json)


if __name__ == "__main__":
    sys.exit(main())
