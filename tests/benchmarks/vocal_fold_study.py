#!/usr/bin/python3
"""Speed against error on the vocal fold: 4 meshes and 3 steps, equilibrium and frequency beside cost (about 15 minutes)."""

import argparse
import subprocess
import sys
from pathlib import Path

FOLD = "solid.body[0].vocal_fold"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--about", action="store_true", help="one line about this benchmark")
    parser.add_argument("--json", help="write the rows to this file")
    parser.add_argument("--out", default="runs/vocal-fold-study", help="folder of the runs; finished ones are used again")
    options = parser.parse_args()
    if options.about:
        print(__doc__.splitlines()[0])
        return 0
    couplet = str(Path(__file__).resolve().parent / "couplet")
    scene = "@CMAKE_SOURCE_DIR@/deploy/scenes/vocal-fold-hybrid/scene.txtpb"
    # The fold settles until 0.2 s (equilibrium), then vibrates freely for 0.3 s (frequency).
    settings = ["time.end=0.5", "solid.settling.until=0.2", "solid.kick[0].time=0.2", "output.results_interval=1e3",
                "solid.body[0].stiffness_damping=0",  # as the dissertation's tissue
                "output.quantity=[]",
                "output.quantity[0]={name: 'equilibrium_opening' kind: FINAL column: 'exit.y' factor: -1 window: 0.01 until: 0.2}",
                "output.quantity[1]={name: 'equilibrium_flow_rate' kind: FINAL column: 'flow.rate' window: 0.01 until: 0.2}",
                "output.quantity[2]={name: 'frequency' kind: FREQUENCY column: 'exit.y' window: 0.28}"]
    meshes = f"{FOLD}.elements_x,{FOLD}.elements_y,{FOLD}.elements_z=3:4:6,4:6:8,6:9:12,8:12:16"
    command = [couplet, "study", scene, "--vary", meshes, "--vary", "time.step=4e-5,2e-5,1e-5", "--out", options.out]
    for quantity in ("equilibrium_opening", "equilibrium_flow_rate", "frequency"):
        command += ["--quantity", quantity]
    for setting in settings:
        command += ["--set", setting]
    if options.json:
        command += ["--json", options.json]
    return subprocess.run(command).returncode


if __name__ == "__main__":
    sys.exit(main())
