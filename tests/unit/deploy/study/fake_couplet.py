#!/usr/bin/python3
"""Stands in for couplet in the tests of studies: `run` takes no time and its results converge with known orders.

frequency = 100 (1 + 2 / (nx ny)) + 5000 dt: second order in the mesh size, first order in the step; exactly 100 in the limit.
"""

import json
import sys
from pathlib import Path

words = sys.argv[1:]
out = Path(words[words.index("--out") + 1])
settings = dict(word.split("=", 1) for before, word in zip(words, words[1:]) if before == "--set")
n_cells = int(settings.get("nx", 8)) * int(settings.get("ny", 8))
step = float(settings.get("time.step", 1e-3))
with open(out.parent / "runs.txt", "a") as log:
    log.write(out.name + "\n")
if "model" in settings and settings["model"] == "B2":
    print("coupler: diverged; choose another model", file=sys.stderr)
    sys.exit(3)
out.mkdir()
quantities = {"frequency": {"value": 100 * (1 + 2 / n_cells) + 5e3 * step, "unit": "Hz", "spread": 0.1}}
summary = {"status": "finished", "core_seconds": 1e-3 * n_cells / step, "wall_seconds": 1.0, "quantities": quantities}
(out / "summary.json").write_text(json.dumps(summary))
