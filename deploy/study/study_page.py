"""The page of a study: error against cost, convergence along every axis, all runs."""

from html import escape

import numpy

from assessment import efficient, finest_indices
from figures import COLOURS, label, new_figure, svg_of
from page import figure, number, page, section, table
from study_output import describe


def study_page(title, axes, runs, assessments, wanted):
    body = [f"<h1>{escape(title)}</h1>",
            f'<p class="soft">{len(runs)} runs: every combination of {escape(", ".join(axis.name for axis in axes))}</p>',
            conclusions(axes, assessments, wanted)]
    for assessment in assessments:
        body.append(section(assessment.quantity,
                            figure(error_against_cost(axes, runs, assessment), "Error against cost; the line joins the runs that no other beats in both."),
                            figure(convergence(axes, runs, assessment), "The quantity with each axis, the others at their finest; dashed: the fitted power law.")))
    body.append(section("All runs", all_runs(axes, runs, assessments)))
    return page(title, "\n".join(body))


def conclusions(axes, assessments, wanted):
    rows = []
    for a in assessments:
        orders = [f"{axis.name}: " + (f"{c.order:.2f}" if c.order is not None else c.remark) for axis, c in zip(axes, a.along) if c]
        rows.append((label(a.quantity, "" if a.unit == "1" else a.unit), describe(a), "; ".join(orders)))
    choices = [(f"{100 * error:g} %", run.combination.label if run else "none of these runs", number(run.cost, 3) if run else "–")
               for error, run in wanted]
    return section("What was found", table(("quantity", "value", "observed order"), rows),
                   "<p></p>", table(("wanted error, all quantities", "cheapest setting", "core seconds"), choices, numbers=(2,)))


def error_against_cost(axes, runs, assessment):
    points = [(run.cost, assessment.errors[k], run) for k, run in enumerate(runs) if run.cost and assessment.errors[k]]
    if not points:
        return ""
    chart, plot = new_figure(height=3.6)
    last = len(axes) - 1
    for i, level in enumerate(axes[last].levels):
        mine = [(cost, error, run) for cost, error, run in points if run.combination.indices[last] == i]
        plot.loglog([p[0] for p in mine], [p[1] for p in mine], "o", markersize=6, color=COLOURS[i % len(COLOURS)],
                    label=f"{axes[last].name} = {level.label}")
        for cost, error, run in mine:
            text = ", ".join(level.label for level in run.combination.levels[:last])
            plot.annotate(text, (cost, error), fontsize=7, color="#555", xytext=(5, 3), textcoords="offset points")
    front = [k for k in efficient(runs, assessment.errors) if assessment.errors[k]]
    plot.loglog([runs[k].cost for k in front], [assessment.errors[k] for k in front], color="#999", linewidth=1, zorder=0)
    plot.set(xlabel="cost [core seconds]", ylabel=f"error of {assessment.quantity}")
    plot.legend(fontsize=8)
    return svg_of(chart, "cost-" + assessment.quantity)


def convergence(axes, runs, assessment):
    shown = [i for i, axis in enumerate(axes) if axis.sizes() is not None and len(axis.levels) > 1]
    if not shown:
        return ""
    chart, grid = new_figure(1, len(shown), squeeze=False)
    finest = finest_indices(axes)
    for plot, i in zip(grid[0], shown):
        sizes = numpy.array(axes[i].sizes())
        line = [run for run in runs if run.combination.indices[:i] + run.combination.indices[i + 1:] == finest[:i] + finest[i + 1:]]
        rows = [(sizes[run.combination.indices[i]], run.values.get(assessment.quantity)) for run in line]
        rows = sorted(row for row in rows if row[1] is not None)
        if not rows:
            continue
        h, f = numpy.array(rows).T
        plot.plot(h, f, "o-", markersize=4)
        found = assessment.along[i]
        if found and found.is_trusted:
            fine = numpy.linspace(0, h.max(), 60)
            scale = (f[-1] - found.value) / h[-1] ** found.order
            plot.plot(fine, found.value + scale * fine ** found.order, "--", color="#999", linewidth=1)
            plot.plot(0, found.value, "D", color="#d1495b", markersize=5)
        plot.set(xlabel=f"size, {axes[i].name} (finest = 1)", ylabel=label(assessment.quantity, "" if assessment.unit == "1" else assessment.unit), xlim=(0, None))
    return svg_of(chart, "convergence-" + assessment.quantity)


def all_runs(axes, runs, assessments):
    head = [axis.name for axis in axes] + ["status", "core seconds"]
    for a in assessments:
        head += [a.quantity, "error"]
    rows = []
    for k, run in enumerate(runs):
        row = [level.label for level in run.combination.levels] + [run.status, number(run.cost, 4)]
        for a in assessments:
            row += [number(run.values.get(a.quantity), 7), number(a.errors[k], 2)]
        rows.append(row)
    return table(head, rows, numbers=range(len(axes) + 1, len(head)))
