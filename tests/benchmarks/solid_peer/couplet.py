"""solid-server on scenes that are written here."""

import csv
import json
from dataclasses import dataclass, field

import numpy

import measure
import mesh


@dataclass
class Solved(measure.Timed):
    summary: dict = field(default_factory=dict)
    history: dict = field(default_factory=dict)  # column without unit: values
    frequencies: list = field(default_factory=list)  # [Hz]
    results: str = ""  # path of the results file

    @property
    def of_solid(self):
        return self.summary["programs"]["solid-server"]

    def mesh(self):
        return mesh.read(self.results)

    def displacement(self):
        return mesh.last_displacement(self.results)


def scene(body, loads, end=1.0, step=1.0, method="STATIC", output="", settings=""):
    """The text of a scene with one body; its fields at the end are kept, so that meshes can be read."""
    return "\n".join(['title: "A case that is solved by two programs"', f"time {{ end: {end} step: {step} }}",
                      f"solid {{ body {{ name: \"body\" {body} }}", loads,
                      f"time_integration {{ method: {method} {settings} }} }}",
                      f"output {{ results_interval: {end} {output} }}", ""])


def saint_venant_kirchhoff(young_modulus, poisson_ratio, density=1.0):
    return (f"material {{ density: {density} saint_venant_kirchhoff {{ young_modulus: {young_modulus} "
            f"poisson_ratio: {poisson_ratio} }} }}")


def mooney_rivlin(a10, a01, bulk_modulus, density=1.0):
    return f"material {{ density: {density} mooney_rivlin {{ a10: {a10} a01: {a01} bulk_modulus: {bulk_modulus} }} }}"


def ramp(value):
    return f"value {{ row {{ time: 0 value: 0 }} row {{ time: 1 value: {value} }} }}"


def constant(value):
    return f"value {{ row {{ time: 0 value: {value} }} }}"


def solve(program, text, folder, threads=1, verb="run", arguments=(), repeats=measure.REPEATS):
    """Runs a scene. A run that failed has a code other than 0, and says why in its output."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.txtpb").write_text(text)
    command = [program, verb, "scene.txtpb", "--out", "run", "--threads", str(threads), *arguments]
    if verb == "run":
        command.append("--quiet")
    timed = measure.fastest(lambda: measure.run(command, folder), repeats)
    solved = Solved(**vars(timed))
    solved.results = str(next((folder / "run" / "results").glob("*.h5"), ""))
    if timed.code != 0:
        return solved
    if verb == "modes":
        solved.frequencies = list(read_columns(folder / "run" / "modes.csv")["frequency"])
    else:
        solved.summary = json.loads((folder / "run" / "summary.json").read_text())
        solved.history = read_columns(folder / "run" / "history.csv")
    return solved


def read_columns(path):
    """Columns of a table, named without their units."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return {name.split(" [")[0]: numpy.array([float(row[c]) for row in rows[1:]]) for c, name in enumerate(rows[0])}
