#!/usr/bin/python3
"""Messages and bytes of a flow step, counted on 1 to 64 ranks, and what a model of them says about 4096 ranks."""

import math

import matplotlib
import numpy
import rank_measurement

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

# A usual cluster, stated and not measured: latency of a message between nodes, a rank's share of the network, and how much slower a
# core works when all cores of its processor share the memory.
LATENCY = 2e-6  # [s]
BANDWIDTH = 1e9  # [byte/s]
SHARED_MEMORY = 3.0
# The grids of the dissertation and between, and the numbers of ranks.
GRIDS = [256, 512, 1024, 2048]
RANKS = [64, 512, 4096]
# Steps are counted on these: (ranks, cells along each axis).
COUNTED = [(1, 32), (2, 32), (4, 32), (8, 32), (16, 32), (32, 32), (64, 32), (8, 16), (8, 64), (64, 16), (64, 64), (64, 128)]


def measure(ranks, cells, steps):
    return rank_measurement.measure("measure-taylor-green", ranks, ["--n", str(cells), "--steps", str(steps), "--pressure", "multigrid"])


class Model:
    """Per step and rank, with I pressure iterations on n^3 cells and P = p^3 ranks with 26 neighbours each:
        messages = 26 (a + I (b + c log2 n)),   bytes = s (d + e I),   s = 6 (n/p)^2 the surface of a block,
        seconds = (n^3/P) t + messages latency + bytes / bandwidth + 2 log2(P) reductions latency.
    a ... e are fitted to what was counted on 64 ranks, where every rank has 26 neighbours; t is measured on one rank."""

    def __init__(self, rows, seconds_per_cell):
        full = [row for row in rows if row["ranks"] == 64]
        iterations = numpy.array([row["pressure_iterations"] for row in full])
        levels = numpy.log2([row["n"] for row in full])
        messages = numpy.array([row["messages_per_step"] for row in full])
        terms = numpy.stack([numpy.ones_like(levels), iterations * levels], axis=1)
        (self.fixed, self.per_level), *_ = numpy.linalg.lstsq(terms, messages, rcond=None)
        self.misfit = numpy.abs(terms @ [self.fixed, self.per_level] / messages - 1).max()
        surface = numpy.array([6 * (row["n"] / 4) ** 2 for row in full])
        self.bytes_per_surface = (numpy.array([row["bytes_per_step"] for row in full]) / surface)[-1]
        self.reductions = numpy.mean([row["reductions_per_step"] for row in full])
        self.iterations = max(iterations)
        self.seconds_per_cell = seconds_per_cell

    def parts(self, cells, ranks):
        """Seconds of a step: computing, latency, bytes, reductions."""
        side = cells / ranks ** (1 / 3)
        return (cells**3 / ranks * self.seconds_per_cell * SHARED_MEMORY,
                (self.fixed + self.per_level * self.iterations * math.log2(cells)) * LATENCY,
                self.bytes_per_surface * 6 * side**2 / BANDWIDTH,
                2 * math.log2(ranks) * self.reductions * LATENCY)


def draw(model, path):
    figure, axes = pyplot.subplots(figsize=(6.4, 3.6), layout="constrained")
    ranks = 2.0 ** numpy.arange(0, 13)
    for cells in GRIDS:
        seconds = [sum(model.parts(cells, p)) if p > 1 else model.parts(cells, 1)[0] for p in ranks]
        line, = axes.loglog(ranks, seconds, "o-", markersize=3, label=f"{cells}³ cells")
        axes.loglog(ranks, model.parts(cells, 1)[0] / ranks, ":", color=line.get_color(), linewidth=1)
    axes.set_xlabel("ranks")
    axes.set_ylabel("seconds a step")
    axes.set_title("predicted; dotted: computing alone", fontsize=9)
    axes.legend(frameon=False, fontsize=8)
    axes.grid(alpha=0.3)
    figure.savefig(path, metadata={"Date": None})


def main():
    parser = rank_measurement.parser_for(__doc__)
    parser.add_argument("--plot", help="write the predicted times as a picture")
    options = parser.parse_args()
    if options.about:
        print(__doc__.splitlines()[0])
        return
    matplotlib.rcParams["svg.hashsalt"] = "couplet"  # the same picture has the same bytes
    counted = []
    print(f"{'ranks':>5} {'n':>4} {'blocks':>9} {'iterations':>10} {'messages':>9} {'bytes':>9} {'reductions':>10}   of the busiest rank, a step")
    for ranks, cells in COUNTED:
        row = measure(ranks, cells, 3)
        row["kind"] = "counted"
        counted.append(row)
        print(f"{ranks:5d} {cells:4d} {'x'.join(map(str, row['shape'])):>9} {row['pressure_iterations']:10.2f} {row['messages_per_step']:9.0f} "
              f"{row['bytes_per_step']:9.0f} {row['reductions_per_step']:10.1f}", flush=True)
    single = measure(1, 128, 10)
    model = Model(counted, 1e-9 * single["ns_per_cell_step_best"])
    print(f"\nmodel: messages = {model.fixed:.0f} + {model.per_level:.1f} I log2 n (misfit {model.misfit:.0%}); {model.bytes_per_surface:.0f} bytes a shared "
          f"face; I = {model.iterations:.1f}; {1e9 * model.seconds_per_cell:.0f} ns a cell on one rank, times {SHARED_MEMORY:g} where "
          f"all cores share the memory; latency {LATENCY:g} s, {BANDWIDTH:g} byte/s a rank")
    print(f"{'n':>5} {'ranks':>5} {'cells a rank':>12} {'computing':>10} {'latency':>9} {'bytes':>9} {'reductions':>10} {'ms a step':>9} {'efficiency':>10}")
    predicted = []
    for cells in GRIDS:
        for ranks in RANKS:
            parts = model.parts(cells, ranks)
            predicted.append({"kind": "predicted", "n": cells, "ranks": ranks, "seconds_per_step": sum(parts), "efficiency": parts[0] / sum(parts),
                              **dict(zip(("computing", "latency", "bytes", "reductions"), parts))})
            print(f"{cells:5d} {ranks:5d} {cells**3 / ranks:12.0f} " + " ".join(f"{1e3 * part:9.3f}" for part in parts) +
                  f"  {1e3 * sum(parts):9.3f} {parts[0] / sum(parts):10.1%}")
    if options.plot:
        draw(model, options.plot)
    rank_measurement.write_rows(options.json, counted + predicted)


if __name__ == "__main__":
    main()
