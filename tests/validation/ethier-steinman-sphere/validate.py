#!/usr/bin/python3
"""A sphere at rest and moving in the exact flow of Ethier and Steinman: errors and orders, 16^3 to 96^3 (about 6 core minutes; --quick 1)."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import stored_runs as runs  # noqa: E402

GRIDS = (16, 24, 32, 48, 64, 96)
QUICK_GRIDS = GRIDS[:4]
CASES = {"without": ["--without"], "at_rest": [], "moving": ["--drift", "1.2"]}
# Order over all grids from FIRST on: the coarser one has four cells on a radius. Reasons of the bands: reference.md.
FIRST = 24
BANDS = {"velocity_largest": (1.9, 3), "velocity_rms": (1.9, 3), "pressure_beyond_a_cell": (1.5, 3), "pressure_largest": None}
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def measured(program, folder, arguments):
    """What the program prints; kept in the folder and used again."""
    kept, stamp = folder / "summary.json", folder / "command.txt"
    command = [str(program), *arguments]
    if not (kept.exists() and stamp.exists() and stamp.read_text() == "\n".join(command)):
        done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, **ENVIRONMENT})
        if done.returncode != 0:
            raise RuntimeError(f"exit code {done.returncode}: {done.stderr.strip()}")
        folder.mkdir(parents=True, exist_ok=True)
        kept.write_text(done.stdout.splitlines()[-1] + "\n")
        stamp.write_text("\n".join(command))
    return json.loads(kept.read_text())


def rows_of(case, program, out, grids):
    errors, folder = {}, out
    for cells in grids:
        folder = out / f"{case}-{cells}"
        errors[cells] = measured(program, folder, ["--cells", str(cells), *CASES[case]])
        print(f"  {case}, {cells}^3 done", flush=True)
        for name in BANDS:
            yield runs.row(f"{case}-{cells}", name, errors[cells][name], None, "exact solution; m/s, Pa at 1 kg/m^3", folder)
    used = [cells for cells in grids if cells >= FIRST]
    for name, band in BANDS.items():
        # Slope of the line of least squares through log(error) over log(h).
        order = -numpy.polyfit(numpy.log(used), numpy.log([errors[cells][name] for cells in used]), 1)[0]
        yield runs.row(f"{case}-{used[0]}-{used[-1]}", f"order_of_{name}", order, None, "slope over all grids between", folder, band)


def main():
    parser = runs.arguments(__doc__, "ethier-steinman-sphere")
    parser.add_argument("--quick", action="store_true", help="without the two finest grids")
    options = parser.parse_args()
    program = Path(options.couplet).resolve().parent / "measure-ethier-steinman-sphere"
    out = Path(options.out).resolve()
    grids = QUICK_GRIDS if options.quick else GRIDS
    cases = {case: lambda case=case: rows_of(case, program, out, grids) for case in CASES if not options.only or case in options.only}
    return runs.report_cases(cases, options.json)


if __name__ == "__main__":
    sys.exit(main())
