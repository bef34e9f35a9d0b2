#!/usr/bin/python3
"""A program of the user's own in the place of a server gives what theory says: `couplet run --solid COMMAND`, `--flow COMMAND`."""

import csv
import importlib.util
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

COUPLET = os.environ["COUPLET"]
PARTICIPANTS = Path(__file__).resolve().parents[2] / "deploy" / "participant"
WALL = PARTICIPANTS / "wall_channel.txtpb"
MASS, STIFFNESS, LENGTH, GAP, DENSITY = 1.0, 1e4, 0.02, 2e-3, 20.0  # of the wall and the channel of that scene

BAR = """
title: "a bar with columns of liquid on its end"
time { end: 0.4  step: 4e-4 }
flow { fluid { density: 100  viscosity: 0 }
  glottis { model: B2  subglottal_pressure { row { time: 0 value: 0 } }  exit_line { position { x: 0.1 } }  midplane: 1 } }
solid {
  body {
    name: "bar"
    box { length { x: 0.1  y: 0.01  z: 0.01 }  elements_x: 10 }
    material { density: 1000  saint_venant_kirchhoff { young_modulus: 1e5  poisson_ratio: 0 } }
    fixed: "x_min"
    wetted: "x_max"
  }
  gravity { direction { x: 1 }  value { row { time: 0  value: 1e-3 } } }
  time_integration { method: GENERALIZED_ALPHA }
}
output { probe { name: "end"  at { position { x: 0.1 } } } }
"""


def fit_oscillation(time, value, guess):
    """Frequency [Hz], damping ratio and largest misfit of c + exp(-d t)(a cos w t + b sin w t), by Gauss-Newton."""
    w, d = 2 * np.pi * guess, 0.0
    for _ in range(100):
        cosine, sine = np.exp(-d * time) * np.cos(w * time), np.exp(-d * time) * np.sin(w * time)
        basis = np.column_stack([np.ones_like(time), cosine, sine])
        c = np.linalg.lstsq(basis, value, rcond=None)[0]
        misfit = value - basis @ c
        slopes = np.column_stack([basis, -time * (c[1] * cosine + c[2] * sine), time * (c[2] * cosine - c[1] * sine)])
        change = np.linalg.lstsq(slopes, misfit, rcond=None)[0][3:]
        d, w = d + change[0], w + change[1]
        if np.abs(change).max() < 1e-10 * w:
            break
    return w / (2 * np.pi), d / w, np.abs(misfit).max() / np.ptp(value)


class OwnProgramCase(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="couplet own program ")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def run_couplet(self, scene, *words, name="run"):
        """The folder of a run that must finish."""
        out = self.folder / name
        result = subprocess.run([COUPLET, "run", str(scene), "--out", str(out), "--no-report", *words], capture_output=True, text=True, timeout=300)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.printed = result.stdout
        return out

    @staticmethod
    def columns(run, *names):
        with open(run / "history.csv", newline="") as file:
            header, *rows = csv.reader(file)
        header = [column.split(" ")[0] for column in header]
        return np.array(rows, dtype=float)[:, [header.index(name) for name in names]].T


class FrequencyTest(OwnProgramCase):
    def test_a_wall_of_ours_in_our_channel_has_the_frequency_of_its_added_mass(self):
        """w = W sin(pi x / L) drives rho w_tt 2 / h = -p_xx: an added mass of 2 rho L^2 / (h pi^2) on a unit of area."""
        command = f"{PARTICIPANTS}/mass_spring_wall.py --rest 1e-6 --shape sine"
        run = self.run_couplet(WALL, "--solid", command)
        exact = np.sqrt(STIFFNESS / (MASS + 2 * DENSITY * LENGTH**2 / (GAP * np.pi**2))) / (2 * np.pi)
        frequency, _, misfit = fit_oscillation(*self.columns(run, "time", "middle.y"), exact)
        # Second order in the step (169 a period) and in the faces (10); without the added mass it would be 35 % higher.
        self.assertLess(abs(frequency / exact - 1), 3e-4)
        self.assertLess(misfit, 1e-3)
        self.assertEqual(json.loads((run / "summary.json").read_text())["own_programs"], {"solid": command})
        self.assertIn(f"solid is {command}", self.printed)
        self.assertIn(f'solid is the program "{command}"', (run / "log.txt").read_text())

    def test_both_may_be_programs_of_ones_own(self):
        """A flat wall under columns of liquid of ten times its mass."""
        run = self.run_couplet(WALL, "--solid", f"{PARTICIPANTS}/mass_spring_wall.py --rest 1e-5", "--flow",
                               f"{PARTICIPANTS}/liquid_column.py --height 0.5", "--set", "time.end=0.6", "--set", "time.step=1e-3")
        exact = np.sqrt(STIFFNESS / (MASS + 0.5 * DENSITY)) / (2 * np.pi)
        frequency, damping, misfit = fit_oscillation(*self.columns(run, "time", "middle.y"), exact)
        self.assertLess(abs(frequency / exact - 1), 2e-4)
        self.assertLess(misfit, 1e-3)
        self.assertAlmostEqual(damping, 2 * np.pi * exact * 1e-3 / 4 * 10 / 11, delta=3e-4)  # that of backward differences

    def test_our_solid_server_under_a_flow_of_ones_own_has_the_frequency_of_a_bar_with_a_mass_on_its_end(self):
        """x tan x = mass of the bar over that of the liquid, w = x c / L."""
        scene = self.folder / "bar.txtpb"
        scene.write_text(BAR)
        run = self.run_couplet(scene, "--flow", f"{PARTICIPANTS}/liquid_column.py --height 1")
        low, high = 0.0, np.pi / 2
        for _ in range(60):
            x = (low + high) / 2
            low, high = (x, high) if x * np.tan(x) < 1000 * 0.1 / (100 * 1) else (low, x)
        exact = low * np.sqrt(1e5 / 1000) / 0.1 / (2 * np.pi)
        time, end = self.columns(run, "time", "end.x")
        frequency, _, misfit = fit_oscillation(time, end, exact)
        self.assertLess(abs(frequency / exact - 1), 3e-4)
        self.assertLess(misfit, 0.04)  # the second mode


class ResumeTest(OwnProgramCase):
    def test_a_run_with_programs_of_ones_own_continues_with_the_same_numbers(self):
        words = ["--solid", f"{PARTICIPANTS}/mass_spring_wall.py --rest 1e-5", "--flow", f"{PARTICIPANTS}/liquid_column.py",
                 "--set", "output.checkpoints.every_steps=10"]
        whole = self.run_couplet(WALL, *words, "--steps", "20", name="whole")
        first = self.run_couplet(WALL, *words, "--steps", "10", name="first")
        resumed = self.run_couplet(WALL, *words, "--steps", "10", "--resume", str(first), name="resumed")
        for left, right in zip((whole / "history.csv").read_text().splitlines(), (resumed / "history.csv").read_text().splitlines(), strict=True):
            self.assertEqual(left, right)


class FenicsxTest(OwnProgramCase):
    @unittest.skipUnless(importlib.util.find_spec("dolfinx"), "SKIPPED: FEniCSx is not there: apt-get install python3-dolfinx")
    def test_a_solid_of_fenicsx_moves_as_ours_does(self):
        scene = PARTICIPANTS / "soft_block.txtpb"
        ours = self.run_couplet(scene, name="ours")
        other = self.run_couplet(scene, "--solid", f"{PARTICIPANTS}/fenicsx_solid.py", name="fenicsx")
        probes = [f"{place}.{axis}" for place in ("upstream", "middle", "downstream") for axis in "xy"]
        for name, ours_moved, other_moved in zip(probes, self.columns(ours, *probes), self.columns(other, *probes)):
            # The coupling stops at 1e-8, Newton's method at 1e-9.
            self.assertLess(np.abs(ours_moved - other_moved).max(), 1e-7 * np.abs(ours_moved).max(), name)
        self.assertGreater(np.abs(self.columns(ours, "upstream.y")).max(), 1e-3)  # of a block of 10 mm


if __name__ == "__main__":
    unittest.main(verbosity=2)
