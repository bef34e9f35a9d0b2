"""The channel of Turek and Hron with a flag behind a cylinder, rigid or elastic, on finer and finer grids."""

from pathlib import Path

import numpy

import body_forces as forces
import stored_runs as runs

SCENES = Path(__file__).resolve().parents[2] / "deploy" / "scenes"
SOURCE = "Turek, Hron 2006; featflow tables"
# Width of the cells around the flag [m], cells across the channel: no face lies along the flag.
GRIDS = {"10": (0.005, 83), "20": (0.0025, 167), "40": (0.00125, 333)}  # by cells on the diameter
# Scene, mean inflow [m/s], end [s], step on the coarsest grid [s], start of what is measured [s], depth [m].
CASES = {"CFD1": ("turek-hron-cfd", 0.2, 10, 0.02, 9.9, 1), "CFD2": ("turek-hron-cfd", 1, 10, 0.01, 9.9, 1),
         "CFD3": ("turek-hron-cfd", 2, 8, 0.005, 6.5, 1), "FSI1": ("turek-hron-fsi1", 0.2, 10, 0.01, 9.9, 0.01),
         "FSI2": ("turek-hron-fsi2", 1, 15, 0.004, 12, 0.01)}
FINEST = {"CFD1": "40", "CFD2": "40", "CFD3": "40", "FSI1": "40", "FSI2": "20"}
QUICK = {"CFD1": ["10", "20"], "CFD2": ["10"], "FSI1": ["10"]}
# Relative, on the finest grid that is run: what the numbers must reach. Why: reference.md of each.
BANDS = {("CFD1", "drag_mean"): 0.01, ("CFD1", "lift_mean"): 0.01, ("CFD2", "drag_mean"): 0.01, ("CFD2", "lift_mean"): 0.01,
         ("CFD3", "drag_mean"): 0.01, ("CFD3", "lift_amplitude"): 0.02, ("CFD3", "lift_frequency"): 0.01,
         ("FSI1", "ux_mean"): 0.01, ("FSI1", "uy_mean"): 0.01, ("FSI1", "drag_mean"): 0.01, ("FSI1", "lift_mean"): 0.01,
         ("FSI2", "uy_amplitude"): 0.03, ("FSI2", "uy_frequency"): 0.015, ("FSI2", "drag_mean"): 0.015}


def middle_and_swing(time, value):
    """(max + min) / 2 and (max - min) / 2 over the whole cycles, and the frequency, as the tables define them."""
    first, last, cycles = forces.whole_cycles(time, value)
    inside = value[(time >= first) & (time <= last)]
    return (inside.max() + inside.min()) / 2, numpy.ptp(inside) / 2, cycles / (last - first)


def curves(history, depth):
    found = {name: sum(history[f"body.{body}.force_{axis}"] for body in ("cylinder", "flag")) / depth
             for name, axis in (("drag", "x"), ("lift", "y"))}
    return found | {f"u{axis}": history[f"A.{axis}"] for axis in "xy" if f"A.{axis}" in history}


def rows_of(options, case, grid, reference):
    scene, speed, end, step, start, depth = CASES[case]
    width, cells = GRIDS[grid]
    step *= 10 / float(grid)
    inflow = f"1.5*{speed}*4*y*(0.41-y)/0.41^2*(1-cos(pi*min(t,2)/2))/2"
    settings = [f"time.step={step:g}", f"time.end={end}", *forces.fine_width(width, "x"), f"flow.navier_stokes.grid.y.uniform.cells={cells}",
                f'flow.navier_stokes.border.x_start.velocity.expression.x="{inflow}"', f"output.results_interval={end}"]
    name = f"{case}-{grid}"
    history, folder = forces.solve(options, SCENES / scene / "scene.txtpb", name, settings, ranks=options.ranks if grid == "40" else 1)
    varied = {"mesh": f"D/h = {grid}", "dt": step}
    late = history["time"] >= start
    band_of = lambda quantity, value: None if (case, quantity) not in BANDS or grid != FINEST[case] else \
        tuple(sorted(value * (1 + side * BANDS[case, quantity]) for side in (-1, 1)))
    found = {}
    for curve, value in curves(history, depth).items():
        if case in ("CFD3", "FSI2"):
            found |= dict(zip((f"{curve}_mean", f"{curve}_amplitude", f"{curve}_frequency"), middle_and_swing(history["time"][late], value[late])))
        else:
            # Over the last 0.1 s: what is left of the coupling iterations moves the flag by 1e-9 m a step, whose acceleration takes 1 % of lift.
            mean = found[f"{curve}_mean"] = value[late].mean()
            yield runs.row(name, f"{curve}_change", numpy.ptp(value[late]) / abs(mean), None, "of the last 0.1 s; 0 when it is steady", folder, **varied)
    for (of, quantity), value in reference.items():
        if of == case:
            yield runs.row(name, quantity, found[quantity], value, SOURCE, folder, band_of(quantity, value), **varied)
    if "iterations" in history:
        yield runs.row(name, "iterations_mean", history["iterations"][late].mean(), None, "coupling iterations of a step", folder, **varied)
        yield runs.row(name, "iterations_most", history["iterations"][late].max(), None, "", folder, **varied)
        yield runs.row(name, "shortest_step", history["dt"].min() / step, None, "over the given step; 1: none was cut", folder, **varied)


def draw(options):
    """Lift and tip of the cases that swing, grid beside grid."""
    panels = []
    for case, quantity, label in (("CFD3", "lift", "lift [N/m]"), ("FSI2", "uy", "uy of the tip [m]"), ("FSI2", "drag", "drag [N/m]")):
        drawn = []
        for grid in GRIDS:
            folder = Path(options.out).resolve() / f"{case}-{grid}"
            if (folder / "exit_code.txt").exists() and (folder / "exit_code.txt").read_text() == "0":
                history = runs.read_history(folder)
                late = history["time"] > history["time"][-1] - 1.5
                drawn.append((f"D/h = {grid}", history["time"][late], curves(history, CASES[case][5])[quantity][late], "-"))
        if drawn:
            panels.append((case, "t [s]", label, drawn))
    if panels:
        forces.draw(Path(options.out).resolve() / "swings.png", panels, 1)


def validate(doc, folder, cases):
    """What `couplet validate` runs for some of the cases; the exit code."""
    parser = runs.arguments(doc, folder.name)
    parser.add_argument("--quick", action="store_true", help="coarse grids of the steady cases")
    parser.add_argument("--ranks", type=int, default=2, help="MPI ranks of the flow on the finest grid")
    options = parser.parse_args()
    table = runs.read_reference(folder / "reference.csv", words=["case", "quantity"])
    reference = dict(zip(zip(table["case"], table["quantity"]), table["value"]))
    chosen = {}
    for case in cases:
        for grid in GRIDS:
            name = f"{case}-{grid}"
            if options.quick and grid not in QUICK.get(case, []) or int(grid) > int(FINEST[case]):
                continue
            if options.only and not any(name.startswith(start) for start in options.only):
                continue
            chosen[name] = lambda c=case, g=grid: rows_of(options, c, g, reference)
    code = runs.report_cases(chosen, options.json)
    draw(options)
    return code
