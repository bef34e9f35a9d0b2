#!/usr/bin/python3
"""Sphere in a stream, Re 100: drag and wake length on two grids (about 4 core minutes; --quick half a minute)."""

import sys
from pathlib import Path

import numpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import body_forces as forces  # noqa: E402
import stored_runs as runs  # noqa: E402

SCENE = HERE.parents[2] / "deploy" / "scenes" / "sphere" / "scene.txtpb"
CHOSEN = {"drag_coefficient": "Mittal 1999", "wake_length": "Mittal 1999"}
BANDS = {"drag_coefficient": (1.08, 1.11)}
# Cells on a diameter, how many diameters the borders in front and at the sides are away, and by how much of a cell along x the sphere stands
# off the crossing of faces.
GRIDS = [(10, 10, 0), (10, 20, 0), (10, 10, 0.5), (20, 10, 0)]
QUICK_GRIDS = GRIDS[:1]
# Places on the axis behind the sphere between which the velocity changes its sign [D].
WAKE = numpy.linspace(1, 2, 11)


def name_of(per_diameter, sides, place):
    return f"Re100-{per_diameter}" + ("" if sides == 10 else f"-sides{sides}") + (f"-off{place}" if place else "")


def rows_of(options, per_diameter, sides, place, reference, ranks):
    name, shift = name_of(per_diameter, sides, place), place / per_diameter
    settings = forces.fine_width(1 / per_diameter, "xyz")
    settings += [f'flow.navier_stokes.probe[{i}]={{name: "p{i}" at {{x: {x + shift}}}}}' for i, x in enumerate(WAKE)]
    if sides != 10:
        settings += [f"flow.navier_stokes.grid.{axis}.stretched.start={-sides}" for axis in "xyz"]
        settings += [f"flow.navier_stokes.grid.{axis}.stretched.end={sides}" for axis in "yz"]
    if place:
        settings.append(f"flow.navier_stokes.body[0].ellipsoid.centre.x={shift}")
    history, folder = forces.solve(options, SCENE, name, settings, ranks)
    drag = history["body.sphere.force_x"] * 8 / numpy.pi
    varied = {"mesh": f"D/h = {per_diameter}, front and sides at {sides} D", "dt": forces.mean_step(history)}
    velocity = numpy.array([history[f"p{i}.velocity_x"][-1] for i in range(len(WAKE))])
    end = numpy.interp(0, velocity, WAKE) if velocity[0] < 0 < velocity[-1] else numpy.nan
    for quantity, value in {"drag_coefficient": drag[-1], "wake_length": end - 0.5}.items():
        published = {paper: number for (what, paper), number in reference.items() if what == quantity}
        source = f"{CHOSEN[quantity]}; all: {min(published.values()):g} to {max(published.values()):g}"
        band = BANDS.get(quantity) if per_diameter >= 16 else None
        yield runs.row(name, quantity, value, published[CHOSEN[quantity]], source, folder, band, **varied)
    last = history["time"] >= history["time"][-1] - 5
    yield runs.row(name, "change_of_drag", numpy.ptp(drag[last]), None, "in the last 5 of time; 0 when the flow is steady", folder, **varied)
    side = numpy.hypot(history["body.sphere.force_y"][-1], history["body.sphere.force_z"][-1]) * 8 / numpy.pi
    yield runs.row(name, "side_force_coefficient", side, None, "0 by symmetry", folder, **varied)


def main():
    parser = runs.arguments(__doc__, "sphere")
    parser.add_argument("--quick", action="store_true", help="the coarse grid only")
    parser.add_argument("--ranks", type=int, default=runs.cores(), help="MPI ranks of the flow")
    options = parser.parse_args()
    table = runs.read_reference(HERE / "reference.csv", words=["quantity", "source"])
    reference = dict(zip(zip(table["quantity"], table["source"]), table["value"]))
    cases = {}
    for per_diameter, sides, place in QUICK_GRIDS if options.quick else GRIDS:
        name = name_of(per_diameter, sides, place)
        if options.only and not any(name.startswith(start) for start in options.only):
            continue
        cases[name] = lambda n=per_diameter, s=sides, p=place: rows_of(options, n, s, p, reference, options.ranks)
    return runs.report_cases(cases, options.json)


if __name__ == "__main__":
    sys.exit(main())
