#!/usr/bin/python3
"""A step of the Taylor-Green vortex: ns per cell and step, bytes per cell, and the energy beside that of the direct simulation."""

import csv
from pathlib import Path

import numpy
from rank_measurement import measure, parser_for, write_rows

REFERENCE = Path("@CMAKE_SOURCE_DIR@/tests/validation/taylor-green/reference.csv")
# Published by others, and what they were measured on, for the eye; CaNS: three projections a step.
PEERS = "CaNS 4.0, 128^3, one core of this kind of machine: 338-387 ns a cell and step (Runge-Kutta, three projections)"


def reference_energy(time):
    with open(REFERENCE, newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return numpy.interp(time, [float(row["t"]) for row in rows], [float(row["Ek"]) for row in rows])


def main():
    parser = parser_for(__doc__)
    parser.add_argument("--cells", type=int, nargs="+", default=[64, 128, 256], help="cells in each direction")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--schemes", nargs="+", default=["adams_bashforth", "runge_kutta"])
    parser.add_argument("--pressure", nargs="+", default=["automatic", "multigrid"])
    parser.add_argument("--steps", type=int, default=20, help="steps that are timed")
    options = parser.parse_args()
    if options.about:
        print(__doc__.splitlines()[0])
        return
    rows = []
    print(f"{'n':>4} {'ranks':>5} {'scheme':>16} {'pressure':>20} {'ns/cell/step':>12} {'best':>6} {'bytes/cell':>10} {'iterations':>10} "
          f"{'largest div u':>13} {'energy error':>12}")
    for n in options.cells:
        for scheme in options.schemes:
            for pressure in options.pressure:
                for ranks in options.ranks:
                    row = measure("measure-taylor-green", ranks,
                                  ["--n", str(n), "--steps", str(options.steps if n < 200 else max(5, options.steps // 3)),
                                   "--scheme", scheme, "--pressure", pressure])
                    row["pressure"] = pressure
                    row["energy_error"] = row["kinetic_energy"] / reference_energy(row["time"]) - 1
                    rows.append(row)
                    print(f"{n:4d} {ranks:5d} {scheme:>16} {pressure:>20} {row['ns_per_cell_step']:12.1f} {row['ns_per_cell_step_best']:6.1f} "
                          f"{row['bytes_per_cell']:10.1f} {row['pressure_iterations']:10.2f} {row['divergence']:13.2e} "
                          f"{row['energy_error']:12.2e}", flush=True)
    print(PEERS)
    write_rows(options.json, rows)


if __name__ == "__main__":
    main()
