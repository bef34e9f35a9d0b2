#!/usr/bin/python3
"""Cylinder in a stream, Re 40 and 100: drag, wake, lift and shedding beside published values (about 6 core minutes; --quick 1)."""

import sys
from pathlib import Path

import numpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import body_forces as forces  # noqa: E402
import stored_runs as runs  # noqa: E402

SCENE = HERE.parents[2] / "deploy" / "scenes" / "cylinder" / "scene.txtpb"
CHOSEN = "Linnick, Fasel 2005"
# Why these: reference.md.
BANDS = {(40, "drag_coefficient"): (1.50, 1.56), (40, "wake_length"): (2.20, 2.30), (100, "drag_coefficient"): (1.32, 1.36),
         (100, "lift_amplitude"): (0.32, 0.34), (100, "strouhal_number"): (0.164, 0.167)}
# Cells on a diameter, how many diameters the borders at the sides are away, and by how much of a cell the body stands off the crossing of
# two faces along x. The scene says how far the borders in front and behind are.
GRIDS = [(12.5, 30, 0), (25, 30, 0), (25, 30, 0.5), (25, 60, 0), (50, 30, 0), (50, 30, 0.5)]
QUICK_GRIDS = GRIDS[:2]
# Places on the axis behind the body between which the velocity changes its sign [D].
WAKE = numpy.linspace(2, 3.6, 9)


def name_of(reynolds, per_diameter, sides, place):
    return f"Re{reynolds}-{per_diameter:g}" + ("" if sides == 30 else f"-sides{sides}") + (f"-off{place}" if place else "")


def rows_of(options, reynolds, per_diameter, sides, place, reference):
    name, shift = name_of(reynolds, per_diameter, sides, place), place / per_diameter
    settings = [f"flow.fluid.viscosity={1 / reynolds}", *forces.fine_width(1 / per_diameter)]
    settings += [f"flow.navier_stokes.grid.y.stretched.start={-sides}", f"flow.navier_stokes.grid.y.stretched.end={sides}"]
    settings += [f'flow.navier_stokes.probe[{i}]={{name: "p{i}" at {{x: {x + shift}}}}}' for i, x in enumerate(WAKE)]
    if place:
        settings.append(f"flow.navier_stokes.body[0].cylinder.centre.x={shift}")
    if reynolds == 100:
        # A gust beside the wake starts the shedding.
        settings += ['flow.navier_stokes.initial.velocity.y="0.3*exp(-((x-1)^2+(y-1)^2))"', "time.end=120"]
    history, folder = forces.solve(options, SCENE, name, settings)
    time, drag, lift = history["time"], 2 * history["body.cylinder.force_x"], 2 * history["body.cylinder.force_y"]
    varied = {"mesh": f"D/h = {per_diameter:g}, sides at {sides} D", "dt": forces.mean_step(history)}
    late = time >= time[-1] - 40
    # The force by a second, independent way: from the momentum of the fluid in a box around the body. Means, as it is one over a step.
    last = late if reynolds == 100 else time >= time[-1] - 5
    at_surface, by_momentum = drag[last].mean(), 2 * history["around.force_balance_x"][last].mean()
    agreed = (0.97 * at_surface, 1.03 * at_surface) if per_diameter >= 25 else None
    yield runs.row(name, "drag_by_momentum", by_momentum, at_surface, "force at the surface of the same run", folder, agreed, **varied)
    if reynolds == 100:
        found = forces.shedding(time[late], drag[late], lift[late])
    else:
        velocity = numpy.array([history[f"p{i}.velocity_x"][-1] for i in range(len(WAKE))])
        end = numpy.interp(0, velocity, WAKE) if velocity[0] < 0 < velocity[-1] else numpy.nan
        found = {"drag_coefficient": drag[-1], "wake_length": end - 0.5}
        yield runs.row(name, "change_of_drag", numpy.ptp(drag[last]), None, "in the last 5 of time; 0 when the flow is steady", folder, **varied)
    for quantity, value in found.items():
        published = {paper: number for (of, what, paper), number in reference.items() if (of, what) == (reynolds, quantity)}
        source = f"{CHOSEN}; all: {min(published.values()):g} to {max(published.values()):g}"
        band = BANDS[reynolds, quantity] if per_diameter >= 25 else None
        yield runs.row(name, quantity, value, published[CHOSEN], source, folder, band, **varied)


def main():
    parser = runs.arguments(__doc__, "cylinder")
    parser.add_argument("--quick", action="store_true", help="without the finest grid and the wider box")
    options = parser.parse_args()
    table = runs.read_reference(HERE / "reference.csv", words=["quantity", "source"])
    reference = dict(zip(zip(table["reynolds"], table["quantity"], table["source"]), table["value"]))
    cases = {}
    for reynolds in (40, 100):
        for per_diameter, sides, place in QUICK_GRIDS if options.quick else GRIDS:
            name = name_of(reynolds, per_diameter, sides, place)
            if options.only and not any(name.startswith(start) for start in options.only):
                continue
            cases[name] = lambda r=reynolds, n=per_diameter, s=sides, p=place: rows_of(options, r, n, s, p, reference)
    return runs.report_cases(cases, options.json)


if __name__ == "__main__":
    sys.exit(main())
