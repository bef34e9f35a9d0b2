"""What a study leaves: study.csv, rows for --json, a table for the terminal."""

import csv


def rows_of(axes, runs, assessments):
    """One flat row a run."""
    for k, run in enumerate(runs):
        row = {axis.name: level.label for axis, level in zip(axes, run.combination.levels)}
        row |= {"status": run.status, "exit_code": run.exit_code, "core_seconds": run.cost, "wall_seconds": run.wall_seconds}
        for assessment in assessments:
            name = assessment.quantity
            row |= {name: run.values.get(name), f"{name}_spread": run.spreads.get(name), f"{name}_error": assessment.errors[k]}
        row["folder"] = str(run.folder)
        yield row


def write_csv(path, rows):
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def text(value, digits=5):
    return "-" if value is None else f"{value:.{digits}g}"


def print_tables(axes, runs, assessments, wanted):
    width = max(len(run.combination.label) for run in runs)
    print(f"\n{'':{width}}  {'core s':>9}" + "".join(f"  {a.quantity:>24}  {'error':>8}" for a in assessments))
    for k, run in enumerate(runs):
        line = f"{run.combination.label:{width}}  {text(run.cost, 4):>9}"
        for a in assessments:
            line += f"  {text(run.values.get(a.quantity), 7):>24}  {text(a.errors[k], 2):>8}"
        print(line)
    print()
    for a in assessments:
        unit = "" if a.unit == "1" else " " + a.unit
        print(f"{a.quantity}: {describe(a)}{unit if a.value is not None else ''}")
        for axis, c in zip(axes, a.along):
            if c is not None:
                order = f"order {c.order:.2f}" if c.order is not None else c.remark
                print(f"  with {axis.name}: {order}" + (f", uncertainty {text(c.uncertainty, 2)}{unit}" if c.uncertainty is not None else ""))
    print()
    for error, run in wanted:
        found = f"{run.combination.label} ({text(run.cost, 3)} core seconds)" if run else "none of these runs"
        print(f"cheapest for an error of {100 * error:g} %: {found}")


def describe(assessment):
    if assessment.value is None:
        return "the finest run has no value"
    kind = "extrapolated" if assessment.is_extrapolated else "finest"
    value = assessment.reference
    return f"{kind} {text(value, 7)}" + (f" +- {text(assessment.uncertainty, 2)}" if assessment.uncertainty is not None else "")
