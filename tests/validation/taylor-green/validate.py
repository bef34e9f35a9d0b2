#!/usr/bin/python3
"""Taylor-Green vortex at Re = 1600: energy and its decay beside a direct simulation, 64^3 to 256^3 (about 10 minutes on two cores, 7 of them for 256^3)."""

import sys
from pathlib import Path

import numpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import stored_runs as runs  # noqa: E402

SCENE = HERE.parents[2] / "deploy" / "scenes" / "taylor-green" / "scene.txtpb"
SOURCE = "spectral direct simulation with 512^3 modes, HiOCFD C3.5"
VOLUME = (2 * numpy.pi) ** 3
# Cells along each axis and the step of history.csv; inside it the flow chooses its own.
GRIDS = {"64": (64, 0.05), "128": (128, 0.05), "192": (192, 0.05), "256": (256, 0.05)}


def rows_of(name, cells, step, folder, reference):
    history = runs.read_history(folder)
    time = numpy.concatenate([[0], history["time"]])
    energy = numpy.concatenate([[0.125], history["flow.kinetic_energy"] / VOLUME])
    decay = -numpy.gradient(energy, time)
    expected = numpy.interp(time, reference["t"], reference["Ek"])
    peak = decay.argmax()
    gated = cells == 256
    varied = {"mesh": f"{cells}^3", "dt": step, "steps": float(history["flow.substeps"].sum())}
    yield runs.row(name, "energy_error_l2", numpy.sqrt(((energy - expected) ** 2).mean() / (expected**2).mean()), None,
                   "relative to " + SOURCE, folder, **varied)
    yield runs.row(name, "peak_decay_rate", decay[peak], 0.012857, SOURCE, folder,
                   (0.012857 * 0.95, 0.012857 * 1.05) if gated else None, **varied)
    yield runs.row(name, "time_of_peak", time[peak], 8.97, SOURCE, folder, **varied)
    final = numpy.interp(10, reference["t"], reference["Ek"])
    yield runs.row(name, "energy_at_10", energy[-1], final, SOURCE, folder,
                   (final * 0.985, final * 1.015) if gated else None, **varied)
    yield runs.row(name, "ns_per_cell_step", runs.core_seconds(folder) * 1e9 / cells**3 / varied["steps"], None,
                   "core seconds; CaNS 4.0 on 128^3: 338 to 387", folder, **varied)


def main():
    parser = runs.arguments(__doc__, "taylor-green")
    parser.add_argument("--ranks", type=int, default=runs.cores(), help="MPI ranks of the flow")
    options = parser.parse_args()
    reference = runs.read_reference(HERE / "reference.csv")
    rows = []
    for name, (cells, step) in GRIDS.items():
        if options.only and name not in options.only:
            continue
        folder = Path(options.out).resolve() / name
        settings = [f"flow.navier_stokes.grid.{axis}.uniform.cells={cells}" for axis in "xyz"]
        settings += [f"time.step={step}", "output.results_interval=10", "output.results_start=9.99", *options.set]
        code = runs.run(options.couplet, SCENE, folder, settings, ["--flow-ranks", str(options.ranks)])
        if code != 0:
            sys.exit(f"{name}: exit code {code}: {runs.last_words(folder)}")
        rows += rows_of(name, cells, step, folder, reference)
        print(f"  {cells}^3 done", flush=True)
    return runs.report(rows, options.json)


if __name__ == "__main__":
    sys.exit(main())
