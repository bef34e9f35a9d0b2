"""Several runs on one page: what differs in their scenes, their results side by side, their probes over each other."""

from html import escape

import numpy

from figures import label, new_figure, readable, svg_of
from general_sections import has_rows, last_part, moving_columns
from oscillation import thin
from page import figure, number, page, section, table
from scene_text import leaves


def comparison_page(runs):
    names = short_names(runs)
    body = [f"<h1>Comparison of {len(runs)} runs</h1>", differences(runs, names), results(runs, names), costs(runs, names)]
    body += [overlay(runs, names, column) for column in shared_columns(runs)]
    return page("Comparison", "\n".join(part for part in body if part))


def short_names(runs):
    """Names of the folders, with those above them where they are alike."""
    paths = [run.path.resolve() for run in runs]
    n_parts = 1
    while n_parts < 4 and len({path.parts[-n_parts:] for path in paths}) < len(paths):
        n_parts += 1
    return ["/".join(path.parts[-n_parts:]) for path in paths]


def differences(runs, names):
    """Fields of the scenes that are not the same in all runs."""
    scenes = [dict(leaves(run.scene)) for run in runs]
    fields = [field for field in dict.fromkeys(field for scene in scenes for field in scene)
              if len({str(scene.get(field)) for scene in scenes}) > 1]
    rows = [(field, *(str(scene.get(field, "–")) for scene in scenes)) for field in fields]
    if not rows:
        return section("What differs", "<p>The scenes are the same.</p>")
    return section("What differs", table(("field", *names), rows))


def results(runs, names):
    quantities = dict.fromkeys(name for run in runs for name in run.summary.get("quantities", {}))
    rows = []
    for quantity in quantities:
        entries = [run.summary.get("quantities", {}).get(quantity, {}) for run in runs]
        unit = next((entry["unit"] for entry in entries if entry.get("unit")), "")
        rows.append((label(quantity, "" if unit == "1" else unit), *(_with_spread(entry) for entry in entries)))
    rows.insert(0, ("status", *(run.summary.get("status", "unfinished") for run in runs)))
    return section("Results", table(("quantity", *names), rows, numbers=range(1, len(runs) + 1)))


def _with_spread(entry):
    text = number(entry.get("value"))
    return f"{text} ± {number(entry['spread'], 2)}" if entry.get("spread") else text


def costs(runs, names):
    keys = (("steps", "steps"), ("wall_seconds", "wall time [s]"), ("core_seconds", "computing [s]"))
    rows = [(text, *(number(run.summary.get(key), 4) for run in runs)) for key, text in keys]
    rows.append(("coupling iterations, mean", *(number(run.summary.get("coupling", {}).get("iterations_mean"), 4) for run in runs)))
    return section("Cost", table(("", *names), rows, numbers=range(1, len(runs) + 1)))


def shared_columns(runs):
    """The strongest moving column of each probe that several runs have, and the flow's."""
    found = {}
    for run in runs:
        columns = moving_columns(run) if has_rows(run, 8) else []
        for probe in dict.fromkeys(column.rsplit(".", 1)[0] for column in columns):
            best = max((c for c in columns if c.startswith(probe + ".")), key=lambda c: numpy.ptp(run.history[c][len(run.history) // 2:]))
            found[best] = found.get(best, 0) + 1
        for column in ("flow.rate", "flow.smallest_area"):
            if run.history is not None and column in run.history:
                found[column] = found.get(column, 0) + 1
    return [column for column, count in found.items() if count > 1]


def overlay(runs, names, column):
    chart, (whole, close) = new_figure(1, 2, gridspec_kw={"width_ratios": [2, 1]})
    unit = ""
    for run, name in zip(runs, names):
        if not has_rows(run, 8) or column not in run.history:
            continue
        factor, unit = readable(run.history.units[column])
        time, values = run.history["time"], factor * run.history[column]
        whole.plot(*thin(time, values), label=name, linewidth=0.8)
        late = time >= last_part(run, column, 3)
        close.plot(*thin(1e3 * (time[late] - time[-1]), values[late]))
    whole.set(xlabel="time [s]", ylabel=label(column, unit))
    close.set(xlabel="time before the end [ms]")
    whole.legend(fontsize=8)
    return section(escape(column), figure(svg_of(chart, "overlay-" + column), f"{column} of the runs; right: their last cycles."))
