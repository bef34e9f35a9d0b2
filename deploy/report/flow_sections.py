"""What the page of a flow in two or three dimensions shows: pictures of its fields, its integrals, planes and points, its solver."""

import numpy

import body_sections
from figures import label, new_figure, png_of, svg_of
from general_sections import has_rows
from oscillation import thin
from page import figure, number, section, table

AXES = "xyz"
SOLVER = ["flow.substeps", "flow.courant", "flow.largest_speed", "flow.divergence", "flow.pressure_iterations", "flow.pressure_residual"]
INTEGRALS = ["flow.kinetic_energy", "flow.dissipation", "flow.enstrophy"]
ERRORS = ["flow.velocity_error_l2", "flow.velocity_error_max", "flow.pressure_error_l2"]
PARTS = {"seconds_solve": "time steps", "seconds_measurements": "measurements", "seconds_results": "results", "seconds_checkpoints": "checkpoints"}
SMALLEST_PICTURE = 4  # cells along each side


def is_flow_in_space(run):
    return bool(run.scene.get("flow")) and "navier_stokes" in run.scene["flow"][0]


def columns_shown(run):
    """Columns that the sections below show."""
    if not is_flow_in_space(run) or run.history is None:
        return []
    return SOLVER + INTEGRALS + ERRORS + body_sections.columns_shown(run) + _columns_ending(run, ".flow_rate", ".momentum_flux", *_probe_endings())


def _probe_endings():
    return [f".velocity_{axis}" for axis in AXES] + [".pressure"]


def _columns_ending(run, *endings):
    return [name for name in run.history.names if name.endswith(tuple(endings))]


def pictures(run):
    """Speed, vorticity and pressure in the middle of the largest region: the last state in every plane, and how it came there."""
    states = run.flow_fields()
    if states is None or not len(states):
        return ""
    region = states.largest_region()
    planes = [direction for direction in (2, 1, 0) if _is_worth_showing(states, region, direction)]
    if not planes or "velocity" not in states.field_names(region):
        return ""
    last = len(states) - 1
    parts = [figure(_picture_of(states, region, last, direction), f"{_plane_words(states, region, direction)}, t = {states.time[last]:.6g} s.")
             for direction in planes]
    if last > 0:
        parts.append(figure(_picture_over_time(states, region, planes[0]),
                            f"Vorticity over time, {_plane_words(states, region, planes[0])}; colours as in the last picture."))
    return section("The flow", *parts, f'<p class="soft">All of it, for ParaView: {_files(states, region)}.</p>')


def _files(states, region):
    return ", ".join([f"results/{region}.xmf"] + [f"results/body.{body}.xmf" for body in states.bodies])


def _is_worth_showing(states, region, direction):
    cells = [len(faces) - 1 for faces in states.faces(region)]
    return all(cells[d] >= SMALLEST_PICTURE for d in range(3) if d != direction)


def _middle(states, region, direction):
    return (len(states.faces(region)[direction]) - 1) // 2


def _position(states, region, direction):
    """Of the middle plane [m]."""
    faces, m = states.faces(region)[direction], _middle(states, region, direction)
    return 0.5 * (faces[m] + faces[m + 1])


def _plane_words(states, region, direction):
    if len(states.faces(region)[direction]) == 2:
        return "the plane of the flow"
    return f"{AXES[direction]} = {_position(states, region, direction):.5g} m"


def _across(direction):
    """Horizontal and vertical direction of the picture of a plane."""
    return {2: (0, 1), 1: (0, 2), 0: (1, 2)}[direction]


def _slice(states, region, state, name, direction):
    """A field in the middle plane, (n_horizontal, n_vertical) and components."""
    m = _middle(states, region, direction)
    return numpy.squeeze(states.slab(state, region, name, direction, m, m + 1), axis=direction)


def without_bodies(states, region, state, direction, values):
    """Values in the middle plane, masked in cells most of which lie inside bodies."""
    if "fluid_share" not in states.field_names(region):
        return numpy.ma.masked_array(values)
    return numpy.ma.masked_array(values, _slice(states, region, state, "fluid_share", direction) < 0.5)


def vorticity_in_plane(states, region, state, direction):
    """In two dimensions the component out of the plane, with its sign; otherwise the magnitude."""
    faces = states.faces(region)
    is_flat = len(faces[2]) == 2
    if "vorticity" in states.field_names(region):
        values = _slice(states, region, state, "vorticity", direction)
        return values[..., 2] if is_flat else numpy.linalg.norm(values, axis=-1)
    m, n = _middle(states, region, direction), len(faces[direction]) - 1
    begin, end = max(0, m - 1), min(n, m + 2)
    velocity = states.slab(state, region, "velocity", direction, begin, end)
    centres = [0.5 * (axis[1:] + axis[:-1]) for axis in faces]
    centres[direction] = centres[direction][begin:end]

    def derivative(component, axis):
        if velocity.shape[axis] < 2:
            return numpy.zeros(velocity.shape[:3])
        return numpy.gradient(velocity[..., component], centres[axis], axis=axis)

    curl = [derivative(2, 1) - derivative(1, 2), derivative(0, 2) - derivative(2, 0), derivative(1, 0) - derivative(0, 1)]
    values = curl[2] if is_flat else numpy.sqrt(sum(part**2 for part in curl))
    return numpy.take(values, m - begin, axis=direction)


def _proportions(states, region, direction):
    """Height over width of a picture of the plane, within what fits on a page."""
    faces = states.faces(region)
    horizontal, vertical = _across(direction)
    return float(numpy.clip((faces[vertical][-1] - faces[vertical][0]) / (faces[horizontal][-1] - faces[horizontal][0]), 0.08, 3))


def _limits(values, has_sign):
    """The range of colours: that of all but the outermost hundredth of the cells, as the corner of a moving wall would drown the rest."""
    values = numpy.ma.compressed(values)
    if not values.size:
        return 0.0, 1.0
    if has_sign:
        largest = float(numpy.percentile(numpy.abs(values), 99)) or 1.0
        return -largest, largest
    low, high = (float(limit) for limit in numpy.percentile(values, (0.5, 99.5)))
    return (low, high) if high > low else (low - 1e-12, high + 1e-12)


def _draw(axes, states, region, state, direction, values, title, has_sign=False, like=None):
    """With the outlines of bodies; what lies inside them is left out. `like`: values whose range of colours is used."""
    values = without_bodies(states, region, state, direction, values)
    faces = states.faces(region)
    horizontal, vertical = _across(direction)
    low, high = _limits(values if like is None else like, has_sign)
    limits = {"vmin": low, "vmax": high, "cmap": "RdBu_r" if has_sign else "viridis"}
    axes.grid(visible=False)
    axes.set_facecolor("#d3d3da")  # where there is no fluid
    mesh = axes.pcolormesh(faces[horizontal], faces[vertical], values.T, shading="flat", **limits)
    body_sections.draw_outlines(axes, states, state, direction, _position(states, region, direction), _across(direction))
    axes.set(xlim=faces[horizontal][[0, -1]], ylim=faces[vertical][[0, -1]])
    axes.set(aspect="equal" if 0.08 < _proportions(states, region, direction) < 3 else "auto",
             xlabel=f"{AXES[horizontal]} [m]", ylabel=f"{AXES[vertical]} [m]")
    axes.set_title(title, fontsize=9)
    axes.tick_params(labelsize=8)
    axes.figure.colorbar(mesh, ax=axes, shrink=0.8, pad=0.02, extend="both").ax.tick_params(labelsize=8)


def _picture_of(states, region, state, direction):
    names = states.field_names(region)
    is_flat = len(states.faces(region)[2]) == 2
    fields = [("speed [m/s]", numpy.linalg.norm(_slice(states, region, state, "velocity", direction), axis=-1), False),
              ("vorticity [1/s]", vorticity_in_plane(states, region, state, direction), is_flat)]
    if "pressure" in names:
        fields.append(("pressure [Pa]", _slice(states, region, state, "pressure", direction), False))
    width = 10.0 / len(fields)
    if _proportions(states, region, direction) < 0.45:  # long and flat: one below the other
        chart, grid = new_figure(len(fields), 1, width=9.5, height=max(1.5, 8.5 * _proportions(states, region, direction) + 0.6), squeeze=False)
    else:
        chart, grid = new_figure(1, len(fields), width=10.0, height=width * _proportions(states, region, direction) * 0.85 + 0.5, squeeze=False)
    for axes, (title, values, has_sign) in zip(grid.flat, fields):
        _draw(axes, states, region, state, direction, values, title, has_sign)
    return png_of(chart)


def _picture_over_time(states, region, direction):
    chosen = sorted({round(i) for i in numpy.linspace(0, len(states) - 1, 4)})
    is_flat = len(states.faces(region)[2]) == 2
    proportion = _proportions(states, region, direction)
    if proportion < 0.45:
        chart, grid = new_figure(len(chosen), 1, width=9.5, height=max(1.3, 8.5 * proportion + 0.6), squeeze=False)
    else:
        chart, grid = new_figure(1, len(chosen), width=10.0, height=10.0 / len(chosen) * proportion * 0.85 + 0.5, squeeze=False)
    last = without_bodies(states, region, chosen[-1], direction, vorticity_in_plane(states, region, chosen[-1], direction))
    for axes, state in zip(grid.flat, chosen):
        values = vorticity_in_plane(states, region, state, direction)
        _draw(axes, states, region, state, direction, values, f"t = {states.time[state]:.4g} s", is_flat, like=last)
        if axes is not grid.flat[0] and proportion >= 0.45:
            axes.set(ylabel="")
    return png_of(chart)


def _small_plots(run, columns, name, logarithmic=()):
    """Each column in its own plot."""
    columns = [column for column in columns if column in run.history]
    if not columns:
        return ""
    n_columns = min(3, len(columns))
    n_rows = -(-len(columns) // n_columns)
    chart, grid = new_figure(n_rows, n_columns, height=2.0, squeeze=False)
    time = run.history["time"]
    for axes, column in zip(grid.flat, columns):
        values = run.history[column]
        draw = axes.semilogy if column in logarithmic and (values > 0).all() else axes.plot
        draw(*thin(time, values), linewidth=0.9)
        axes.set_title(label(column.removeprefix("flow.").replace("_", " "), _plain(run.history.units[column])), fontsize=9)
        axes.tick_params(labelsize=7.5)
    for axes in list(grid.flat)[len(columns):]:
        axes.set_visible(False)
    return svg_of(chart, name)


def _plain(unit):
    return "" if unit == "1" else unit


def integrals(run):
    """Energy and its loss; what the grid itself dissipates shows as the distance of the two losses."""
    if not is_flow_in_space(run) or not has_rows(run, 3) or INTEGRALS[0] not in run.history:
        return ""
    time, energy, loss = run.history["time"], run.history["flow.kinetic_energy"], run.history["flow.dissipation"]
    chart, (left, middle, right) = new_figure(1, 3)
    left.plot(*thin(time, energy))
    left.set(xlabel="time [s]", title="kinetic energy [J]")
    middle.plot(*thin(time, loss), label="dissipation")
    middle.plot(*thin(time, -numpy.gradient(energy, time)), "--", label="-dE/dt")
    middle.set(xlabel="time [s]", title="loss of energy [W]")
    middle.legend(fontsize=8)
    right.plot(*thin(time, run.history["flow.enstrophy"]))
    right.set(xlabel="time [s]", title="enstrophy [m³/s²]")
    return section("Energy", figure(svg_of(chart, "integrals"),
                                    "Integrals over the whole fluid. Without forces and open borders the two losses are equal but for errors in space and time."))


def planes_and_points(run):
    """What passes through the planes and what the points see."""
    if not is_flow_in_space(run) or not has_rows(run, 3):
        return ""
    time = run.history["time"]
    groups = [("flow rate", _columns_ending(run, ".flow_rate")), ("momentum flux", _columns_ending(run, ".momentum_flux")),
              ("velocity", _columns_ending(run, *_probe_endings()[:3])), ("pressure", _columns_ending(run, ".pressure"))]
    groups = [(title, columns) for title, columns in groups if columns]
    if not groups:
        return ""
    chart, grid = new_figure(-(-len(groups) // 2), min(2, len(groups)), height=2.5, squeeze=False)
    for axes, (title, columns) in zip(grid.flat, groups):
        for column in columns:
            axes.plot(*thin(time, run.history[column]), label=column, linewidth=0.9)
        axes.set(xlabel="time [s]", ylabel=label(title, _plain(run.history.units[columns[0]])))
        axes.legend(fontsize=7, ncols=2)
    for axes in list(grid.flat)[len(groups):]:
        axes.set_visible(False)
    return section("Planes and points", figure(svg_of(chart, "planes"), "Flow along the normal counts positive."))


def errors(run):
    if not is_flow_in_space(run) or not has_rows(run, 3) or ERRORS[0] not in run.history:
        return ""
    return section("Distance from the exact solution", figure(_small_plots(run, ERRORS, "errors", ERRORS), "Over time [s]."))


def solver(run):
    """What the time steps and the pressure solver did, and where their time went."""
    if not is_flow_in_space(run) or not has_rows(run, 3):
        return ""
    plots = _small_plots(run, SOLVER, "solver", ("flow.divergence", "flow.pressure_residual"))
    entry = run.summary.get("programs", {}).get("flow-server", {})
    rows = [(words, number(entry[name], 4)) for name, words in PARTS.items() if name in entry]
    facts = [("cells", entry.get("cells")), ("of them fluid", entry.get("cells_active")), ("ranks", entry.get("ranks")),
             ("ns a cell and step, wall time", entry.get("ns_per_cell_step")), ("bytes a cell", entry.get("bytes_per_cell")),
             ("messages a step, all ranks", entry.get("messages_per_step"))]
    rows += [(words, number(value, 6)) for words, value in facts if value is not None]
    return section("Time steps", figure(plots, "Over time [s]; pressure iterations are those of all substeps of a step."),
                   table(("time spent in", "seconds"), rows[:4], numbers=(1,)) if entry else "",
                   table(("size and speed", ""), rows[4:], numbers=(1,)) if entry else "")
