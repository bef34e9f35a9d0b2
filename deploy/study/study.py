#!/usr/bin/python3
"""Speed against error of a scene: runs every combination of the varied fields, then tells the observed order, the
extrapolated value and its uncertainty, and the cheapest setting for a wanted error."""

import argparse
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "report"))

from assessment import Assessment, cheapest  # noqa: E402
from combinations import combine, parse_vary  # noqa: E402
from study_output import print_tables, rows_of, write_csv  # noqa: E402
from study_page import study_page  # noqa: E402
from study_runs import Runner, StudyRun, folder_name  # noqa: E402

COMMAND_LINE_WRONG = 2
CANNOT_READ = 5


def parse_arguments(words):
    parser = argparse.ArgumentParser(prog="couplet study", description=__doc__)
    parser.add_argument("scene", metavar="SCENE", type=Path)
    parser.add_argument("--vary", action="append", required=True, metavar="PATH=V1,V2,...",
                        help="a field and its values; fields that vary together: PATH,PATH=V1:W1,V2:W2,...; several --vary: every combination")
    parser.add_argument("--quantity", action="append", default=[], metavar="NAME", help="quantity of summary.json to look at; default: all")
    parser.add_argument("--set", action="append", default=[], metavar="PATH=VALUE", help="a setting for every run")
    parser.add_argument("--out", type=Path, help="folder of the study; default: runs/study-SCENE. Finished runs in it are used again")
    parser.add_argument("--reference", choices=("extrapolated", "finest"), default="extrapolated", help="what errors are measured against")
    parser.add_argument("--error", action="append", type=float, default=[], metavar="X", help="wanted error, for example 0.01; default: 0.1, 0.03, 0.01")
    parser.add_argument("--jobs", type=int, default=1, help="runs at the same time; more than one disturbs the measured cost")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the rows to this file")
    parser.add_argument("--solid-threads", type=int, help="threads of the solid server in every run")
    parser.add_argument("--couplet", required=True, help=argparse.SUPPRESS)
    return parser.parse_args(words)


def choose_quantities(runs, wanted):
    """The names asked for; all that any run has when none was. Raises ValueError for a name that no run has."""
    there = list(dict.fromkeys(name for run in runs for name in run.values))
    for name in wanted:
        if there and name not in there:
            raise ValueError(f"--quantity {name}: the runs have {', '.join(there)}")
    return wanted or there


def main(words=None):
    options = parse_arguments(words)
    try:
        axes = [parse_vary(text) for text in options.vary]
    except ValueError as error:
        print(f"couplet: study: {error}", file=sys.stderr)
        return COMMAND_LINE_WRONG
    if not options.scene.is_file():
        print(f"couplet: study: {options.scene}: there is no such scene", file=sys.stderr)
        return CANNOT_READ
    out = (options.out or Path("runs") / f"study-{options.scene.resolve().parent.name}").resolve()
    combinations = combine(axes)
    print(f"{len(combinations)} runs in {out}", flush=True)
    runs = [StudyRun(combination, out / folder_name(combination)) for combination in combinations]
    extra = ["--solid-threads", str(options.solid_threads)] if options.solid_threads else []
    runner = Runner(options.couplet, options.scene, options.set, extra, lambda line: print(line, flush=True))
    runner.run_all(runs, options.jobs)
    if all(run.exit_code != 0 for run in runs):
        print("couplet: study: no run went well; the lines above say why", file=sys.stderr)
        return max(run.exit_code or 0 for run in runs)
    try:
        quantities = choose_quantities(runs, options.quantity)
    except ValueError as error:
        print(f"couplet: study: {error}", file=sys.stderr)
        return COMMAND_LINE_WRONG
    assessments = [Assessment(name, axes, runs, options.reference == "finest") for name in quantities]
    wanted = [(error, cheapest(runs, assessments, error)) for error in options.error or (0.1, 0.03, 0.01)]
    print_tables(axes, runs, assessments, wanted)
    rows = list(rows_of(axes, runs, assessments))
    write_csv(out / "study.csv", rows)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1))
    (out / "report.html").write_text(study_page(f"Study of {options.scene.resolve().parent.name}", axes, runs, assessments, wanted))
    print(f"table: {out / 'study.csv'}\nreport: {out / 'report.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
