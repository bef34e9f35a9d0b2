"""Keeps the numbers of a validation in the table beside it: results.csv, with the commit that they were found with.

    couplet validate NAME --json rows.json && python3 tests/validation/keep_table.py NAME rows.json

Rows of the same case and quantity are replaced, others stay: long validations can be run case by case."""

import argparse
import csv
import json
import subprocess
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
COLUMNS = ["case", "quantity", "ours", "reference", "relative_error", "verdict", "core_seconds", "commit", "source"]


def commit_of(folder):
    """Of the sources, a + behind it where they have changed since."""
    git = ["git", "-C", str(folder)]
    name = subprocess.run([*git, "rev-parse", "--short=8", "HEAD"], capture_output=True, text=True, check=True).stdout.strip()
    changed = subprocess.run([*git, "diff", "--quiet", "HEAD", "--", ":!*.md", ":!*.csv"]).returncode != 0
    return name + ("+" if changed else "")


def as_text(row, commit):
    number = lambda value: "" if value is None else f"{value:.6g}"
    return {"case": row["case"], "quantity": row["quantity"], "ours": number(row["value"]), "reference": number(row["reference"]),
            "relative_error": "" if row["relative_error"] is None else f"{row['relative_error']:.4f}", "verdict": row["verdict"],
            "core_seconds": f"{row['core_seconds']:.0f}", "commit": commit, "source": row["source"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", help="a folder beside this file")
    parser.add_argument("rows", help="what --json wrote")
    parser.add_argument("--sources", default=FOLDER, help="of the programs that were run; default: these")
    options = parser.parse_args()
    table = FOLDER / options.name / "results.csv"
    if not table.parent.is_dir():
        parser.error(f"there is no validation {options.name}")
    kept = {}
    if table.exists():
        with open(table, newline="") as file:
            kept = {(row["case"], row["quantity"]): row for row in csv.DictReader(file)}
    commit = commit_of(options.sources)
    for row in json.loads(Path(options.rows).read_text()):
        kept[row["case"], row["quantity"]] = as_text(row, commit)
    with open(table, "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(kept.values())
    print(f"{table}: {len(kept)} rows")


if __name__ == "__main__":
    main()
