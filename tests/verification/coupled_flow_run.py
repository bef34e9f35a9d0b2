#!/usr/bin/python3
"""An elastic flag in a stream, by the programs as a user starts them: it converges in every step while its end stands in a plane
of the grid, the same on two ranks, over both transports and after a restart."""

import csv
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy

COUPLET = os.environ["COUPLET"]
SCENE = os.environ["SCENE"]
# The flag is 2 cells thick and no face lies along it; its end at x = 0.6 m lies in a face.
COARSE = ("flow.navier_stokes.grid.x.stretched.region[0].width=0.01", "flow.navier_stokes.grid.y.uniform.cells=42",
          "flow.navier_stokes.pressure.relative_tolerance=1e-8", "time.end=0.12", "output.checkpoints.every_steps=17",
          "coupling.convergence[0]={field: \"displacement\" relative: 1e-8}")
N_STEPS = 30
# At this density ratio (10) IQN-ILS needs 4 to 6 iterations once it has seen a few steps; those from rest, before it
# knows anything, twice that. Where the force is no function of the motion, iterations go on for ever.
MOST_ITERATIONS = 15
# Sums over ranks round differently; the last iteration's change, 1e-8 of the motion, may fall out differently then, and what is
# left of the pressure's residual, 1e-8.
ROUND_OFF = 1e-6


class FlagTest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="couplet flag ")
        self.folder = Path(self.temporary.name)
        self.addCleanup(self.temporary.cleanup)

    def run_flag(self, name, *options):
        out = self.folder / name
        settings = [word for setting in COARSE for word in ("--set", setting)]
        done = subprocess.run([COUPLET, "run", SCENE, "--out", str(out), "--quiet", "--no-report", *settings, *options],
                              capture_output=True, text=True, timeout=150)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(out / "history.csv", newline="") as file:
            rows = list(csv.reader(file))
        return {title.partition(" [")[0]: numpy.array([float(row[i]) for row in rows[1:]]) for i, title in enumerate(rows[0])}

    def test_every_step_converges_and_all_ways_to_run_it_agree(self):
        one = self.run_flag("one", "--flow-ranks", "1")
        self.assertEqual(len(one["time"]), N_STEPS)  # none was cut
        self.assertLessEqual(one["iterations"].max(), MOST_ITERATIONS)
        others = {"two ranks": ("--flow-ranks", "2"), "two ranks, MPI": ("--flow-ranks", "2", "--transport", "mpi")}
        for name, options in others.items():
            with self.subTest(name):
                other = self.run_flag(name, *options)
                self.assertEqual(len(other["time"]), N_STEPS)
                for column in ("A.x", "A.y", "body.flag.force_x", "body.flag.force_y", "body.cylinder.force_x"):
                    along = column[:-1] + "x"  # across the stream there is next to nothing yet
                    self.assertLessEqual(numpy.abs(other[column] - one[column]).max(), ROUND_OFF * numpy.abs(one[along]).max(),
                                         column)
        self.run_flag("parts", "--flow-ranks", "1", "--steps", "17")
        self.run_flag("parts", "--flow-ranks", "1", "--resume", str(self.folder / "parts"))
        self.assertEqual((self.folder / "parts" / "history.csv").read_text(), (self.folder / "one" / "history.csv").read_text())

    def test_flow_steps_within_a_coupling_step_follow_the_motion(self):
        """Four steps of the flow in one of the solid: nearer to steps a quarter as long than one is. Where the last of the four feels
        another acceleration than the first, the force of the added mass is several times too large and no step converges."""
        until = ("--set", "time.end=0.08")
        one = self.run_flag("one step", "--flow-ranks", "1", *until)
        four = self.run_flag("four steps", "--flow-ranks", "1", *until, "--set", "flow.navier_stokes.largest_step=0.001")
        short = self.run_flag("short steps", "--flow-ranks", "1", *until, "--set", "time.step=0.001")
        self.assertEqual(len(four["time"]), len(one["time"]))  # none was cut
        self.assertEqual(set(four["flow.substeps"]), {4})
        for column in ("body.flag.force_x", "body.cylinder.force_x"):
            def error(run):
                return numpy.abs(run[column] - numpy.interp(run["time"], short["time"], short[column])).max()
            self.assertLess(error(four), error(one), column)


if __name__ == "__main__":
    sys.exit(unittest.main(verbosity=2))
