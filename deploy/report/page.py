"""The page around the sections: one self-contained HTML file."""

from html import escape

CSS = """
:root { --ink: #23262b; --soft: #646b75; --line: #e3e5e9; --paper: #fff; --accent: #2a6f97; }
* { box-sizing: border-box; }
body { margin: 0; background: #f5f6f8; color: var(--ink); font: 15px/1.5 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
main { max-width: 1020px; margin: 0 auto; padding: 28px 20px 60px; }
h1 { font-size: 1.6rem; line-height: 1.25; margin: 0 0 4px; }
h2 { font-size: 1.12rem; margin: 0 0 10px; }
section { background: var(--paper); border: 1px solid var(--line); border-radius: 8px; padding: 18px 22px; margin: 16px 0; }
figure { margin: 6px 0 14px; } figure svg, figure img { width: 100%; height: auto; display: block; }
figcaption, .soft { color: var(--soft); font-size: 0.89rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 0.93rem; }
th { text-align: left; font-weight: 600; color: var(--soft); }
th, td { padding: 5px 14px 5px 0; border-bottom: 1px solid var(--line); vertical-align: top; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.status { display: inline-block; padding: 1px 10px; border-radius: 10px; font-size: 0.85rem; font-weight: 600; color: #fff; background: #66a182; }
.status.stopped { background: #d08c2e; } .status.failed { background: #c43d50; }
.failure { border-left: 4px solid #c43d50; padding: 6px 12px; background: #fdf2f4; margin: 12px 0 0; }
.trouble { border-left: 4px solid #d08c2e; padding: 6px 12px; background: #fdf7ee; margin: 12px 0 0; }
code, pre { font-family: ui-monospace, "DejaVu Sans Mono", monospace; font-size: 0.86rem; }
pre { overflow-x: auto; background: #f5f6f8; padding: 10px 12px; border-radius: 6px; }
details summary { cursor: pointer; color: var(--accent); }
"""


def page(title, body):
    return (f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
            f'<meta name="viewport" content="width=device-width, initial-scale=1">'
            f"<title>{escape(title)}</title><style>{CSS}</style></head>\n<body><main>\n{body}\n</main></body></html>\n")


def section(title, *content):
    inside = "\n".join(part for part in content if part)
    return f"<section><h2>{escape(title)}</h2>\n{inside}\n</section>" if inside else ""


def figure(svg, caption):
    return f"<figure>{svg}<figcaption>{escape(caption)}</figcaption></figure>" if svg else ""


def table(head, rows, numbers=()):
    """`numbers`: indices of the columns that hold numbers."""
    def cell(kind, i, text):
        css = ' class="number"' if i in numbers else ""
        return f"<{kind}{css}>{escape(str(text))}</{kind}>"
    lines = ["<tr>" + "".join(cell("th", i, text) for i, text in enumerate(head)) + "</tr>"] if head else []
    lines += ["<tr>" + "".join(cell("td", i, text) for i, text in enumerate(row)) + "</tr>" for row in rows]
    return '<div class="scroll"><table>' + "\n".join(lines) + "</table></div>"


def number(value, digits=5):
    """A number as a person reads it; a dash for none."""
    if value is None or value != value:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}".replace(",", " ")
    return f"{value:.{digits}g}"
