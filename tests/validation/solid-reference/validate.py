#!/usr/bin/python3
"""Solids against closed forms, beam theory and published values: homogeneous states to impact, modes and snap-through (about 12 minutes; --quick 2)."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import stored_runs as runs  # noqa: E402
import columns  # noqa: E402
import homogeneous  # noqa: E402
import impact  # noqa: E402
import slender  # noqa: E402
import snap_through  # noqa: E402
import thick_walls  # noqa: E402
import vibration  # noqa: E402

CASES = {"homogeneous": homogeneous, "slender": slender, "thick_walls": thick_walls, "columns": columns, "impact": impact,
         "vibration": vibration, "snap_through": snap_through}


def main():
    parser = runs.arguments(__doc__, "solid-reference")
    parser.add_argument("--quick", action="store_true", help="coarse meshes and few cases")
    options = parser.parse_args()
    table = runs.read_reference(HERE / "reference.csv", words=["test", "case", "quantity", "unit"])
    reference = dict(zip(zip(table["test"], table["case"], table["quantity"]), table["value"]))
    chosen = {name: case for name, case in CASES.items() if not options.only or name in options.only}
    return runs.report_cases({name: (lambda case=case: case.rows(options, reference)) for name, case in chosen.items()}, options.json)


if __name__ == "__main__":
    sys.exit(main())
