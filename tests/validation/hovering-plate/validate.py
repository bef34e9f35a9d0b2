#!/usr/bin/python3
"""Hovering plate, Re 75: lift and drag of an ellipse and of a thin sheet beside published histories (about 10 core minutes; --quick 15 s)."""

import sys
from pathlib import Path

import numpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import body_forces as forces  # noqa: E402
import stored_runs as runs  # noqa: E402

SCENES = HERE.parents[2] / "deploy" / "scenes" / "hovering-plate"
SHAPES = {"ellipse": "scene.txtpb", "sheet": "sheet.txtpb"}
PUBLISHED = {"wang-2004": "Wang, Birch, Dickinson 2004, robotic wing", "eldredge-2007": "Eldredge 2007, vortex particles",
             "li-2015": "Li, Dong, Liu 2015, immersed boundary"}
PERIOD, CHORD, STROKE = 4.0, 1.0, 2.8
SPEED = numpy.pi * STROKE / PERIOD
# The largest quasi-steady forces, at the middle of a stroke with 45 degrees of incidence: C_L = 1.2 sin(2 a), C_D = 1.4 - cos(2 a).
LARGEST_LIFT, LARGEST_DRAG = (0.5 * SPEED**2 * CHORD * factor for factor in (1.2, 1.4))
# Cells on the chord, time.step.
GRIDS, QUICK_GRIDS = [(20, 0.02), (40, 0.02), (80, 0.01)], [(20, 0.02)]


def coefficients(history):
    """Time over period, and drag (against the motion) and lift over the largest quasi-steady ones."""
    time = history["time"] / PERIOD
    against = numpy.sign(numpy.sin(2 * numpy.pi * time))
    return time, {"drag_coefficient": against * history["body.wing.force_x"] / LARGEST_DRAG, "lift_coefficient": history["body.wing.force_y"] / LARGEST_LIFT}


def mean_over_strokes(time, value):
    """Mean over the second to the fourth stroke to and fro, by the trapezoidal rule on the samples inside."""
    inside = (time >= 1) & (time <= 4)
    return numpy.trapz(value[inside], time[inside]) / (time[inside][-1] - time[inside][0])


def rows_of(name, history, folder, reference, **varied):
    time, ours = coefficients(history)
    for quantity, value in ours.items():
        for key, source in PUBLISHED.items():
            at, published = reference[key, quantity]
            # Drag changes its sign by definition where the stroke turns: what is read off a figure there says nothing.
            from_turn = abs((at + 0.25) % 0.5 - 0.25)
            inside = (at >= 1) & (at <= time[-1]) & (from_turn > 0.03)
            deviation = numpy.interp(at[inside], time, value) - published[inside]
            yield runs.row(name, f"{quantity}_rms_deviation", numpy.sqrt((deviation**2).mean()) / numpy.sqrt((published[inside] ** 2).mean()), None,
                           f"{source}; over the rms of the published", folder, **varied)
            yield runs.row(name, f"{quantity}_mean", mean_over_strokes(time, value), mean_over_strokes(at, published), source, folder, **varied)
        late = time >= 1
        force = history["body.wing.force_x"] / LARGEST_DRAG if quantity == "drag_coefficient" else value
        yield runs.row(name, f"{quantity}_noise", forces.high_pass_rms(time[late], force[late], 0.02), None,
                       "rms above a running mean over T/50", folder, **varied)


def main():
    parser = runs.arguments(__doc__, "hovering-plate")
    parser.add_argument("--quick", action="store_true", help="the coarse grid only")
    options = parser.parse_args()
    table = runs.read_reference(HERE / "coefficients.csv", words=["source", "quantity"])
    reference = {}
    for key in PUBLISHED:
        for quantity in ("drag_coefficient", "lift_coefficient"):
            chosen = (table["source"] == key) & (table["quantity"] == quantity)
            reference[key, quantity] = (table["t_over_T"][chosen], table["value"][chosen])
    rows, curves = [], {"drag_coefficient": [], "lift_coefficient": []}
    for per_chord, step in QUICK_GRIDS if options.quick else GRIDS:
        for shape, scene in SHAPES.items():
            name = f"{shape}-{per_chord}"
            if options.only and not any(name.startswith(start) for start in options.only):
                continue
            history, folder = forces.solve(options, SCENES / scene, name, [f"time.step={step}", *forces.fine_width(CHORD / per_chord)])
            rows += rows_of(name, history, folder, reference, mesh=f"c/h = {per_chord}, borders at 15 c", dt=forces.mean_step(history))
            time, ours = coefficients(history)
            for quantity, value in ours.items():
                curves[quantity].append((name, time, value, "-"))
    if rows:
        panels = []
        for quantity, lines in curves.items():
            published = [(source, *reference[key, quantity], "--") for key, source in PUBLISHED.items()]
            panels.append((quantity.replace("_", " "), "t / T", "over the largest quasi-steady", [*lines, *published]))
        forces.draw(Path(options.out) / "coefficients.png", panels, 1)
    return runs.report(rows, options.json)


if __name__ == "__main__":
    sys.exit(main())
