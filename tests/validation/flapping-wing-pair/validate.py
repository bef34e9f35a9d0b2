#!/usr/bin/python3
"""Flapping wing pair in forward flight: forces over a beat on ever finer grids, ranks, cost (about 25 core minutes; --quick 1)."""

import json
import sys
from pathlib import Path

import numpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import body_forces as forces  # noqa: E402
import stored_runs as runs  # noqa: E402

SCENE = HERE.parents[2] / "deploy" / "scenes" / "flapping-wing-pair" / "scene.txtpb"
FREQUENCY = 45.5
# Width of the cells around the bird [m], Reynolds number, beats.
GRIDS = [(0.002, 300, 2), (0.0015, 300, 2), (0.001, 300, 2), (0.001, 1000, 2)]
QUICK_GRIDS = [(0.002, 300, 1)]
VISCOSITY_TIMES_REYNOLDS = 0.1158  # [Pa s]
# 25 cores take 333.7 s a step for 600 x 500 x 400 cells with the bird (a dissertation, chapter 2; see reference.md).
PUBLISHED_COST = 333.7 * 25 / (600 * 500 * 400) * 1e6  # [us]
RANKS = (1, 2, 4, 8)
# Sums over ranks round differently, the pressure is solved for almost to round-off. Over the first ten steps forces agree to 1e-12; then, on
# cells as coarse as these, differences grow with the flow, tenfold in three steps.
TIGHT = ["flow.navier_stokes.pressure.relative_tolerance=1e-8", "flow.navier_stokes.pressure.divergence_tolerance=1e-12"]
SAME = 1e-6


def settings_for(width, reynolds, beats):
    return [f'title="flapping wing pair, Re = {reynolds}, {1e3 * width:g} mm cells"', f"time.end={beats / FREQUENCY:.9g}",
            f"flow.fluid.viscosity={VISCOSITY_TIMES_REYNOLDS / reynolds:.6g}", "output.results_start=0",
            *forces.fine_width(width, "xyz")]


def force_rows(options, width, reynolds, beats):
    name = f"Re{reynolds}-{1e3 * width:g}mm"
    history, folder = forces.solve(options, SCENE, name, settings_for(width, reynolds, beats), options.ranks)
    beat = history["time"] * FREQUENCY
    last = beat > beat[-1] - 1
    varied = {"mesh": f"{1e3 * width:g} mm", "dt": forces.mean_step(history), "beats": beats}
    weight = "the bird weighs 0.028 N, of which this motion is not the one that bears it"
    # Both wings; the stroke goes down in the first half of a beat.
    lift, thrust = 2 * history["body.wing.force_z"], -2 * history["body.wing.force_x"]
    down = (beat % 1) < 0.5
    for quantity, value, source in [
        ("vertical_force_mean", lift[last].mean(), weight),
        ("vertical_force_down", lift[last & down].mean(), "mean of the downstroke"),
        ("vertical_force_up", lift[last & ~down].mean(), "mean of the upstroke: below 0 in fast flight"),
        ("thrust_mean", thrust[last].mean(), ""),
        ("trunk_drag_mean", 2 * history["body.trunk.force_x"][last].mean(), ""),
        ("largest_speed", history["flow.largest_speed"].max(), "of the fluid, at edges; tips move at 13 m/s, the stream at 8.3"),
        ("force_noise", forces.high_pass_rms(beat[last], lift[last], 0.02) / numpy.abs(lift[last]).max(), "rms above a running mean over T/50, over the largest force"),
    ]:
        yield runs.row(name, quantity, value, None, source, folder, **varied)
    summary = json.loads((folder / "summary.json").read_text())["programs"]["flow-server"]
    cost = 1e6 * summary["core_seconds"] / (summary["cells"] * summary["substeps"])
    yield runs.row(name, "us_per_cell_and_step", cost, PUBLISHED_COST, "core time of a dissertation's code (cluster of 2017-2019)", folder,
                   (0, PUBLISHED_COST), **varied, cells=summary["cells"])
    draw(folder, Path(options.out).resolve() / f"{name}.png", history)


def rank_rows(options):
    histories = {}
    for ranks in RANKS:
        settings = settings_for(0.004, 300, 1) + TIGHT + ["output.results_interval=1", f"time.end={24 * 2.1978022e-5:.9g}"]
        histories[ranks], folder = forces.solve(options, SCENE, f"ranks-{ranks}", settings, ranks)
    alone = histories[1]
    for ranks in RANKS[1:]:
        largest = 0.0
        for name, values in alone.items():
            if ".force_" in name or name == "flow.largest_speed":
                scale = max(numpy.abs(alone[other]).max() for other in alone if other.split(".")[:2] == name.split(".")[:2])
                largest = max(largest, numpy.abs(histories[ranks][name] - values).max() / scale)
        yield runs.row("ranks", f"deviation_on_{ranks}", largest, None, "of forces and speed from those on one rank, relative", folder, (0, SAME),
                       mesh="4 mm")


def draw(folder, path, history):
    """Vorticity and vortices (positive Q) at four times of the last beat, and the forces."""
    import h5py
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    files = sorted((folder / "results").glob("flow.[0-9]*.h5"))[-8::2]
    with h5py.File(folder / "results" / "flow.h5") as grid:
        x, y, z = (1e3 * numpy.asarray(grid["grid/flow"][axis]) for axis in "xyz")
    figure, axes = pyplot.subplots(len(files) + 1, 3, figsize=(16, 4 * len(files) + 4), constrained_layout=True)
    for axis, name in zip(axes, files):
        with h5py.File(name) as file:
            vorticity, q = numpy.asarray(file["flow/vorticity"]), numpy.clip(file["flow/q_criterion"], 0, None)
            beat = float(file["time"][0]) * FREQUENCY
        middle = numpy.searchsorted(y, 25) - 1
        scale = 3e3
        axis[0].pcolormesh(x, z, vorticity[:, middle, :, 1], cmap="RdBu_r", vmin=-scale, vmax=scale)
        axis[0].set(title=f"t/T = {beat:.2f}: vorticity along y at y = 25 mm", xlabel="x [mm]", ylabel="z [mm]")
        behind = numpy.searchsorted(x, 40) - 1
        axis[1].pcolormesh(y, z, vorticity[:, :, behind, 0], cmap="RdBu_r", vmin=-scale, vmax=scale)
        axis[1].set(title="vorticity along x at x = 40 mm", xlabel="y [mm]", ylabel="z [mm]")
        axis[2].pcolormesh(x, z, numpy.sqrt(q.max(axis=1)), cmap="magma", vmin=0, vmax=2e3)
        axis[2].set(title="root of the largest Q along y", xlabel="x [mm]", ylabel="z [mm]")
        for one in axis:
            one.set_aspect("equal")
    beat = history["time"] * FREQUENCY
    for axis, what in zip(axes[-1], ("z", "x", None)):
        if what is None:
            axis.plot(beat, history["flow.largest_speed"])
            axis.set(title="largest speed [m/s]", xlabel="t/T")
            continue
        for body in ("wing", "trunk"):
            axis.plot(beat, 2 * history[f"body.{body}.force_{what}"], label=body)
        limit = 2.2 * numpy.abs(history[f"body.wing.force_{what}"][len(beat) // 50:]).max()
        axis.set(title=f"force along {what}, both halves [N]", xlabel="t/T", ylim=(-limit, limit))
        axis.legend()
    figure.savefig(path, dpi=80)
    pyplot.close(figure)
    print(f"  picture: {path}", flush=True)


def main():
    parser = runs.arguments(__doc__, "flapping-wing-pair")
    parser.add_argument("--quick", action="store_true", help="one beat on the coarsest grid")
    parser.add_argument("--ranks", type=int, default=runs.cores(), help="MPI ranks of the flow")
    options = parser.parse_args()
    cases = {"ranks": lambda: rank_rows(options)}
    for width, reynolds, beats in QUICK_GRIDS if options.quick else GRIDS:
        cases[f"Re{reynolds}-{1e3 * width:g}mm"] = lambda w=width, r=reynolds, b=beats: force_rows(options, w, r, b)
    chosen = {name: case for name, case in cases.items() if not options.only or any(name.startswith(start) for start in options.only)}
    return runs.report_cases(chosen, options.json)


if __name__ == "__main__":
    sys.exit(main())
