"""What the page of a vocal fold shows besides: outline over a cycle, glottal flow, pressure along the glottis."""

import numpy
from matplotlib import colormaps

from figures import new_figure, svg_of
from general_sections import has_rows, last_part, moving_columns
from oscillation import main_frequency, thin
from page import figure, section
from scene_text import find

FLOW_COLUMNS = ("flow.rate", "flow.smallest_area")


def cycle_length(run):
    """Length of a cycle at the end of the run [s]; None without an oscillation."""
    columns = moving_columns(run) if has_rows(run, 64) else []
    if not columns:
        return None
    time = run.history["time"]
    late = time >= 0.5 * (time[0] + time[-1])
    column = max((name for name in columns if name.endswith(".y")), key=lambda name: numpy.ptp(run.history[name][late]), default=columns[0])
    line = main_frequency(time[late], run.history[column][late])
    return 1 / line if line else None


def middle_outline(states, whole_length):
    """Nodes of the wetted edge of the section at mid length, from its upstream to its downstream end.

    Faces of hex20 elements that lie in the plane are found by their eight nodes; an edge that belongs to one face only is on
    the outline. The edge along the wall (y = 0) is left out.
    """
    position = states.position
    reach = numpy.ptp(position[:, 2])
    middle = whole_length / 2 if whole_length else position[:, 2].min() + reach / 2
    in_plane = numpy.abs(position[:, 2] - middle) < 1e-6 * max(reach, 1e-12)
    edges = {}
    faces = set()
    for cell in states.cell.reshape(-1, 20):
        inside = cell[in_plane[cell]]
        if len(inside) != 8 or frozenset(inside) in faces:
            continue
        faces.add(frozenset(inside))
        for ends, mid in HEX20_EDGES:
            a, b, m = cell[ends[0]], cell[ends[1]], cell[mid]
            if in_plane[a] and in_plane[b] and in_plane[m]:
                edges.setdefault(frozenset((a, b)), []).append((a, m, b))
    wall = position[:, 1].min() + 1e-6 * max(numpy.ptp(position[:, 1]), 1e-12)
    outer = [lines[0] for lines in edges.values() if len(lines) == 1 and (position[list(lines[0]), 1] > wall).any()]
    return _chain(outer, position)


# Edges of a 20-node hexahedron in the node order of VTK: (its ends, its middle node).
HEX20_EDGES = (((0, 1), 8), ((1, 2), 9), ((2, 3), 10), ((3, 0), 11), ((4, 5), 12), ((5, 6), 13), ((6, 7), 14), ((7, 4), 15),
               ((0, 4), 16), ((1, 5), 17), ((2, 6), 18), ((3, 7), 19))


def _chain(edges, position):
    """Edges in the order in which they follow each other, as one list of nodes."""
    neighbours = {}
    for a, m, b in edges:
        neighbours.setdefault(a, []).append((m, b))
        neighbours.setdefault(b, []).append((m, a))
    ends = [node for node, others in neighbours.items() if len(others) == 1]
    if not ends:
        return []
    chain = [min(ends, key=lambda node: position[node, 0])]
    before = None
    while True:
        onward = [(m, node) for m, node in neighbours[chain[-1]] if node != before]
        if not onward or len(chain) > 4 * len(position):
            return chain
        before = chain[-1]
        chain += onward[0]


def along_quadratic_edges(points, n_pieces=6):
    """Points along edges of three nodes each (end, middle, end, middle, ...), as the elements' shape functions bend them."""
    xi = numpy.linspace(-1, 1, n_pieces + 1)[:-1, None]
    curve = [0.5 * xi * (xi - 1) * a + (1 - xi**2) * m + 0.5 * xi * (xi + 1) * b for a, m, b in zip(points[:-2:2], points[1:-1:2], points[2::2])]
    return numpy.concatenate([*curve, points[-1:]])


def outline_figure(run, states, period, width=9.0, height=4.2, mean=False):
    """Outlines of both folds over the last cycle, or the mean of all cycles that are stored, and at rest."""
    fold = find(run.scene, "solid.body.vocal_fold", {})
    nodes = middle_outline(states, find(fold, "length"))
    if len(nodes) < 3:
        return None
    last = states.time[-1]
    wanted = last - (period or numpy.ptp(states.time) / 10) * numpy.linspace(1, 0, 13)[1:]
    n_cycles = max(1, int(numpy.ptp(states.time) / period)) if mean and period else 1
    chosen = [[states.nearest(time - n * period) if n else states.nearest(time) for n in range(n_cycles)]
              for time in wanted if time >= states.time[0] - 1e-12]
    chart, axes = new_figure(width=width, height=height)
    rest = along_quadratic_edges(1e3 * states.position[nodes])
    midplane = find(run.scene, "flow.glottis.midplane")
    axes.plot(rest[:, 0], rest[:, 1], color="#999", linestyle="--", linewidth=1, label="at rest")
    colours = colormaps["viridis"](numpy.linspace(0, 0.92, len(chosen)))
    for colour, moments in zip(colours, chosen):
        displacement = numpy.mean([states.field(state, "displacement")[nodes] for state in moments], axis=0)
        moved = along_quadratic_edges(1e3 * (states.position[nodes] + displacement))
        share = (states.time[moments[0]] - last) / period if period else 0
        axes.plot(moved[:, 0], moved[:, 1], color=colour, linewidth=1.1, label=f"{1 + share:.2f} of the cycle" if period else None)
        if midplane:
            axes.plot(moved[:, 0], 2e3 * midplane - moved[:, 1], color=colour, linewidth=0.6, alpha=0.5)
    if midplane:
        axes.axhline(1e3 * midplane, color="#ccc", linewidth=0.8)
    axes.set(xlabel="x, along the flow [mm]", ylabel="y [mm]", aspect="equal")
    medial = rest[:, 1].max()
    axes.set_ylim(medial - 3.2, (2e3 * midplane - medial + 1.2) if midplane else medial + 0.8)
    near = rest[rest[:, 1] > medial - 3.2]
    axes.set_xlim(near[:, 0].min() - 0.8, near[:, 0].max() + 1.6)
    axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.01, 0.5))
    return chart


def outline(run):
    states = run.results("hexahedron20") if find(run.scene, "solid.body.vocal_fold") else None
    if states is None or "displacement" not in states.field_names:
        return ""
    chart = outline_figure(run, states, cycle_length(run))
    if chart is None:
        return ""
    return section("Outline at mid length", figure(svg_of(chart, "outline", trim=True), "Edge of the fold in its middle section over the last cycle; above, fainter, its mirror image."))


def glottal_flow(run):
    """Smallest area and flow rate, all the time and over the last cycles."""
    if not has_rows(run, 8) or any(name not in run.history for name in FLOW_COLUMNS):
        return ""
    time = run.history["time"]
    chart, grid = new_figure(2, 2, height=1.9, sharex="col", gridspec_kw={"width_ratios": [2, 1]})
    first = last_part(run, "flow.smallest_area")
    late = time >= first
    for axes, name, colour, text in zip(grid, FLOW_COLUMNS, ("#2a6f97", "#d1495b"), ("flow rate [ml/s]", "smallest area [mm²]")):
        values = 1e6 * run.history[name]
        axes[0].plot(*thin(time, values), color=colour, linewidth=0.8)
        axes[0].set_ylabel(text)
        axes[1].plot(*thin(1e3 * time[late], values[late]), color=colour)
    grid[1][0].set_xlabel("time [s]")
    grid[1][1].set_xlabel("time [ms]")
    return section("Glottal flow", figure(svg_of(chart, "glottal-flow"), "Flow rate and smallest glottal area of the whole glottis; right: the last cycles."))


def pressure_along_glottis(run):
    """Pressure over x when the glottis opens, is widest and closes, in a cycle near the end of what is stored."""
    states = run.results("polyline") if find(run.scene, "flow.glottis") else None
    period = cycle_length(run)
    if states is None or period is None or any(name not in states.field_names for name in ("pressure", "area")):
        return ""
    # Two periods, the widest moment in the middle one, so that it has an opening before it and a closing after it.
    before_end = (states.time[-1] - states.time) / period
    cycle = numpy.flatnonzero(before_end < 2)
    if len(cycle) < 8:
        return ""
    areas = numpy.array([states.field(k, "area").min() for k in cycle])
    in_the_middle = (before_end[cycle] > 0.5) & (before_end[cycle] < 1.5)
    widest = int(numpy.where(in_the_middle, areas, 0).argmax())
    mean = 0.5 * (areas.max() + areas.min())
    moments = [("opening", _crossing(areas, mean, widest, -1)), ("widest", widest), ("closing", _crossing(areas, mean, widest, +1))]
    chart, (pressure, area) = new_figure(1, 2)
    for name, k in moments:
        if k is None:
            continue
        x = 1e3 * states.field(cycle[k], "position")[:, 0]
        pressure.plot(x, 1e-3 * states.field(cycle[k], "pressure").ravel(), label=f"{name}, t = {1e3 * states.time[cycle[k]]:.1f} ms")
        area.plot(x, 1e6 * states.field(cycle[k], "area").ravel())
    pressure.set(xlabel="x [mm]", ylabel="pressure [kPa]")
    area.set(xlabel="x [mm]", ylabel="area [mm²]")
    pressure.legend(fontsize=8)
    return section("Pressure along the glottis", figure(svg_of(chart, "pressure"), "Pressure and area along the glottis while it opens, is widest and closes, in a cycle near the end of the run."))


def _crossing(values, level, start, direction):
    """Index next to which the values cross the level, going from `start` in a direction; None where they do not."""
    k = start
    while 0 <= k < len(values):
        if values[k] <= level:
            return k
        k += direction
    return None
