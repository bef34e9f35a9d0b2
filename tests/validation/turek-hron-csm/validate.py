#!/usr/bin/python3
"""Turek-Hron CSM1, CSM2, CSM3: the beam behind a cylinder under gravity against mesh and step (about 3 minutes; --quick 40 s)."""

import sys
from pathlib import Path

import numpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import stored_runs as runs  # noqa: E402

SOURCE = "Turek, Hron 2006; featflow tables"
YOUNG_MODULUS = {"CSM1": 1.4e6, "CSM2": 5.6e6, "CSM3": 1.4e6}
STATIC_MESHES = [(10, 1), (20, 2), (40, 4), (80, 8)]
# Mesh, step [s], method: the mesh at a small step, the step on a mesh that is fine enough, and a motion without dissipation.
MOTIONS = [((10, 1), 0.005, "implicit"), ((20, 2), 0.02, "implicit"), ((20, 2), 0.01, "implicit"), ((20, 2), 0.005, "implicit"),
           ((20, 2), 0.0025, "implicit"), ((40, 4), 0.005, "implicit"), ((20, 2), 0.005, "explicit"), ((40, 4), 0.005, "explicit")]
QUICK_MOTIONS = [((20, 2), 0.01, "implicit"), ((20, 2), 0.005, "implicit"), ((20, 2), 0.005, "explicit")]
METHOD = {"implicit": "method: GENERALIZED_ALPHA", "explicit": "method: CENTRAL_DIFFERENCE"}
BAND = {"ux_mean": 0.03, "ux_amplitude": 0.03, "uy_mean": 0.02, "uy_amplitude": 0.005, "uy_frequency": 0.002}

SCENE = """title: "{title}"
time {{ end: {end}  step: {step} }}
solid {{
  body {{
    name: "beam"
    cylinder_beam {{ elements_x: {nx}  elements_y: {ny} }}
    material {{ density: 1000  saint_venant_kirchhoff {{ young_modulus: {young_modulus}  poisson_ratio: 0.4 }} }}
    fixed: "root"
    symmetry {{ surface: "front"  normal: Z }}
    symmetry {{ surface: "back"  normal: Z }}
  }}
  gravity {{ direction {{ y: -1 }}  value {{ {rows} }} }}
  time_integration {{ {method} }}
}}
output {{ probe {{ name: "A"  at {{ marker: "A" }} }} }}
"""


def solve(options, name, **fields):
    folder = Path(options.out).resolve() / name
    code = runs.run_text(options.couplet, SCENE.format(title=name, **fields), folder, options.set)
    if code != 0:
        sys.exit(f"{name}: exit code {code}: {runs.last_words(folder)}")
    print(f"  {name} done", flush=True)
    return runs.read_history(folder), folder


def highest_points(time, value):
    """Times and values of local maxima, by the parabola through three samples."""
    middle = numpy.flatnonzero((value[1:-1] > value[:-2]) & (value[1:-1] >= value[2:])) + 1
    a, b, c = value[middle - 1], value[middle], value[middle + 1]
    shift = (a - c) / (2 * (a - 2 * b + c))
    return time[middle] + shift * (time[1] - time[0]), b - (a - c) * shift / 4


def main_peaks(time, value):
    """The highest point of each main swing: maxima above the middle, one for each crossing of it upwards."""
    when, height = highest_points(time, value)
    middle = (value.max() + value.min()) / 2
    crossings = time[1:][(value[:-1] < middle) & (value[1:] >= middle)]
    swing = numpy.searchsorted(crossings, when)
    best = [numpy.flatnonzero((swing == s) & (height > middle)) for s in numpy.unique(swing)]
    best = [group[height[group].argmax()] for group in best if len(group)]
    return when[best], height[best]


def last_period(time, value):
    """Mean and amplitude as the benchmark defines them, by the extremes of the last period; frequency by all periods."""
    when, height = main_peaks(time, value)
    inside = (time >= when[-2]) & (time <= when[-1])
    lowest = -highest_points(time[inside], -value[inside])[1].max()
    # A single period is blurred by the higher modes that ride on it.
    return {"mean": (height[-1] + lowest) / 2, "amplitude": (height[-1] - lowest) / 2, "frequency": (len(when) - 1) / (when[-1] - when[0])}


def static_rows(options, case, reference):
    for nx, ny in STATIC_MESHES:
        name = f"{case}-{nx}x{ny}"
        history, folder = solve(options, name, nx=nx, ny=ny, young_modulus=YOUNG_MODULUS[case], end=1, step=0.25, method="method: STATIC",
                                rows="row { time: 0  value: 0 }  row { time: 1  value: 2 }")
        for axis in "xy":
            expected = reference[case, f"u{axis}"]
            band = tuple(sorted((expected * 0.999, expected * 1.001))) if nx >= 40 else None
            yield runs.row(name, f"u{axis}", history[f"A.{axis}"][-1], expected, SOURCE, folder, band, mesh=f"{nx}x{ny}",
                           newton_iterations=history["solid.newton_iterations"].sum())


def motion_rows(options, reference):
    for (nx, ny), step, method in QUICK_MOTIONS if options.quick else MOTIONS:
        name = f"CSM3-{nx}x{ny}-{step}-{method}"
        history, folder = solve(options, name, nx=nx, ny=ny, young_modulus=YOUNG_MODULUS["CSM3"], end=10, step=step, method=METHOD[method],
                                rows="row { time: 0  value: 2 }")
        varied = {"mesh": f"{nx}x{ny}", "dt": step, "method": method}
        time = numpy.concatenate([[0], history["time"]])
        for axis in "xy":
            found = last_period(time, numpy.concatenate([[0], history[f"A.{axis}"]]))
            for quantity, value in found.items():
                if f"u{axis}_{quantity}" not in BAND:
                    continue
                expected = reference["CSM3", f"u{axis}_{quantity}"]
                share = BAND[f"u{axis}_{quantity}"]
                published = [value for (case, name), value in reference.items() if case == "CSM3" and name.startswith(f"u{axis}_{quantity}")]
                smallest, largest = sorted(published, key=abs)[0], sorted(published, key=abs)[-1]
                band = tuple(sorted((smallest * (1 - share), largest * (1 + share)))) if nx >= 20 and step <= 0.005 else None
                yield runs.row(name, f"u{axis}_{quantity}", value, expected, SOURCE, folder, band, **varied)
        yield runs.row(name, "ms_per_step", 1e3 * runs.core_seconds(folder) / len(history["time"]), None, "core time", folder, **varied)


def main():
    parser = runs.arguments(__doc__, "turek-hron-csm")
    parser.add_argument("--quick", action="store_true", help="fewer steps of CSM3")
    options = parser.parse_args()
    table = runs.read_reference(HERE / "reference.csv", words=["case", "quantity"])
    reference = dict(zip(zip(table["case"], table["quantity"]), table["value"]))
    rows = []
    for case in ("CSM1", "CSM2"):
        if not options.only or case in options.only:
            rows += static_rows(options, case, reference)
    if not options.only or "CSM3" in options.only:
        rows += motion_rows(options, reference)
    return runs.report(rows, options.json)


if __name__ == "__main__":
    sys.exit(main())
