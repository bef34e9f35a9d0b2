"""What the page of a solid shows: pictures of its bodies, loads, open areas, energy, contact, reactions, work of its steps."""

from html import escape

import numpy
from matplotlib.patches import Circle
from matplotlib.ticker import MaxNLocator

import solid_facts
from figures import label, new_figure, readable, svg_of
from general_sections import has_rows, moving_columns, probe_names
from oscillation import thin
from page import figure, number, section, table
from scene_text import find
from solid_pictures import INK, Painter, along, from_the_side, picture, sensible_camera, time_words
from solid_states import choose_moments

ENERGIES = {"solid.kinetic_energy": "kinetic", "solid.strain_energy": "strain", "solid.contact_energy": "contact"}
WORK = {"solid.external_work": "work of the loads", "solid.damping_work": "lost to damping"}
IMBALANCE = "solid.energy_imbalance"
CONTACT = {"solid.contact_force": "contact force", "solid.contact_distance": "smallest distance"}
STEPS = {"solid.substeps": "substeps", "solid.newton_iterations": "Newton iterations", "solid.residual": "relative residual",
         "solid.negative_pivots": "negative pivots", "solid.softened_elements": "softened elements"}
COUNTS = ("solid.substeps", "solid.newton_iterations", "solid.negative_pivots", "solid.softened_elements")
REACTION = "solid.reaction."
STRESS = "largest_principal_stress"  # of the fields of a body, drawn where it is stored
OPEN_FROM, OPEN_TO = 0.1, 0.9  # of the largest area: between them an orifice is opening or closing
N_PICTURES = 6


def columns_shown(run):
    """Columns that the sections below show."""
    if run.history is None or "solid" not in run.scene:
        return []
    return [*ENERGIES, *WORK, IMBALANCE, *CONTACT, *STEPS, *_reactions(run), *orifice_names(run)]


def _changing(run, names):
    return [name for name in names if name in run.history and numpy.isfinite(run.history[name]).all() and numpy.ptp(run.history[name]) > 0]


def _reactions(run):
    return [name for name in run.history.names if name.startswith(REACTION)]


def orifice_names(run):
    names = [str(find(orifice, "name")) for orifice in solid_facts.solid_of(run.scene).get("orifice", [])]
    return [name for name in names if run.history is not None and name in run.history]


def cycles_of_opening(time, area):
    """Times at which an orifice opens and closes: dictionaries with `opens`, `is_open`, `closes`, `is_closed` [s], as far as they happen.

    It opens when it last passes a tenth of the largest area before it reaches nine tenths; it closes from where it last leaves nine
    tenths until it reaches one tenth. What goes up and down between the two is one opening.
    """
    low, high = OPEN_FROM * area.max(), OPEN_TO * area.max()
    cycles, current = [], {} if area[0] < high else {"opens": None, "is_open": None}

    def when(k, level):
        return float(time[k - 1] + (level - area[k - 1]) / (area[k] - area[k - 1]) * (time[k] - time[k - 1]))

    for k in range(1, len(area)):
        before, now = area[k - 1], area[k]
        if before < low <= now and "is_open" not in current:
            current["opens"] = when(k, low)
        if before < high <= now and "is_open" not in current:
            current["is_open"] = when(k, high)
        if before >= high > now and "is_open" in current:
            current["closes"] = when(k, high)
        if before >= low > now and "is_open" in current:
            cycles.append(current | {"is_closed": when(k, low)})
            current = {}
    if current.get("is_open") is not None:  # open until the end of the run
        cycles.append({key: current[key] for key in ("opens", "is_open") if key in current})
    return cycles


def open_area(run):
    """Open area of every orifice over time, and when it opens and closes."""
    names = orifice_names(run) if has_rows(run, 3) else []
    if not names:
        return ""
    time = run.history["time"]
    chart, axes = new_figure()
    rows = []
    for name in names:
        area = run.history[name]
        line, = axes.plot(*thin(time, 1e4 * area), label=name)
        for cycle in cycles_of_opening(time, area):
            for key, low in (("opens", True), ("is_open", False), ("closes", False), ("is_closed", True)):
                if cycle.get(key) is not None:
                    axes.plot(cycle[key], 1e4 * (OPEN_FROM if low else OPEN_TO) * area.max(), "o", color=line.get_color(), markersize=4)
            rows.append((name, *(number(cycle.get(key)) for key in ("opens", "is_open", "closes", "is_closed"))))
    largest = max(run.history[name].max() for name in names)
    axes.set(xlabel="time [s]", ylabel="open area [cm²]", ylim=(0, 1.08e4 * largest if largest > 0 else 1))
    axes.legend(fontsize=8)
    sizes = []
    for name in names:
        low, high, at = run.history[name].min(), run.history[name].max(), time[run.history[name].argmax()]
        sizes.append((name, number(high, 4), number(1e4 * high, 4), number(at), number(low, 4), number(1e4 * low, 4)))
    return section("Open area", table(("orifice", "largest [m²]", "[cm²]", "at [s]", "smallest [m²]", "[cm²]"), sizes, numbers=(1, 2, 3, 4, 5)),
                   figure(svg_of(chart, "open-area"), "Open area, and the moments at which it passes 10 % and 90 % of its largest value."),
                   table(("orifice", "opens: 10 % at [s]", "90 % at [s]", "closes: 90 % at [s]", "10 % at [s]"), rows, numbers=(1, 2, 3, 4))
                   if rows else "")


def _valve_view(scene):
    """Axis along which one looks at a valve, its radius and centre; None without an orifice or a valve mesh."""
    orifice = find(scene, "solid.orifice")
    if orifice:
        return "XYZ".index(find(orifice, "axis", "X")), find(orifice, "radius"), _point(find(orifice, "centre"))
    body = next((body for body in solid_facts.solid_of(scene).get("body", []) if find(body, "valve")), None)
    if not body or find(body, "placement.rotation_angle", 0):
        return None
    return 0, find(body, "valve.tube_radius"), _point(find(body, "placement.translation"))


def _point(message):
    return numpy.array([float(find(message or {}, axis, 0)) for axis in "xyz"])


def _wanted_times(run):
    """Times at which the first orifice opens for the first time, is open, has closed, and halfway from there to the next opening."""
    names = orifice_names(run) if has_rows(run, 3) else []
    if not names:
        return []
    time, area = run.history["time"], run.history[names[0]]
    cycles = [cycle for cycle in cycles_of_opening(time, area) if cycle.get("opens") is not None]
    if not cycles:
        return [float(time[area.argmax()])]
    first = cycles[0]
    wanted = [first[key] for key in ("opens", "is_open", "is_closed") if key in first]
    if "is_closed" in first:
        closed_until = cycles[1].get("opens", time[-1]) if len(cycles) > 1 else time[-1]
        return wanted + [float(0.5 * (first["is_closed"] + closed_until))]
    rising = (time > first["opens"]) & (time < first["is_open"]) & (area >= 0.5 * area.max())
    return wanted + [float(time[rising][0]) if rising.any() else 0.5 * (first["opens"] + first["is_open"]), float(time[area.argmax()])]


def pictures(run):
    """The bodies at a few moments: along the axis and from the side for a valve, obliquely otherwise."""
    bodies = run.bodies()
    if not bodies:
        return ""
    valve = _valve_view(run.scene)
    solid = solid_facts.solid_of(run.scene)
    moments = choose_moments(bodies, _wanted_times(run) if valve else (), N_PICTURES)
    if not moments:
        return ""
    may_enlarge = not (valve or solid.get("contact") or solid.get("rigid_plane"))
    painter = Painter(bodies, moments, may_enlarge)
    end = bodies[0].time[-1]
    titles = [time_words(bodies[0].time[moment], end) for moment in moments]
    enlarged = f" Displacements are drawn {painter.enlarged:g} times as large as they are." if painter.enlarged > 1 else ""
    if valve:
        axis, radius, centre = valve
        names = orifice_names(run) if has_rows(run) else []
        if names:
            titles = [f"{title}\n{1e4 * numpy.interp(bodies[0].time[moment], run.history['time'], run.history[names[0]]):.3g} cm² open"
                      for title, moment in zip(titles, moments)]
        cameras, outline, n_columns = [along(axis), from_the_side(axis)], _tube(axis, radius, centre), N_PICTURES
        words = ("Above: along the axis from its far end; the circle is the opening. Below: from the side." + (" The moments are those of opening"
                 " and closing (10 % and 90 % of the largest area) and one halfway to the next opening, as near as states are stored." if names else ""))
    else:
        camera = sensible_camera(*painter.corners)
        limits = painter.limits(camera)
        is_long = (limits[3] - limits[2]) < 0.45 * (limits[1] - limits[0])
        cameras, outline, n_columns = [camera], None, 2 if is_long else 3
        words = "All stored states." if len(moments) == len(bodies[0]) else "Start and end, the extremes of the motion and moments between them."
    what = "The body" if len(solid.get("body", [])) < 2 else "The bodies"
    files = ", ".join(f"results/{body.name}.xmf" for body in bodies)
    image = picture(painter, cameras, titles, n_columns, outline)
    stressed = ""
    if all(STRESS in body.field_names for body in bodies):
        stressed = figure(picture(Painter(bodies, moments, may_enlarge, STRESS), cameras, titles, n_columns, outline),
                          "The same, coloured by the largest principal stress; one node in a hundred is beyond either end of the scale.")
    return section(what, figure(image, f"Outer surface, coloured by the size of the displacement. {words}{enlarged}"), stressed,
                   f'<p class="soft">All {len(bodies[0])} stored states: {files}, for ParaView.</p>')


def _tube(axis, radius, centre):
    """Draws the round opening: a circle along its axis, two lines from the side."""
    def outline(axes, camera):
        middle = camera.flat(centre[None])[0]
        if abs(camera.towards[axis]) > 0.5:
            axes.add_patch(Circle(middle, radius, fill=False, edgecolor="#999", linewidth=0.7, zorder=0))
            return
        line = camera.flat(numpy.eye(3)[axis][None])[0]
        across = numpy.array([-line[1], line[0]])
        for side in (-1, 1):
            axes.axline(middle + side * radius * across, middle + side * radius * across + radius * line, color="#bbb", linewidth=0.7, zorder=0)
    return outline


def loads(run):
    """Loads and prescribed motions that change, over time. Constant ones stand in words only, at the end of the page."""
    end = find(run.scene, "time.end")
    if not end or "solid" not in run.scene:
        return ""
    time = numpy.linspace(0, end, 600)
    found = solid_facts.loads_over_time(run.scene, time)
    if not found:
        return ""
    groups = {}
    for kind, name, unit, values in found:
        groups.setdefault((kind, unit), []).append((name, values))
    chart, grid = new_figure(-(-len(groups) // 2), min(2, len(groups)), height=2.3, squeeze=False)
    for axes, ((kind, unit), entries) in zip(grid.flat, groups.items()):
        factor, shown = readable(unit)
        for name, values in entries:
            axes.plot(time, factor * values, label=name)
        axes.set(xlabel="time [s]", ylabel=label(kind, shown))
        axes.legend(fontsize=8)
    for axes in list(grid.flat)[len(groups):]:
        axes.set_visible(False)
    return section("Loads", figure(svg_of(chart, "loads"), "Prescribed loads and motions as the scene gives them."))


def energy(run):
    """Balance of energies in one figure."""
    names = _changing(run, ENERGIES) if has_rows(run, 3) else []
    if not names:
        return ""
    time = run.history["time"]
    largest = max(numpy.abs(run.history[name]).max() for name in names + _changing(run, WORK))
    factor, unit = next((entry for entry in ((1.0, "J"), (1e3, "mJ"), (1e6, "µJ"), (1e9, "nJ")) if largest * entry[0] >= 0.5), (1e9, "nJ"))
    chart, axes = new_figure()
    for name in names:
        axes.plot(*thin(time, factor * run.history[name]), label=ENERGIES[name], linewidth=1)
    if len(names) > 1:
        axes.plot(*thin(time, factor * sum(run.history[name] for name in names)), label="sum", color="#222", linewidth=1)
    for name in _changing(run, WORK):
        axes.plot(*thin(time, factor * run.history[name]), "--", label=WORK[name], linewidth=1)
    axes.set(xlabel="time [s]", ylabel=f"energy [{unit}]")
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=6, fontsize=8)
    caption = "Without loads and damping the sum would stay the same." if len(names) > 1 and "solid.kinetic_energy" in names else "Over time."
    if IMBALANCE in run.history and largest > 0:
        worst = numpy.abs(run.history[IMBALANCE]).max() / largest
        caption += f" Energy less work, plus what damping took, stays at zero within {number(float(worst), 2)} of the largest value shown."
    return section("Energy of the solid", figure(svg_of(chart, "solid-energy"), caption))


def _plots(run, names, identity, titles):
    """One small plot for each column, side by side."""
    time = run.history["time"]
    chart, grid = new_figure(-(-len(names) // 2), min(2, len(names)), height=2.1, squeeze=False)
    for axes, name in zip(grid.flat, names):
        factor, unit = readable(run.history.units[name])
        axes.plot(*thin(time, factor * run.history[name]), linewidth=0.9)
        axes.set(xlabel="time [s]", ylabel=label(titles[name], unit))
        if name in COUNTS:
            axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    for axes in list(grid.flat)[len(names):]:
        axes.set_visible(False)
    return svg_of(chart, identity)


def contact(run):
    names = _changing(run, CONTACT) if has_rows(run, 3) else []
    if not names:
        return ""
    words = {"solid.contact_force": "what surfaces or planes press on bodies", "solid.contact_distance": "how close surfaces come that touch"}
    caption = "; ".join(words[name] for name in names)
    return section("Contact", figure(_plots(run, names, "contact", CONTACT), f"{caption[0].upper()}{caption[1:]}."))


def reactions(run):
    """Forces of the supports, each support in its own plot."""
    names = _changing(run, _reactions(run)) if has_rows(run, 3) else []
    if not names:
        return ""
    groups = {}
    for name in names:
        groups.setdefault(name[len(REACTION):].rpartition(".")[0], []).append(name)
    chart, grid = new_figure(-(-len(groups) // 2), min(2, len(groups)), height=2.1, squeeze=False)
    for axes, (support, columns) in zip(grid.flat, groups.items()):
        for column in columns:
            axes.plot(*thin(run.history["time"], run.history[column]), label=column[-1])
        axes.set(xlabel="time [s]", ylabel="force [N]", title=support)
        axes.legend(fontsize=8)
    for axes in list(grid.flat)[len(groups):]:
        axes.set_visible(False)
    return section("Reactions", figure(svg_of(chart, "reactions"), "Forces of the supports on the bodies."))


def steps(run):
    """Work of every step; where it is always the same, a sentence."""
    if not has_rows(run, 3):
        return ""
    changing = _changing(run, STEPS)
    constant = [(words + " of every step", number(float(run.history[name][0]))) for name, words in STEPS.items()
                if name in run.history and name not in changing and run.history[name][0] != 0]
    if not changing and not constant:
        return ""
    entry = run.summary.get("programs", {}).get("solid-server", {})
    size = [(words, number(int(entry[name]))) for name, words in (("elements", "elements"), ("nodes", "nodes")) if entry.get(name)]
    reason = entry.get("time_integration")
    return section("Steps of the solid", f"<p>Time integration: {escape(reason)}.</p>" if reason else "", figure(_plots(run, changing, "solid-steps", STEPS), "Over time.") if changing else "",
                   table((), size + constant, numbers=(1,)) if size or constant else "")


def load_and_displacement(run):
    """Of equilibria: the path of the probes over the load."""
    columns = moving_columns(run) if has_rows(run) and solid_facts.method(run.scene) == "STATIC" else []
    if not columns:
        return ""
    time = run.history["time"]
    found = solid_facts.loads_over_time(run.scene, time)
    loads_ = [entry for entry in found if entry[0] != "prescribed motion"]
    if len(loads_) == 1:
        kind, name, unit, load = loads_[0]
        title = label(kind if kind == name else f"{kind} on {name}", unit)
    else:
        load, title = time, "time, which orders the loads [s]"
    factor, unit = readable(run.history.units[columns[0]])
    chart, axes = new_figure(height=3.4)
    for column in columns:
        axes.plot(factor * run.history[column], load, marker="o" if len(time) <= 60 else "", markersize=3, label=column)
    axes.set(xlabel=label("displacement", unit), ylabel=title)
    axes.legend(fontsize=8)
    caption = f"Equilibria of all {len(time)} steps at the probes: {', '.join(probe_names(run))}."
    return section("Load and displacement", figure(svg_of(chart, "load-displacement"), caption))
