#!/usr/bin/python3
"""Hill's vortex in a sphere: ns per cell and step with and without the sphere, and the error of the velocity."""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

# Yielding and unbound: on a machine with fewer cores than ranks they must not wait on each other's core.
MPI = ["mpirun", "--oversubscribe", "--bind-to", "none"]
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}
# The solver of the dissertation on a cluster of 2017-2019, 256^3 cells: seconds by number of cores. It does not say for how many steps.
DISSERTATION = {1: 377.1, 4: 99.3, 16: 30.8, 64: 9.3}


def measure(ranks, arguments):
    program = str(Path(__file__).resolve().parent / "measure-hill-vortex")
    done = subprocess.run(MPI + ["-n", str(ranks), program] + arguments, capture_output=True, text=True,
                          env={**os.environ, **ENVIRONMENT})
    if done.returncode != 0:
        sys.exit(f"the measurement ended with exit code {done.returncode}: {(done.stderr.strip().splitlines() or [''])[0]}")
    return json.loads(done.stdout.splitlines()[-1])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--about", action="store_true", help="one line about this benchmark")
    parser.add_argument("--json", help="write the rows to this file")
    parser.add_argument("--cells", type=int, nargs="+", default=[64, 128, 256], help="cells in each direction")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--fluid", nargs="+", default=["none", "inside", "both"], choices=["none", "inside", "both"],
                        help="sides of the sphere where fluid is; none: the box without the sphere")
    parser.add_argument("--duration", type=float, default=0.1, help="that share of the radius is covered by the fluid in the middle")
    parser.add_argument("--processor-time", action="store_true", help="of the busiest rank, in place of wall time")
    options = parser.parse_args()
    if options.about:
        print(__doc__.splitlines()[0])
        return
    rows = []
    print(f"{'n':>4} {'ranks':>5} {'fluid':>7} {'steps':>5} {'ns/cell/step':>12} {'best':>7} {'to no body':>10} {'iterations':>10} "
          f"{'error (L2)':>10} {'largest':>9}")
    for n in options.cells:
        for ranks in options.ranks:
            without = None
            for fluid in options.fluid:
                row = measure(ranks, ["--n", str(n), "--fluid", fluid, "--duration", str(options.duration)]
                              + ["--processor-time"] * options.processor_time)
                rows.append(row)
                best = row["ns_per_cell_step_best"]
                if fluid == "none":
                    without = best
                row["over_no_body"] = best / without if without else None
                errors = "".join(f" {row[name]:10.2e}" for name in ("error", "largest_error") if name in row)
                print(f"{n:4d} {ranks:5d} {fluid:>7} {row['steps']:5d} {row['ns_per_cell_step']:12.1f} {best:7.1f} "
                      f"{'' if without is None else format(best / without, '.2f'):>10} {row['pressure_iterations']:10.2f}{errors}", flush=True)
    print("the dissertation's solver, 256^3, core microseconds a cell (number of steps not said): "
          + ", ".join(f"{cores} cores {1e6 * cores * seconds / 256**3:.0f}" for cores, seconds in DISSERTATION.items()))
    if options.json:
        Path(options.json).write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
