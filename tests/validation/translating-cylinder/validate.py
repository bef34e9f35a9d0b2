#!/usr/bin/python3
"""A cylinder moving through fluid at rest beside the same cylinder at rest in a stream, Re 40 (about 3 core minutes; --quick 15 s)."""

import sys
from pathlib import Path

import numpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import body_forces as forces  # noqa: E402
import stored_runs as runs  # noqa: E402

SCENE = HERE.parents[2] / "deploy" / "scenes" / "translating-cylinder" / "scene.txtpb"
# The same grid and body, which rests in the middle of the fine cells while the fluid passes it.
AT_REST = ["flow.navier_stokes.body[0].joint[0].translation.x.expression=0", "flow.navier_stokes.border.x_start.velocity.constant.x=1",
           "flow.navier_stokes.initial.velocity.x=1"]
# The places of the cylinder at rest, in cells. What is compared is the mean over them: a moving cylinder passes through them all.
PLACES = (0, 0.25, 0.5, 0.75)
# Cells on a diameter, time.step, scheme. Adams-Bashforth halves the steps of 0.25 cells; the column dt has what was taken.
GRIDS = [(12.5, 0.02, "AUTO"), (25, 0.01, "AUTO"), (25, 0.02, "RUNGE_KUTTA"), (25, 0.005, "RUNGE_KUTTA"), (25, 0.01, "ADAMS_BASHFORTH"),
         (25, 0.0025, "ADAMS_BASHFORTH"), (50, 0.005, "AUTO")]
QUICK_GRIDS = GRIDS[:2]
# Both flows start with a jump, whose viscous force falls like 1/sqrt(t); compared once half a diameter has passed, and later.
TIMES = (0.5, 1, 2, 3, 4, 5)
WINDOW = 0.16  # four cells of 25 a diameter: the force of a moving body varies with the passage from cell to cell
SOURCE = "mean over the places of the cylinder at rest in a stream"


def around(time, value, middle):
    """Mean over a window that ends at most at the end of the run."""
    end = min(middle + WINDOW / 2, time[-1])
    return value[(time > end - WINDOW - 1e-9) & (time <= end + 1e-9)].mean()


def main():
    parser = runs.arguments(__doc__, "translating-cylinder")
    parser.add_argument("--quick", action="store_true", help="without the finest grid and the smaller step")
    options = parser.parse_args()
    rows, curves = [], []
    for per_diameter, step, scheme in QUICK_GRIDS if options.quick else GRIDS:
        short = "".join(word[0] for word in scheme.lower().split("_"))
        name = f"{per_diameter:g}-{step:g}-{short}"
        if options.only and not any(name.startswith(start) for start in options.only):
            continue
        settings = [f"time.step={step}", f"flow.navier_stokes.time_scheme={scheme}", *forces.fine_width(1 / per_diameter)]
        moving, folder = forces.solve(options, SCENE, f"{name}-moving", settings)
        at_rest = [forces.solve(options, SCENE, f"{name}-resting-{place:g}",
                                [*settings, *AT_REST, f"flow.navier_stokes.body[0].cylinder.centre.x={place / per_diameter}"])[0] for place in PLACES]
        varied = {"mesh": f"D/h = {per_diameter:g}, sides at 20 D", "dt": forces.mean_step(moving), "scheme": scheme}
        time, ours = moving["time"], 2 * moving["body.cylinder.force_x"]
        of_places = numpy.array([numpy.interp(time, run["time"], 2 * run["body.cylinder.force_x"]) for run in at_rest])
        expected = of_places.mean(axis=0)
        for middle in TIMES:
            value, of_resting = around(time, ours, middle), around(time, expected, middle)
            band = (of_resting * 0.99, of_resting * 1.01) if per_diameter >= 25 else None
            rows.append(runs.row(name, f"drag_coefficient_at_{middle:g}", value, of_resting, SOURCE, folder, band, **varied))
        late = time >= 0.5
        spread = (numpy.ptp(of_places, axis=0) / expected)[late].mean()
        rows.append(runs.row(name, "drag_spread_of_places", spread, None, "largest minus smallest over the mean, at rest", folder, **varied))
        noise = forces.high_pass_rms(time[late], ours[late], 0.1)
        rows.append(runs.row(name, "drag_noise", noise, None, "rms above a running mean over 0.1", folder, **varied))
        curves += [(f"moving, {name}", time, ours, "-"), (f"at rest, {name}", time, expected, "--")]
    if curves:
        shown = [(label, time[time > 0.05], drag[time > 0.05], style) for label, time, drag, style in curves]
        forces.draw(Path(options.out) / "drag.png", [("drag after a sudden start, Re 40", "t U / D", "drag coefficient", shown)], 1)
    return runs.report(rows, options.json)


if __name__ == "__main__":
    sys.exit(main())
