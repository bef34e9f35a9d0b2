"""What the page of a flow shows of the bodies in it: outlines in the pictures of its fields, forces, moments and power over time."""

import numpy
from matplotlib.collections import LineCollection

from figures import legend_above, new_figure, svg_of
from oscillation import thin
from page import figure, section
from scene_text import find

AXES = "xyz"
START_SHARE = 0.02  # of the run, in which a start from rest or with a jump may push far beyond all that follows


def names(run):
    """Of the bodies whose forces stand in the history, in its order."""
    found = []
    for column in run.history.names if run.history is not None else ():
        if column.startswith("body.") and column.endswith(".force_x"):
            found.append(column.removeprefix("body.").removesuffix(".force_x"))
    return [name for name in found if f"body.{name}.viscous_force_x" in run.history]


def balances(run):
    """Names of the boxes whose momentum tells a force."""
    return [column.removesuffix(".force_balance_x") for column in run.history.names if column.endswith(".force_balance_x")] if run.history else []


def columns_shown(run):
    """Columns that the section below shows."""
    shown = [f"body.{name}.{kind}" for name in names(run)
             for kind in [f"{part}force_{axis}" for part in ("", "viscous_") for axis in AXES] + [f"moment_{axis}" for axis in AXES] + ["power"]]
    return shown + [f"{name}.force_balance_{axis}" for name in balances(run) for axis in AXES]


def cut_by_plane(position, triangles, direction, place, across):
    """The line in which a surface meets a plane normal to a direction: segments, (n, 2, 2) [m]."""
    height = position[:, direction] - place
    height[height == 0] = 1e-300  # a corner in the plane belongs to one side
    sides = height[triangles] > 0
    cut = triangles[sides.any(axis=1) & ~sides.all(axis=1)]
    if not len(cut):
        return numpy.empty((0, 2, 2))
    # The corner that is alone on its side first: the plane meets both edges that leave it.
    up = height[cut] > 0
    lone = numpy.where(up.sum(axis=1) == 1, up.argmax(axis=1), (~up).argmax(axis=1))
    a, b, c = (cut[numpy.arange(len(cut)), (lone + i) % 3] for i in range(3))

    def meet(p, q):
        share = height[p] / (height[p] - height[q])
        return (position[p] + share[:, None] * (position[q] - position[p]))[:, across]

    return numpy.stack([meet(a, b), meet(a, c)], axis=1)


def draw_outlines(axes, states, state, direction, place, across):
    """The bodies in the plane of a picture."""
    for body in states.bodies:
        segments = cut_by_plane(states.on_body(state, body, "position"), states.triangles(body), direction, place, list(across))
        axes.add_collection(LineCollection(segments, colors="black", linewidths=0.9))


def _limits(time, lines):
    """Range that shows all but the start of a run, where that alone would be seen otherwise; and whether it leaves something out."""
    late = time > time[0] + START_SHARE * (time[-1] - time[0])
    if late.sum() < 3:
        return None, False
    values = numpy.concatenate([line[late] for line in lines])
    values = values[numpy.isfinite(values)]
    everything = numpy.concatenate(lines)
    everything = everything[numpy.isfinite(everything)]
    if not values.size or numpy.ptp(values) == 0 or numpy.ptp(everything) < 2 * numpy.ptp(values):
        return None, False
    margin = 0.08 * numpy.ptp(values)
    return (values.min() - margin, values.max() + margin), True


def _force_lines(run, body, axis, beside):
    """Total, parts, and the balance of momentum of those boxes that stand for this body."""
    total, viscous = run.history[f"body.{body}.force_{axis}"], run.history[f"body.{body}.viscous_force_{axis}"]
    lines = [("pressure and friction", total, {"color": "#333", "linewidth": 1.2}),
             ("pressure", total - viscous, {"linewidth": 0.9}), ("friction", viscous, {"linewidth": 0.9})]
    return lines + [(f"balance of momentum, {box}", run.history[f"{box}.force_balance_{axis}"], {"linewidth": 0.9, "linestyle": "--", "zorder": 1.5}) for box in beside]


def _plots(run, plots, name):
    """Each plot: title and lines. Its picture, and whether the start goes beyond."""
    time = run.history["time"]
    n_columns = min(2, len(plots))
    chart, grid = new_figure(-(-len(plots) // n_columns), n_columns, height=2.5, squeeze=False)
    goes_beyond = False
    for axes, (title, lines) in zip(grid.flat, plots):
        for words, values, style in lines:
            axes.plot(*thin(time, values), label=words, **style)
        limits, leaves_out = _limits(time, [values for _, values, _ in lines])
        goes_beyond = goes_beyond or leaves_out
        if limits:
            axes.set_ylim(limits)
        axes.set(xlabel="time [s]", ylabel=title)
    for axes in list(grid.flat)[len(plots):]:
        axes.set_visible(False)
    if len(plots[0][1]) > 1:  # the same lines in all plots that have several
        legend_above(chart, grid.flat[0])
    return svg_of(chart, name), goes_beyond


def forces(run):
    """The force of the fluid on each body over time, and what else is known of it."""
    bodies = names(run)
    if not bodies or len(run.history) < 3:
        return ""
    boxes = balances(run)
    depth = find(run.scene, "flow.navier_stokes.grid.depth") if "z" not in find(run.scene, "flow.navier_stokes.grid", {}) else None
    words = f" Forces are those of a depth of {depth} m." if depth is not None else ""
    parts, goes_beyond = [], False
    for body in bodies:
        beside = boxes if len(bodies) == 1 else []
        plots = [(f"force along {axis} [N]", _force_lines(run, body, axis, beside)) for axis in AXES if f"body.{body}.force_{axis}" in run.history]
        for kind, title in [(f"moment_{axis}", f"moment about {axis} [N m]") for axis in AXES] + [("power", "power on its motion [W]")]:
            if f"body.{body}.{kind}" in run.history:
                plots.append((title, [(kind, run.history[f"body.{body}.{kind}"], {"linewidth": 0.9})]))
        picture, beyond = _plots(run, plots, f"force_{body}")
        goes_beyond = goes_beyond or beyond
        parts.append(figure(picture, f"Of the fluid on {body}.{words}"))
    if boxes and len(bodies) > 1:
        plots = [(f"force along {axis} [N]", [(box, run.history[f"{box}.force_balance_{axis}"], {"linewidth": 0.9}) for box in boxes
                                             if f"{box}.force_balance_{axis}" in run.history]) for axis in AXES]
        picture, beyond = _plots(run, [plot for plot in plots if plot[1]], "force_balance")
        goes_beyond = goes_beyond or beyond
        parts.append(figure(picture, "On all bodies in each box, from the momentum of the fluid in it."))
    note = '<p class="soft">The start of the run goes beyond these pictures; all of it is in history.csv.</p>' if goes_beyond else ""
    return section("Forces on bodies", *parts, note)
