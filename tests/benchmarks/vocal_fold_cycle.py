#!/usr/bin/python3
"""One cycle of the vocal fold at the dissertation's resolution: wall time, cost per element, share outside the element kernel."""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

CYCLE = 1 / 137  # [s] of the vibration at T = 1.75 mm
STEP = 4e-5  # [s]; the vibration is the same with 1e-5, 2e-5 and 4e-5 (bench vocal-fold-study)
FOLD = "solid.body[0].vocal_fold"


def measure(couplet, scene, elements, threads, cycles, out):
    """Runs the first cycles of the settling phase: the same work a cycle as later, without waiting for the vibration."""
    nx, ny, nz = elements
    folder = Path(out) / f"{nx}x{ny}x{nz}-{threads}"
    settings = [f"{FOLD}.elements_x={nx}", f"{FOLD}.elements_y={ny}", f"{FOLD}.elements_z={nz}", f"{FOLD}.half_length=false",
                "flow.glottis.half_length=false", "solid.body[0].symmetry=[]", "solid.body[0].fixed[2]=posterior",
                f"time.end={cycles * CYCLE:.6f}", f"time.step={STEP}",
                "solid.body[0].stiffness_damping=0",  # as the dissertation's tissue
                "output.quantity=[]", "output.results_start=0", "output.results_interval=1"]
    command = [couplet, "run", scene, "--out", str(folder), "--quiet", "--solid-threads", str(threads)]
    for setting in settings:
        command += ["--set", setting]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"the run ended with exit code {done.returncode}: {done.stderr.strip().splitlines()[-1]}")
    summary = json.loads((folder / "summary.json").read_text())
    solid = summary["programs"]["solid"]
    n_elements = nx * ny * nz
    substeps, kernel = solid["substeps"], solid["element_seconds"]
    return {
        "elements": n_elements, "threads": threads, "seconds_per_cycle": summary["wall_seconds"] / cycles,
        "substeps_per_cycle": substeps / cycles, "ns_per_element_substep": 1e9 * solid["seconds"] / substeps / n_elements,
        "share_outside_kernel": 1 - kernel / solid["seconds"], "solid_share": solid["seconds"] / summary["wall_seconds"],
        "peak_memory_bytes": solid["peak_memory_bytes"],
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--about", action="store_true", help="one line about this benchmark")
    parser.add_argument("--json", help="write the rows to this file")
    parser.add_argument("--cycles", type=float, default=1.0, help="length of each run in cycles")
    options = parser.parse_args()
    if options.about:
        print(__doc__.splitlines()[0])
        return
    couplet = str(Path(__file__).resolve().parent / "couplet")
    scene = "@CMAKE_SOURCE_DIR@/deploy/scenes/vocal-fold-hybrid/scene.txtpb"
    rows = []
    print(f"{'elements':>9} {'threads':>7} {'s a cycle':>10} {'substeps':>9} {'ns/el/substep':>13} {'outside kernel':>14} {'solid share':>11}")
    with tempfile.TemporaryDirectory() as out:
        for elements, threads in [((6, 9, 12), 1), ((8, 30, 75), 1), ((8, 30, 75), 2)]:
            row = measure(couplet, scene, elements, threads, options.cycles, out)
            rows.append(row)
            print(f"{row['elements']:9d} {threads:7d} {row['seconds_per_cycle']:10.3f} {row['substeps_per_cycle']:9.0f} "
                  f"{row['ns_per_element_substep']:13.1f} {row['share_outside_kernel']:14.1%} {row['solid_share']:11.1%}", flush=True)
    if options.json:
        Path(options.json).write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
