"""Forces on bodies in a stream: the grid around the body, coefficients, shedding, and the picture of curves beside published ones."""

from pathlib import Path

import numpy

import stored_runs as runs


def fine_width(width, axes="xy"):
    """Settings that give the fine region around the body cells of this width."""
    return [f"flow.navier_stokes.grid.{axis}.stretched.region[0].width={width}" for axis in axes]


def solve(options, scene, name, settings, ranks=1):
    """History and folder of a run, finished ones are used again; a RuntimeError when the run fails."""
    folder = Path(options.out).resolve() / name
    code = runs.run(options.couplet, scene, folder, [*settings, *options.set], ["--no-report", "--flow-ranks", str(ranks)])
    if code != 0:
        raise RuntimeError(f"exit code {code}: {runs.last_words(folder)}")
    print(f"  {name} done", flush=True)
    return runs.read_history(folder), folder


def mean_step(history):
    """Mean length of the steps that the flow chose inside those of history.csv."""
    return history["time"][-1] / history["flow.substeps"].sum()


def whole_cycles(time, value):
    """First and last upward crossing of the mean, and how many cycles lie between; a RuntimeError when there are none."""
    level = value - value.mean()
    at = numpy.flatnonzero((level[:-1] < 0) & (level[1:] >= 0))
    if len(at) < 3:
        raise RuntimeError("fewer than two cycles of shedding: the run is too short, or the flow is steady")
    crossings = time[at] - level[at] * (time[at + 1] - time[at]) / (level[at + 1] - level[at])
    return crossings[0], crossings[-1], len(crossings) - 1


def shedding(time, drag, lift):
    """Mean drag, amplitude of the lift and Strouhal number over the whole cycles of a periodic flow."""
    first, last, cycles = whole_cycles(time, lift)
    inside = (time >= first) & (time <= last)
    return {"drag_coefficient": drag[inside].mean(), "lift_amplitude": numpy.ptp(lift[inside]) / 2, "strouhal_number": cycles / (last - first)}


def high_pass_rms(time, value, shortest):
    """Root mean square of what a running mean over `shortest` of time, taken twice, leaves of a curve: its noise."""
    width = max(3, int(round(shortest / (time[1] - time[0]))) | 1)
    window = numpy.convolve(numpy.ones(width) / width, numpy.ones(width) / width)
    smooth = numpy.convolve(value, window, "valid")
    rest = value[width - 1 : len(value) - width + 1] - smooth
    return numpy.sqrt((rest**2).mean())


def draw(path, panels, columns):
    """Writes a picture. `panels`: (title, x label, y label, curves), a curve: (label, x, y, style of matplotlib)."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    rows = -(-len(panels) // columns)
    figure, axes = pyplot.subplots(rows, columns, figsize=(10 if columns == 1 else 5 * columns, 3.5 * rows), squeeze=False, constrained_layout=True)
    for axis, (title, x_label, y_label, curves) in zip(axes.flat, panels):
        for label, x, y, style in curves:
            axis.plot(x, y, style, label=label, markersize=4, linewidth=1.2, markerfacecolor="none")
        axis.set(title=title, xlabel=x_label, ylabel=y_label)
        axis.grid(alpha=0.3)
    beside = {"loc": "upper left", "bbox_to_anchor": (1, 1)} if columns == 1 else {}
    axes.flat[0].legend(fontsize="small", **beside)
    for axis in list(axes.flat)[len(panels):]:
        axis.axis("off")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
    print(f"  picture: {path}", flush=True)
