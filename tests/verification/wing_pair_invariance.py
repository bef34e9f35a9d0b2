#!/usr/bin/python3
"""The scene of a flapping wing pair, on coarse cells: the same on 1, 2, 4 and 8 ranks; its kinematics are those of its table."""

import csv
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy

COUPLET = os.environ["COUPLET"]
FOLDER = Path(__file__).resolve().parents[2] / "deploy" / "scenes" / "flapping-wing-pair"
# Sums over ranks round differently; the pressure is solved for to the last digits but two. Forces differ by 1e-12 at most.
ROUND_OFF = 1e-10
N_STEPS = 6
COARSE = [f"flow.navier_stokes.grid.{axis}.stretched.region[0].width=0.004" for axis in "xyz"]
TIGHT = ["flow.navier_stokes.pressure.relative_tolerance=1e-8", "flow.navier_stokes.pressure.divergence_tolerance=1e-12"]


def history_of(ranks, folder):
    command = [COUPLET, "run", str(FOLDER / "scene.txtpb"), "--out", str(folder), "--quiet", "--no-report", "--steps", str(N_STEPS),
               "--flow-ranks", str(ranks)]
    for setting in COARSE + TIGHT:
        command += ["--set", setting]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(done.stdout + done.stderr)
    with open(folder / "history.csv") as file:
        rows = list(csv.reader(file))
    names = [name.split(" [")[0] for name in rows[0]]
    return {name: numpy.array([float(row[i]) for row in rows[1:]]) for i, name in enumerate(names)}


class WingPair(unittest.TestCase):
    def test_ranks_agree(self):
        with tempfile.TemporaryDirectory() as scratch:
            histories = {ranks: history_of(ranks, Path(scratch) / str(ranks)) for ranks in (1, 2, 4, 8)}
        alone = histories[1]
        self.assertEqual(len(alone["time"]), N_STEPS)
        for ranks in (2, 4, 8):
            for body in ("wing", "trunk"):
                scale = max(numpy.abs(alone[f"body.{body}.force_{axis}"]).max() for axis in "xyz")
                self.assertGreater(scale, 1e-3)  # a bird of 0.028 N
                for axis in "xyz":
                    name = f"body.{body}.force_{axis}"
                    self.assertLess(numpy.abs(histories[ranks][name] - alone[name]).max(), ROUND_OFF * scale, f"{name} on {ranks} ranks")

    def test_kinematics_are_those_of_the_table(self):
        text = (FOLDER / "scene.txtpb").read_text()
        series = re.findall(r"fourier \{ frequency: 45\.5  mean: (\S+)((?: +(?:cosine|sine): \S+)+) \}", text)
        self.assertEqual(len(series), 2)
        table = {}
        with open(FOLDER / "kinematics.csv") as file:
            for row in csv.DictReader(line for line in file if not line.startswith("#")):
                table[row["angle"], row["coefficient"], int(row["harmonic"])] = float(row["degrees"])
        position, feathering = ((float(mean), re.findall(r"(cosine|sine): ([-\d.]+)", rest)) for mean, rest in series)
        self.assertEqual(position[0], table["phi", "a0", 0] / 2)
        self.assertEqual([(kind, float(value)) for kind, value in position[1]], [("cosine", table["phi", "a", 1])])
        # Feathering: 0.4 times the amplitudes up to the seventh, to the digits of the scene; the others are below 0.2 degrees.
        for harmonic, (kind, value) in enumerate(feathering[1], start=1):
            self.assertEqual(kind, "sine")
            self.assertAlmostEqual(float(value), 0.4 * table.get(("alpha", "b", harmonic), 0), places=5)
        left_out = [abs(value) for (angle, _, harmonic), value in table.items() if angle == "alpha" and harmonic > 7]
        self.assertLess(max(left_out), 0.2)
        deviation = re.search(r"angle \{ constant: (\S+) \}", text)
        self.assertAlmostEqual(float(deviation.group(1)), table["theta", "a0", 0] / 2, places=6)


if __name__ == "__main__":
    unittest.main(verbosity=2)
