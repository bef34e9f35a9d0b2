#!/usr/bin/python3
"""The solid beside CalculiX on the same meshes: error and processor seconds, one row a run (estimated: 10 minutes; --quick: 2)."""

import argparse
import json
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, "@CMAKE_SOURCE_DIR@/tests/benchmarks/solid_peer")
import calculix  # noqa: E402
import couplet  # noqa: E402
import dynamic_cases  # noqa: E402
import other_cases  # noqa: E402
import picture  # noqa: E402
import static_cases  # noqa: E402
from table import Table  # noqa: E402

CASES = {"flag": static_cases.static_flag, "csm3": dynamic_cases.csm3, "cantilever": static_cases.cantilever,
         "sphere": static_cases.hollow_sphere, "cylinder": static_cases.hollow_cylinder, "swing": dynamic_cases.first_swing,
         "modes": other_cases.fold_modes, "cube": dynamic_cases.cube, "leaflets": dynamic_cases.leaflets,
         "kernel": other_cases.kernel, "increment": other_cases.explicit_increment, "threads": other_cases.explicit_threads}


class Bench:
    """What a case needs: the programs, a folder for its files, the table."""

    def __init__(self, options, work):
        self.programs = Path(__file__).resolve().parent
        self.work = Path(work)
        self.has_peer = calculix.version() is not None and not options.alone
        self.is_quick = options.quick
        self.family = ""
        self.table = Table()

    def choose(self, quick, full):
        return quick if self.is_quick else full

    def folder(self, *names):
        return self.work / "-".join(str(name).replace(" ", "_") for name in names)

    def solve(self, text, *names, **how):
        return couplet.solve(str(self.programs / "solid-server"), text, self.folder(*names), **how)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--about", action="store_true", help="one line about this benchmark")
    parser.add_argument("--json", help="write the rows to this file")
    parser.add_argument("--plots", help="draw error against processor seconds into this folder, one picture a family")
    parser.add_argument("--cases", nargs="+", choices=CASES, default=list(CASES), help="only these")
    parser.add_argument("--quick", action="store_true", help="the smaller meshes only")
    parser.add_argument("--alone", action="store_true", help="leave CalculiX out")
    options = parser.parse_args()
    if options.about:
        print(__doc__.splitlines()[0])
        return
    if calculix.version() is None:
        print("CalculiX is not installed (apt-get install calculix-ccx): its rows are left out")
    elif not options.alone:
        print(f"CalculiX {calculix.version()}, on one thread where nothing else is said")
    with tempfile.TemporaryDirectory() as work:
        bench = Bench(options, work)
        for case in options.cases:
            CASES[case](bench)
    if options.plots:
        picture.draw_all(bench.table.rows, Path(options.plots))
    if options.json:
        Path(options.json).write_text(json.dumps(bench.table.rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
