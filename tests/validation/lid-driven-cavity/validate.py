#!/usr/bin/python3
"""Lid-driven cavity: velocities on the centre lines beside spectral and other published ones, Re 100, 400, 1000 (about 3 minutes)."""

import sys
from pathlib import Path

import numpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import stored_runs as runs  # noqa: E402

SCENE = HERE.parents[2] / "deploy" / "scenes" / "lid-driven-cavity" / "scene.txtpb"
TABLES = {"spectral": "Botella, Peyret 1998", "ghia": "Ghia, Ghia, Shin 1982"}
# Reynolds number: time until the flow is steady, grids, and on which of them deviations have a band.
CASES = {100: (20, [32, 64, 128], (128, 0.005)), 400: (50, [64, 128, 256], (128, 0.005)), 1000: (90, [64, 128, 256], (256, 0.01))}


def read_points(table, reynolds):
    """Component, place and published value of the points of a table at a Reynolds number."""
    columns = runs.read_reference(HERE / f"{table}.csv", words=["component"])
    chosen = columns["reynolds"] == reynolds
    return [columns[name][chosen] for name in ("component", "x", "y", "value")]


def solve(reynolds, end, cells, points, options):
    """Velocities at the points when the flow is steady, how much they changed last, and the folder of the run."""
    settings = [f"flow.fluid.viscosity={1 / reynolds}", f"time.end={end}", "output.results_interval=1000"]
    settings += [f"flow.navier_stokes.grid.{axis}.uniform.cells={cells}" for axis in "xy"]
    settings += [f'flow.navier_stokes.probe[{i + 1}]={{name: "p{i}" at {{x: {x} y: {y}}}}}' for i, (_, x, y) in enumerate(points)]
    folder = Path(options.out).resolve() / f"Re{reynolds}-{cells}"
    code = runs.run(options.couplet, SCENE, folder, settings + options.set, ["--flow-ranks", "1"])
    if code != 0:
        sys.exit(f"Re{reynolds}-{cells}: exit code {code}: {runs.last_words(folder)}")
    history = runs.read_history(folder)
    columns = numpy.array([history[f"p{i}.velocity_{component}"] for i, (component, _, _) in enumerate(points)])
    second = history["time"] >= history["time"][-1] - 1
    return columns[:, -1], numpy.ptp(columns[:, second], axis=1).max(), folder


def main():
    options = runs.arguments(__doc__, "lid-driven-cavity").parse_args()
    rows = []
    for reynolds, (end, grids, (gated, band)) in CASES.items():
        if options.only and f"Re{reynolds}" not in options.only:
            continue
        tables = {name: read_points(name, reynolds) for name in TABLES}
        points = [point for component, x, y, _ in tables.values() for point in zip(component, x, y)]
        solved = {cells: solve(reynolds, end, cells, points, options) for cells in grids}
        # Second order: what is left on the finest grid is a third of the last change.
        extrapolated = solved[grids[-1]][0] + (solved[grids[-1]][0] - solved[grids[-2]][0]) / 3
        for cells, (ours, change, folder) in solved.items():
            name, limit = f"Re{reynolds}-{cells}", (0, band) if cells == gated else None
            varied = {"mesh": f"{cells}^2"}
            first = 0
            for table, (component, x, y, value) in tables.items():
                part = slice(first, first + len(value))
                first += len(value)
                if not len(value):
                    continue
                deviation = numpy.abs(ours[part] - value)
                where = f"worst at x = {x[deviation.argmax()]:.4g}, y = {y[deviation.argmax()]:.4g}"
                itself = numpy.abs(extrapolated[part] - value).max()
                rows.append(runs.row(name, f"deviation_from_{table}", deviation.max(), None,
                                     f"{TABLES[table]}; {where}; extrapolated: {itself:.4f}", folder, limit if table == "spectral" else None, **varied))
            rows.append(runs.row(name, "deviation_from_extrapolated", numpy.abs(ours - extrapolated).max(), None, "three grids, second order", folder,
                                 limit, **varied))
            rows.append(runs.row(name, "change_in_the_last_second", change, None, "0 when the flow is steady", folder, **varied))
        print(f"  Re {reynolds} done", flush=True)
    return runs.report(rows, options.json)


if __name__ == "__main__":
    sys.exit(main())
