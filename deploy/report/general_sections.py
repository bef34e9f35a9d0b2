"""What the page of any run shows: what was run, how it ended, its numbers, its probes, its convergence, its cost."""

import os
import platform
from html import escape

import numpy

from figures import label, legend_above, new_figure, readable, svg_of
from oscillation import main_frequency, spectrum, thin
from page import figure, number, section, table
from scene_text import find, leaves
import solid_facts


FEWEST_SAMPLES = 16  # a picture of fewer at the end of a run shows no motion
FEWEST_CYCLES = 5  # a spectrum of fewer shows the window and not the motion


def heading(run):
    """Title, status and, where something is wrong or missing, what."""
    summary = run.summary
    status = summary.get("status", "unfinished")
    title = find(run.scene, "title") or run.path.resolve().name
    parts = [f"<h1>{escape(str(title))}</h1>",
             f'<p class="soft"><span class="status {status}">{status}</span> {escape(_progress(run))}</p>']
    if summary.get("failure"):
        parts.append(f'<p class="failure">{escape(summary["failure"])}</p>')
    if not summary:
        parts.append('<p class="trouble">The run has no summary: it is still running, or was cut off. Shown is what it has written so far.</p>')
    return "\n".join(parts)


def _progress(run):
    summary = run.summary
    if summary.get("steps") is None:
        if run.history is None or len(run.history) == 0:
            return ""
        return f"{len(run.history)} steps to t = {run.history['time'][-1]:.6g} s"
    text = f"{summary['steps']} steps to t = {number(summary.get('end_time'))} s"
    if summary.get("wall_seconds") is not None:
        text += f" in {number(summary['wall_seconds'], 3)} s ({number(summary.get('core_seconds'), 3)} s of computing)"
    return text


def what_was_run(run):
    """The fields of the scene that say most, then the whole of it."""
    if not run.scene:
        return ""
    facts = [(name, value) for name, value in _key_facts(run.scene) if value is not None]
    everything = "\n".join(f"{path}: {value}" for path, value in leaves(run.scene))
    return section("What was run", table((), facts),
                   f"<details><summary>all fields, defaults included</summary><pre>{escape(everything)}</pre></details>")


def _key_facts(scene):
    yield "time", f"{find(scene, 'time.end')} s in steps of {find(scene, 'time.step')} s"
    if "flow" in scene:
        model = next((name for name in scene["flow"][0] if name != "fluid"), "flow")
        kind = find(scene, f"flow.{model}.model")
        yield "flow", f"{model}{', model ' + str(kind) if kind else ''}; density {find(scene, 'flow.fluid.density')} kg/m³, viscosity {find(scene, 'flow.fluid.viscosity')} Pa s"
    grid = find(scene, "flow.navier_stokes.grid")
    if grid:
        yield "grid", " × ".join(_axis_words(grid[axis][0]) for axis in "xyz" if axis in grid) + " cells"
    yield from solid_facts.facts(scene)
    if "flow" in scene and "solid" in scene:
        acceleration = next((name for name in ("constant", "aitken", "iqn_ils", "iqn_imvj") if name in find(scene, "coupling", {})), None)
        words = [find(scene, "coupling.scheme"), acceleration, f"{find(scene, 'coupling.predictor')} predictor"]
        yield "coupling", ", ".join(str(word).lower().replace("_", " ") for word in words if word)


def _axis_words(axis):
    """Number of cells where the scene says it."""
    cells = find(axis, "uniform.cells")
    if cells is None and "faces" in axis:
        cells = len(axis["faces"][0]["face"]) - 1
    return (str(cells) if cells is not None else "stretched") + (" periodic" if find(axis, "periodic") else "")


def quantities(run):
    """The named results with the cycles they were measured over and their spread."""
    found = run.summary.get("quantities", {})
    if not found:
        return ""
    rows = []
    for name, entry in found.items():
        unit = "" if entry.get("unit") in ("1", None) else entry["unit"]
        cycles = number(entry["cycles"], 3) if entry.get("cycles") is not None else ""
        spread = number(entry["spread"], 2) if entry.get("spread") is not None else ""
        rows.append((name, number(entry.get("value")), unit, spread, cycles))
    return section("Results", table(("quantity", "value", "unit", "spread", "cycles"), rows, numbers=(1, 3, 4)),
                   '<p class="soft">Spread: standard deviation over the cycles of the window that the scene names.</p>')


def probe_names(run):
    """Names of the probes in the history, in its order."""
    names = []
    for column in run.history.names if run.history is not None else ():
        if column.endswith(".x") and run.history.units[column] == "m" and column[:-2] + ".y" in run.history and column[:-2] not in names:
            names.append(column[:-2])
    return names


def moving_columns(run):
    """Columns of the probes that move: at least a thousandth of the largest range."""
    columns = [f"{name}.{axis}" for name in probe_names(run) for axis in "xyz"]
    columns = [column for column in columns if column in run.history]
    largest = max((numpy.ptp(run.history[column]) for column in columns), default=0)
    return [column for column in columns if largest > 0 and numpy.ptp(run.history[column]) > 1e-3 * largest]


def last_part(run, column, n_cycles=5):
    """First time of the last few cycles of a column; of the last tenth where it does not oscillate."""
    time = run.history["time"]
    half = time >= 0.5 * (time[0] + time[-1])
    line = main_frequency(time[half], run.history[column][half]) if half.sum() > 16 else None
    span = time[-1] - time[0]
    return time[-1] - (n_cycles / line if line and n_cycles / line < 0.5 * span else 0.1 * span)


def has_rows(run, n=2):
    return run.history is not None and len(run.history) >= n


def probes(run):
    """Displacements over the whole run, over the last cycles, and their spectrum."""
    columns = moving_columns(run) if has_rows(run, 8) else []
    if not columns:
        return ""
    time = run.history["time"]
    factor, unit = readable(run.history.units[columns[0]])
    strongest = max(columns, key=lambda name: numpy.ptp(run.history[name][len(time) // 2:]))
    late = time >= last_part(run, strongest)
    has_end = late.sum() >= FEWEST_SAMPLES
    chart, grid = new_figure(1, 2 if has_end else 1, gridspec_kw={"width_ratios": [2, 1] if has_end else [1]}, squeeze=False)
    whole = grid[0][0]
    for column in columns:
        whole.plot(*thin(time, factor * run.history[column]), label=column, linewidth=0.9)
        if has_end:
            grid[0][1].plot(*thin(1e3 * time[late], factor * run.history[column][late]))
    whole.set(xlabel="time [s]", ylabel=label("displacement", unit))
    if has_end:
        grid[0][1].set(xlabel="time [ms], the end of the run")
    legend_above(chart, whole)
    return section("Displacement at the probes", figure(svg_of(chart, "probes"), "Displacement of the probes from their place at rest."),
                   figure(_spectrum(run, columns), "Amplitude spectrum of the second half of the run, Hann window."))


def _spectrum(run, columns):
    time = run.history["time"]
    late = time >= 0.5 * (time[0] + time[-1])
    if late.sum() < 64:
        return ""
    factor, unit = readable(run.history.units[columns[0]])
    lines = [main_frequency(time[late], run.history[column][late]) for column in columns]
    lines = [line for line in lines if line]
    if not lines or max(lines) * (time[-1] - time[late][0]) < FEWEST_CYCLES:
        return ""
    highest = max(500.0, 4 * max(lines)) if max(lines) < 2000 else 4 * max(lines)
    chart, axes = new_figure()
    for column in columns:
        frequency, amplitude = spectrum(time[late], factor * run.history[column][late])
        shown = frequency <= highest
        axes.plot(*thin(frequency[shown], amplitude[shown]), label=column)
    axes.set(xlabel="frequency [Hz]", ylabel=label("amplitude", unit), xlim=(0, highest))
    legend_above(chart, axes)
    return svg_of(chart, "spectrum")


def other_columns(run, shown):
    """Every further column of the history that changes, each in its own small plot."""
    if not has_rows(run, 8):
        return ""
    taken = set(shown) | set(moving_columns(run)) | {"time", "dt", "iterations", "inner_iterations"}
    probe_columns = {f"{name}.{axis}" for name in probe_names(run) for axis in "xyz"}
    names = [name for name in run.history.names if name not in taken | probe_columns and not name.endswith("change")
             and numpy.isfinite(run.history[name]).all() and numpy.ptp(run.history[name]) > 0]
    if not names:
        return ""
    n_rows = (len(names) + 2) // 3
    chart, grid = new_figure(n_rows, 3, height=1.75, squeeze=False)
    time = run.history["time"]
    for axes, name in zip(grid.flat, names):
        factor, unit = readable(run.history.units[name])
        axes.plot(*thin(time, factor * run.history[name], 250), linewidth=0.8)
        axes.set_title(label(name, unit), fontsize=8.5)
        axes.tick_params(labelsize=7.5)
    for axes in list(grid.flat)[len(names):]:
        axes.set_visible(False)
    return section("What else the programs reported", figure(svg_of(chart, "others"), "Over time [s]."))


def coupling(run):
    """Iterations of every step, and how fast their changes fell."""
    if not has_rows(run) or "iterations" not in run.history:
        return ""
    iterations = run.history["iterations"]
    facts = []
    for group, words in (("coupling", "coupling"), ("conservation", "conservation")):
        facts += [(f"{words}: {key.replace('_', ' ')}", number(value, 4)) for key, value in run.summary.get(group, {}).items()]
    changes = [name for name in run.history.names if name.endswith(".relative_change")]
    chart, (steps, residual) = new_figure(1, 2)
    time = run.history["time"]
    steps.plot(*thin(time, iterations), linewidth=0.8)
    steps.set(xlabel="time [s]", ylabel="iterations of a step", ylim=(0, max(2, iterations.max() * 1.1)))
    plotted = False
    for name in changes:
        values = run.history[name]
        if (values > 0).any():
            residual.semilogy(*thin(time[values > 0], values[values > 0]), label=name.split(".")[0], linewidth=0.8)
            plotted = True
    residual.set(xlabel="time [s]", ylabel="relative change at acceptance")
    if plotted:
        residual.legend(fontsize=8)
    else:
        residual.set_visible(False)
    return section("Coupling", table((), facts, numbers=(1,)) if facts else "",
                   figure(svg_of(chart, "coupling"), "Iterations of every accepted step and the last change of every field in it."),
                   figure(_fall_of_changes(run), "Change in each iteration: median over all steps, and the range that holds 80 % of them."))


def _fall_of_changes(run):
    table_ = run.iterations
    if table_ is None or len(table_) < 2 or table_["iteration"].max() < 2:
        return ""
    chart, axes = new_figure(height=2.4)
    last = int(min(table_["iteration"].max(), 40))
    drawn = False
    for name in [name for name in table_.names if name.endswith(".relative_change")]:
        parts = [table_[name][table_["iteration"] == k] for k in range(1, last + 1)]
        rows = [(k, *numpy.percentile(part[part > 0], (10, 50, 90))) for k, part in enumerate(parts, 1) if (part > 0).any()]
        if rows:
            k, low, middle, high = numpy.array(rows).T
            line, = axes.semilogy(k, middle, marker="o", markersize=3, label=name.split(".")[0])
            axes.fill_between(k, low, high, color=line.get_color(), alpha=0.15, linewidth=0)
            drawn = True
    axes.set(xlabel="iteration", ylabel="relative change")
    if drawn:
        axes.legend(fontsize=8)
    return svg_of(chart, "fall") if drawn else ""


def cost(run):
    """Where the time was spent."""
    programs = run.summary.get("programs", {})
    if not programs:
        return ""
    wall = run.summary.get("wall_seconds") or 0
    names = list(programs)
    seconds = [programs[name].get("seconds") or 0 for name in names]
    chart, axes = new_figure(height=0.55 + 0.34 * len(names))
    axes.barh(names, seconds, color="#2a6f97", height=0.6)
    if wall:
        axes.axvline(wall, color="#d1495b", linewidth=1)
        axes.annotate("wall time", (wall, -0.45), color="#d1495b", ha="right", va="bottom", fontsize=8,
                      xytext=(-4, 0), textcoords="offset points")
    axes.invert_yaxis()
    axes.set(xlabel="seconds of work")
    axes.grid(axis="y", visible=False)
    rows = []
    for name in names:
        entry = dict(programs[name])
        worked, memory = entry.pop("seconds", None), entry.pop("peak_memory_bytes", None)
        more = ", ".join(f"{key.replace('_', ' ')} {number(value, 4)}" for key, value in entry.items() if not isinstance(value, str))
        rows.append((name, number(worked, 4), number(100 * worked / wall, 3) if wall and worked is not None else "–",
                     number(memory / 2**20, 4) if memory else "–", more))
    return section("Time spent where", figure(svg_of(chart, "cost"), "Seconds that each program worked; what is missing to the wall time is waiting."),
                   table(("program", "seconds", "% of wall", "memory [MiB]", "more"), rows, numbers=(1, 2, 3)))


def machine(run):
    """Where and with what."""
    rows = [("version", f"{run.summary.get('version', 'unknown')}, commit {run.summary.get('commit', 'unknown')}"),
            ("scene", run.summary.get("scene", "unknown")),
            ("this page was written on", f"{platform.node()}: {_processor()}, {os.cpu_count()} cores, {platform.system()} {platform.release()}")]
    return section("Machine and version", table((), rows))


def _processor():
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next(line.split(":", 1)[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.machine()


def troubles(run):
    return "\n".join(f'<p class="trouble">{escape(trouble)}</p>' for trouble in run.troubles)
