"""CalculiX on the meshes of solid-server: input decks, runs, what it printed."""

import re
import shutil
from dataclasses import dataclass, field
from pathlib import Path

import numpy

import measure

PROGRAM = "ccx"
FULL, REDUCED = "C3D20", "C3D20R"  # 27 and 8 points
# A run that takes longer [s] is worth no further waiting.
LONGEST = 1800


def numbers(*values):
    """A data line; fields may have 20 characters at most."""
    return ",".join(f"{value:.12g}" for value in values)


def version():
    """"2.20", or nothing where CalculiX is not installed."""
    if not shutil.which(PROGRAM):
        return None
    printed = measure.run([PROGRAM, "-v"], Path("/tmp")).output
    found = re.search(r"Version (\S+)", printed)
    return found.group(1) if found else "of unknown version"


@dataclass
class Solved(measure.Timed):
    n_iterations: int = 0
    displacement: list = field(default_factory=list)  # (time, {node: (3)}) for each printed state
    frequencies: list = field(default_factory=list)  # [Hz]


class Deck:
    """The text of an input file: mesh, supports, material, then one step."""

    def __init__(self, mesh, element):
        self.mesh = mesh
        self.lines = ["*NODE,NSET=ALL"]
        self.lines += [f"{n}," + numbers(*at) for n, at in enumerate(mesh.position, 1)]
        self.lines.append(f"*ELEMENT,TYPE={element},ELSET=ALL")
        for e, nodes in enumerate(mesh.cell + 1, 1):
            self.lines += [f"{e}," + ",".join(map(str, nodes[:10])) + ",", ",".join(map(str, nodes[10:]))]

    def nodes(self, name, nodes):
        self.lines += [f"*NSET,NSET={name}"] + [f"{n + 1}," for n in nodes]
        return self

    def hold(self, nodes, first=1, last=3):
        """Components first to last (1 to 3) of these nodes do not move."""
        self.lines.append("*BOUNDARY")
        self.lines += [f"{n + 1},{first},{last}" for n in nodes]
        return self

    def saint_venant_kirchhoff(self, young_modulus, poisson_ratio, density=1.0):
        """*ELASTIC in a geometrically nonlinear step is this law."""
        return self._material(["*ELASTIC", numbers(young_modulus, poisson_ratio)], density)

    def mooney_rivlin(self, a10, a01, bulk_modulus, density=1.0):
        """Its last constant is 2/K."""
        return self._material(["*HYPERELASTIC,MOONEY-RIVLIN", numbers(a10, a01, 2 / bulk_modulus)], density)

    def _material(self, law, density):
        self.lines += ["*MATERIAL,NAME=TISSUE", *law, "*DENSITY", numbers(density),
                       "*SOLID SECTION,ELSET=ALL,MATERIAL=TISSUE"]
        return self

    def static(self, increment, tolerance=None):
        """Automatic increments, the first and largest one as given (load 0 to 1)."""
        if tolerance:
            self.lines += ["*CONTROLS,PARAMETERS=FIELD", numbers(tolerance, tolerance)]
        self.lines += ["*STEP,NLGEOM,INC=1000", "*STATIC", numbers(increment, 1, 1e-6, increment)]
        return self

    def dynamic(self, step, end, alpha=0.0):
        """Implicit with steps of equal length [Hilber, Hughes, Taylor]."""
        self.lines += ["*STEP,NLGEOM,INC=1000000", f"*DYNAMIC,DIRECT,ALPHA={alpha}", numbers(step, end)]
        return self

    def explicit_dynamic(self, step, end):
        self.lines += ["*STEP,NLGEOM,INC=1000000", "*DYNAMIC,DIRECT,EXPLICIT", numbers(step, end)]
        return self

    def frequencies(self, count):
        self.lines += ["*STEP", "*FREQUENCY", f"{count}"]
        return self

    def gravity(self, value, direction):
        self.lines += ["*DLOAD", "ALL,GRAV," + numbers(value, *direction)]
        return self

    def pressure(self, faces, value):
        self.lines.append("*DLOAD")
        self.lines += [f"{element + 1},P{face + 1}," + numbers(value) for element, face in faces]
        return self

    def traction(self, faces, component, value):
        """A force per area at rest along an axis (1 to 3), as nodal forces."""
        weights = value * self.mesh.force_weights(faces)
        self.lines.append("*CLOAD")
        self.lines += [f"{n + 1},{component}," + numbers(weights[n]) for n in numpy.flatnonzero(weights)]
        return self

    def print_displacement(self, name, only_last=True):
        self.lines += [f"*NODE PRINT,NSET={name},FREQUENCY={100000 if only_last else 1}", "U"]
        return self

    def text(self):
        return "\n".join(self.lines + ["*END STEP", ""])


def solve(deck, folder, threads=1, repeats=measure.REPEATS):
    """Runs a deck. A run that diverged has a code other than 0."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "deck.inp").write_text(deck.text())
    timed = measure.fastest(lambda: measure.run(["timeout", str(LONGEST), PROGRAM, "deck"], folder,
                                                {"OMP_NUM_THREADS": str(threads)}), repeats)
    solved = Solved(**vars(timed), n_iterations=len(re.findall(r"^ iteration ", timed.output, re.MULTILINE)))
    if timed.code == 0:
        read_table(folder / "deck.dat", solved)
    return solved


def read_table(path, solved):
    """Displacements and frequencies of a .dat file."""
    in_frequencies = False
    for line in path.read_text().splitlines():
        words = line.split()
        if line.strip().startswith("displacements"):
            solved.displacement.append((float(words[-1]), {}))
        elif "E I G E N V A L U E   O U T P U T" in line:
            in_frequencies = True
        elif "P A R T I C I P A T I O N" in line:
            in_frequencies = False
        elif in_frequencies and len(words) == 5 and words[0].isdigit():
            solved.frequencies.append(float(words[3]))
        elif solved.displacement and len(words) == 4 and words[0].isdigit():
            solved.displacement[-1][1][int(words[0]) - 1] = numpy.array([float(word) for word in words[1:]])
