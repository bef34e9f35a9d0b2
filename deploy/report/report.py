#!/usr/bin/python3
"""Writes report.html: one self-contained page for a run, or a comparison of several."""

import argparse
import sys
from pathlib import Path

import body_sections as bodies
import comparison
import flow_sections as flow
import general_sections as general
import solid_sections as solid
import vocal_fold_sections as fold
from figures import svg_of
from page import page
from run_folder import RunFolder
from scene_text import find


def report_page(run):
    """The page of one run. Sections appear where their data are there."""
    sections = [
        general.heading(run), general.quantities(run), fold.outline(run), solid.pictures(run), solid.open_area(run),
        solid.load_and_displacement(run) or general.probes(run), solid.loads(run), fold.glottal_flow(run),
        fold.pressure_along_glottis(run), flow.pictures(run), bodies.forces(run), flow.integrals(run), flow.planes_and_points(run), flow.errors(run),
        flow.solver(run), solid.energy(run), solid.contact(run), solid.reactions(run), solid.steps(run), general.coupling(run),
        general.cost(run),
        general.other_columns(run, [*fold.FLOW_COLUMNS, *flow.columns_shown(run), *solid.columns_shown(run)]),
        general.what_was_run(run), general.machine(run),
    ]
    sections.insert(1, general.troubles(run))  # all have been noticed by now
    return page(str(find(run.scene, "title", run.path.resolve().name)), "\n".join(part for part in sections if part))


def write(path, text):
    """The whole page or none: a temporary name, then a rename."""
    temporary = path.with_name(path.name + ".part")
    temporary.write_text(text, encoding="utf-8")
    temporary.replace(path)


def main():
    parser = argparse.ArgumentParser(prog="couplet report", description=__doc__)
    parser.add_argument("folders", metavar="DIR", nargs="+", type=Path, help="folder of a run")
    parser.add_argument("--out", type=Path, help="file to write; default: report.html in the first folder, comparison.html for several")
    parser.add_argument("--print", action="store_true", help="say where the page is")
    parser.add_argument("--outline", type=Path, metavar="FILE", help="also write the outline over a cycle, mean of all that are stored, as an SVG file")
    options = parser.parse_args()
    for folder in options.folders:
        if not folder.is_dir():
            print(f"couplet: {folder}: there is no such folder; give the folder of a run", file=sys.stderr)
            return 5
    runs = [RunFolder(folder) for folder in options.folders]
    if len(runs) == 1:
        out, text = options.out or options.folders[0] / "report.html", report_page(runs[0])
    else:
        out, text = options.out or options.folders[0] / "comparison.html", comparison.comparison_page(runs)
    try:
        write(out, text)
        if options.outline:
            write_outline(runs[0], options.outline)
    except OSError as error:
        print(f"couplet: {out}: cannot be written: {error.strerror}; choose another place with --out", file=sys.stderr)
        return 5
    if options.print:
        print(out.resolve())
    return 0


def write_outline(run, path):
    states = run.results("hexahedron20")
    chart = states and fold.outline_figure(run, states, fold.cycle_length(run), width=8.0, height=3.6, mean=True)
    if chart:
        write(path, svg_of(chart, "outline", trim=True) + "\n")


if __name__ == "__main__":
    sys.exit(main())
