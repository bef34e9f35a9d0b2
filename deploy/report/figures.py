"""Plots as SVG text, and pictures of fields as PNG, that stand inside a page: one style, no files, no network."""

import base64
import io
import re

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402
from matplotlib.ticker import FuncFormatter, NullFormatter  # noqa: E402

COLOURS = ["#2a6f97", "#d1495b", "#edae49", "#66a182", "#6d597a", "#8d99ae", "#3d405b", "#b56576"]

pyplot.rcParams.update({
    "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 9.5, "axes.prop_cycle": pyplot.cycler(color=COLOURS),
    "axes.spines.top": False, "axes.spines.right": False, "axes.edgecolor": "#555", "axes.labelcolor": "#333",
    "axes.grid": True, "grid.color": "#e7e7ea", "grid.linewidth": 0.7, "xtick.color": "#555", "ytick.color": "#555",
    "lines.linewidth": 1.2, "legend.frameon": False, "figure.constrained_layout.use": True, "path.simplify": True,
    "text.parse_math": False, "axes.titlesize": 10, "axes.titlecolor": "#333", "axes.titlelocation": "left", "axes.formatter.useoffset": False,
})


def new_figure(n_rows=1, n_columns=1, width=9.0, height=2.7, **options):
    """Figure and its axes; sizes in inches, height of one row."""
    return pyplot.subplots(n_rows, n_columns, figsize=(width, height * n_rows), **options)


SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def _power_of_ten(value, _=None):
    mantissa, _, exponent = f"{value:.3e}".partition("e")
    factor = "" if float(mantissa) == 1 else f"{float(mantissa):g}·"
    return f"{factor}10{str(int(exponent)).translate(SUPERSCRIPTS)}"


def _write_powers(figure):
    """Numbers along logarithmic axes in plain letters: matplotlib's own are formulas, which are not parsed here."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            if axis.get_scale() != "log":
                continue
            low, high = sorted(axis.get_view_interval())
            axis.set_major_formatter(FuncFormatter(_power_of_ten))
            axis.set_minor_formatter(FuncFormatter(_power_of_ten) if low > 0 and high < 10 * low else NullFormatter())


def legend_above(figure, axes, n_columns=6):
    """What the lines of the axes are, in rows above all axes of the figure, which grows by them."""
    handles, names = axes.get_legend_handles_labels()
    width, height = figure.get_size_inches()
    rows = 0.2 * -(-len(names) // n_columns)
    figure.set_size_inches(width, height + rows)
    figure.get_layout_engine().set(rect=(0, 0, 1, height / (height + rows)))
    figure.legend(handles, names, loc="upper left", ncols=n_columns, fontsize=8)


def svg_of(figure, name, trim=False):
    """The figure as SVG that scales with the page. `name` keeps the ids of several figures on one page apart. `trim` fits the picture
    to what is drawn, for axes that keep their own proportions."""
    matplotlib.rcParams["svg.hashsalt"] = name
    _write_powers(figure)
    file = io.StringIO()
    figure.savefig(file, format="svg", metadata={"Date": None, "Creator": None}, bbox_inches="tight" if trim else None)
    pyplot.close(figure)
    text = file.getvalue()
    text = text[text.index("<svg"):]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.S)
    text = re.sub(r'<svg ([^>]*?)width="[^"]*"', r"<svg \1", text, count=1)
    text = re.sub(r'<svg ([^>]*?)height="[^"]*"', r"<svg \1", text, count=1)
    text = re.sub(r'\bid="((?:figure|axes|patch|line2d|text|matplotlib|xtick|ytick|legend|LineCollection|PathCollection|'
                  r'QuadMesh|FillBetweenPolyCollection|PolyCollection)[^"]*)"', "", text)
    return text.strip()


def png_of(figure, dots_per_inch=130):
    """The figure as a picture of dots that stands inside a page: for fields of many cells."""
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=dots_per_inch)
    pyplot.close(figure)
    return f'<img alt="" src="data:image/png;base64,{base64.b64encode(file.getvalue()).decode()}">'


SCALES = {"m": (1e3, "mm"), "m^2": (1e6, "mm²"), "m^3/s": (1e6, "ml/s")}


def readable(unit):
    """Factor and name of the unit that a plot shows for an SI unit of tissue mechanics."""
    return SCALES.get(unit, (1.0, "" if unit == "1" else unit))


def label(name, unit):
    return f"{name} [{unit}]" if unit else name
