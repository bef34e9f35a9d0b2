#!/usr/bin/python3
"""A tube with three moving sheets of a heart valve's size: ns per active cell and step, and the share of the geometry in it."""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

# Yielding and unbound: on a machine with fewer cores than ranks they must not wait on each other's core.
MPI = ["mpirun", "--oversubscribe", "--bind-to", "none"]
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}


def measure(ranks, arguments):
    program = str(Path(__file__).resolve().parent / "measure-moving-sheets")
    done = subprocess.run(MPI + ["-n", str(ranks), program] + arguments, capture_output=True, text=True,
                          env={**os.environ, **ENVIRONMENT})
    if done.returncode != 0:
        sys.exit(f"the measurement ended with exit code {done.returncode}: {(done.stderr.strip().splitlines() or [''])[0]}")
    return json.loads(done.stdout.splitlines()[-1])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--about", action="store_true", help="one line about this benchmark")
    parser.add_argument("--json", help="write the rows to this file")
    parser.add_argument("--size", type=float, nargs="+", default=[1.0], help="1: a box of 400 x 130 x 130 cells; 0.3 runs in seconds")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--walls", nargs="+", default=["surface", "cells"], choices=["surface", "cells"],
                        help="of the tube: a fixed surface that cuts cells, or whole cells")
    parser.add_argument("--steps", type=int, default=10, help="steps that are timed")
    parser.add_argument("--processor-time", action="store_true", help="of the busiest rank, in place of wall time")
    parser.add_argument("--tolerance", type=float, default=1e-3, help="of the pressure increment, relative")
    options = parser.parse_args()
    if options.about:
        print(__doc__.splitlines()[0])
        return
    rows = []
    for size in options.size:
        for wall in options.walls:
            for ranks in options.ranks:
                # Blocks side by side across the tube share the sheets, which all stand in one half along it.
                row = measure(ranks, ["--size", str(size), "--wall", wall, "--steps", str(options.steps),
                                      "--tolerance", str(options.tolerance), "--blocks", "1", "1", str(ranks)]
                              + ["--processor-time"] * options.processor_time)
                rows.append(row)
                box = " x ".join(str(n) for n in row["box"])
                print(f"{box}, wall: {wall}, {ranks} rank{'s' if ranks > 1 else ''}: {row['cells_active']:.0f} active cells, "
                      f"{row['cells_cut']:.0f} cut, {row['ns_per_cell_step_iteration']:.1f} ns per cell and step, "
                      f"{row['pressure_iterations']:.1f} pressure iterations, geometry {100 * row['geometry_share']:.1f} % of the step, "
                      f"{row['geometry_over_pressure_solve']:.2f} of a pressure solve")
                print("  ms: " + ", ".join(f"{name} {value:.1f}" for name, value in row["ms"].items()))
                print("  ns per cut cell: " + ", ".join(f"{name} {value:.0f}" for name, value in row["ns_per_cut_cell"].items()),
                      flush=True)
    if options.json:
        Path(options.json).write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
