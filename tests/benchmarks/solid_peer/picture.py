"""Error against processor seconds, one picture a family of cases."""

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

TITLES = {"slender": "slender: cantilever, large rotation", "solid": "solid: hollow sphere, Poisson ratio 0.4",
          "near_incompressible": "nearly incompressible: hollow cylinder, Poisson ratio 0.4999",
          "dynamic": "dynamic: first swing of the flag", "flag": "flag under its weight"}
COLOURS = {"couplet": "#1f5fa8", "calculix": "#c8641e"}
DASHES = ["-", "--", ":", "-.", (0, (1, 3)), (0, (5, 4))]


def draw(rows, family, path):
    """One line for each program and setting, from mesh to finer mesh."""
    rows = [row for row in rows if row.get("family") == family and row["error"] and row["core_seconds"]]
    lines = {}
    for row in rows:
        setting = "" if family == "dynamic" else row["setting"]
        case = row["case"] + ", " if family == "flag" else ""
        lines.setdefault((row["program"], case + setting), []).append((row["core_seconds"], row["error"]))
    figure, axes = pyplot.subplots(figsize=(6.4, 4.2), layout="constrained")
    count = dict.fromkeys(COLOURS, 0)
    for (program, setting), points in lines.items():
        axes.loglog(*zip(*points), marker="o", markersize=3.5, linewidth=1.2, color=COLOURS[program],
                    linestyle=DASHES[count[program] % len(DASHES)], label=f"{program} {setting}".strip())
        count[program] += 1
    axes.set_xlabel("processor seconds of the whole run")
    axes.set_ylabel("relative error")
    axes.set_title(TITLES[family], fontsize=9)
    axes.legend(frameon=False, fontsize=6.5)
    axes.grid(alpha=0.3, which="both", linewidth=0.4)
    figure.savefig(path, metadata={"Date": None})
    pyplot.close(figure)


def draw_all(rows, folder):
    matplotlib.rcParams.update({"svg.hashsalt": "couplet", "svg.fonttype": "none"})  # the same picture has the same bytes, and few
    for family in TITLES:
        if any(row.get("family") == family and row["error"] for row in rows):
            draw(rows, family, folder / f"speed_{family}.svg")
