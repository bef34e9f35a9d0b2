#!/usr/bin/python3
"""Cylinder swinging in fluid at rest, KC 5, Re 100: force, velocity profiles and Morison coefficients (about 2 core minutes; --quick 15 s)."""

import sys
from pathlib import Path

import h5py
import numpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import body_forces as forces  # noqa: E402
import stored_runs as runs  # noqa: E402

SCENE = HERE.parents[2] / "deploy" / "scenes" / "oscillating-cylinder" / "scene.txtpb"
SOURCE = "Duetsch, Durst, Becker, Lienhart 1998"
PERIOD, KEULEGAN_CARPENTER = 5.0, 5.0
PHASES, PLACES = (180, 210, 330), (-0.6, 0.0, 0.6, 1.2)
# Cells on a diameter, steps of time.step in a period, scheme. Adams-Bashforth halves those that are too long; the column dt has what was taken.
GRIDS = [(16, 240, "AUTO"), (32, 480, "AUTO"), (32, 480, "ADAMS_BASHFORTH"), (32, 1920, "ADAMS_BASHFORTH"), (64, 960, "AUTO")]
QUICK_GRIDS = GRIDS[:2]


def morison(time, force):
    """Drag and inertia coefficient of F = -rho D cd |u| u / 2 - pi rho D^2 ci du/dt / 4 (Morison et al. 1950), by least squares."""
    angle = 2 * numpy.pi * time / PERIOD
    velocity, acceleration = -numpy.cos(angle), 2 * numpy.pi / PERIOD * numpy.sin(angle)
    terms = numpy.stack([-0.5 * abs(velocity) * velocity, -0.25 * numpy.pi * acceleration], axis=1)
    return numpy.linalg.lstsq(terms, force, rcond=None)[0]


def profiles(folder):
    """(phase [deg], place) -> y, u, v of the last stored states at these phases; across x by the straight line between cell centres."""
    with h5py.File(folder / "results" / "flow.h5") as grid:
        x, y = ((faces[1:] + faces[:-1]) / 2 for faces in (grid[f"grid/flow/{axis}"][:] for axis in "xy"))
    found = {}
    for path in sorted((folder / "results").glob("flow.[0-9]*.h5")):
        with h5py.File(path) as state:
            phase = round(float(state["time"][0]) / PERIOD * 360) % 360
            if phase not in PHASES:
                continue
            velocity = state["flow/velocity"][0]
        for place in PLACES:
            i = numpy.searchsorted(x, place) - 1
            share = (place - x[i]) / (x[i + 1] - x[i])
            line = (1 - share) * velocity[:, i] + share * velocity[:, i + 1]
            found[phase, place] = (y, line[:, 0], line[:, 1])
    return found


def in_fluid(place, y, phase):
    """Which points lie outside the cylinder, with a margin for reading them off a figure."""
    centre = -KEULEGAN_CARPENTER / (2 * numpy.pi) * numpy.sin(numpy.radians(phase))
    return numpy.hypot(place - centre, y) > 0.52


def profile_rows(name, folder, measured, **varied):
    computed = profiles(folder)
    for component in "uv":
        deviations = []
        for (phase, place), (y, u, v) in computed.items():
            at, value = measured[component, phase, place]
            outside = in_fluid(place, at, phase)
            deviations.append(numpy.interp(at, y, u if component == "u" else v)[outside] - value[outside])
        every = numpy.concatenate(deviations)
        yield runs.row(name, f"profile_{component}_deviation_rms", numpy.sqrt((every**2).mean()), None,
                       f"{SOURCE}, {len(every)} points of 12 profiles [U]", folder, **varied)


def read_measured():
    """(component, phase, place) -> y, velocity [U]."""
    table = runs.read_reference(HERE / "profiles.csv", words=["component"])
    keys = list(zip(table["component"], table["phase"].astype(int), table["x"]))
    measured = {}
    for key in sorted(set(keys)):
        chosen = numpy.array([k == key for k in keys])
        measured[key] = (table["y"][chosen], table["velocity"][chosen])
    return measured


def draw(options, solved, reference, measured):
    time_of = {name: history["time"] for name, (history, _) in solved.items()}
    last = {name: time >= time[-1] - PERIOD for name, time in time_of.items()}
    curves = [(name, time_of[name][last[name]] / PERIOD % 1, solved[name][0]["body.cylinder.force_x"][last[name]], ".") for name in solved]
    curves = [(name, x[numpy.argsort(x)], y[numpy.argsort(x)], "-") for name, x, y, _ in curves]
    force = ("force along x", "t / T", "F / (rho U^2 D)", [*curves, (SOURCE, reference["t_over_T"], reference["F"], "ko")])
    forces.draw(Path(options.out) / "force.png", [force], 1)
    for component in "uv":
        panels = []
        computed = {name: profiles(folder) for name, (_, folder) in solved.items()}
        for phase in PHASES:
            for place in PLACES:
                lines = []
                for name, found in computed.items():
                    y, u, v = found[phase, place]
                    shown = numpy.where(in_fluid(place, y, phase), u if component == "u" else v, numpy.nan)
                    lines.append((name, shown, y, "-"))
                at, value = measured[component, phase, place]
                panels.append((f"phase {phase} deg, x = {place} D", f"{component} / U", "y / D", [*lines, (SOURCE, value, at, "ko")]))
        forces.draw(Path(options.out) / f"profiles_{component}.png", panels, len(PLACES))


def main():
    parser = runs.arguments(__doc__, "oscillating-cylinder")
    parser.add_argument("--quick", action="store_true", help="the coarse grid and the one of the band only")
    options = parser.parse_args()
    reference, measured = runs.read_reference(HERE / "force.csv"), read_measured()
    largest = abs(reference["F"]).max()
    rows, solved = [], {}
    for per_diameter, n_steps, scheme in QUICK_GRIDS if options.quick else GRIDS:
        step = PERIOD / n_steps
        name = f"{per_diameter}-{n_steps}-" + "".join(word[0] for word in scheme.lower().split("_"))
        if options.only and not any(name.startswith(start) for start in options.only):
            continue
        history, folder = solved[name] = forces.solve(options, SCENE, name, [f"time.step={step}", f"flow.navier_stokes.time_scheme={scheme}",
                                                                              *forces.fine_width(1 / per_diameter)])
        time, force = history["time"], history["body.cylinder.force_x"]
        last = time > time[-1] - PERIOD - step / 2
        ours = numpy.interp(time[-1] - PERIOD + reference["t_over_T"] * PERIOD, time[last], force[last])
        varied = {"mesh": f"D/h = {per_diameter}, borders at 20 D", "dt": forces.mean_step(history), "scheme": scheme}
        band = (0, 0.03) if per_diameter >= 32 else None
        rows += [runs.row(name, "force_deviation_max", abs(ours - reference["F"]).max() / largest, None,
                               f"{SOURCE}, 11 points, over the largest force", folder, band, **varied),
                      runs.row(name, "force_deviation_rms", numpy.sqrt(((ours - reference["F"]) ** 2).mean()) / largest, None,
                               f"{SOURCE}, 11 points, over the largest force", folder, **varied),
                      runs.row(name, "largest_force", abs(force[last]).max(), largest, f"{SOURCE}, the largest of the 11 points", folder, **varied)]
        drag, inertia = morison(time[last], force[last])
        rows.append(runs.row(name, "morison_drag", drag, 2.09, SOURCE, folder, **varied))
        rows.append(runs.row(name, "morison_inertia", inertia, 1.45, SOURCE, folder, **varied))
        rows.append(runs.row(name, "force_noise", forces.high_pass_rms(time[last], force[last], 0.02 * PERIOD) / largest, None,
                             "rms above a running mean over T/50, over the largest force", folder, **varied))
        rows += profile_rows(name, folder, measured, **varied)
    if solved:
        draw(options, solved, reference, measured)
    return runs.report(rows, options.json)


if __name__ == "__main__":
    sys.exit(main())
