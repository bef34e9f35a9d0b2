"""Programs of this folder on several ranks, for the scripts that start them."""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

# Yielding and unbound: on a machine with fewer cores than ranks they must not wait on each other's core.
MPI = ["mpirun", "--oversubscribe", "--bind-to", "none"]
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}


def measure(program, ranks, arguments):
    """What a program beside this file prints in its last line, an object of JSON; ends the script where the program fails."""
    path = Path(__file__).resolve().parent / program
    done = subprocess.run(MPI + ["-n", str(ranks), str(path)] + arguments, capture_output=True, text=True, env={**os.environ, **ENVIRONMENT})
    if done.returncode != 0:
        sys.exit(f"the measurement ended with exit code {done.returncode}: {(done.stderr.strip().splitlines() or [''])[0]}")
    return json.loads(done.stdout.splitlines()[-1])


def parser_for(description):
    """Options that every benchmark takes."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--about", action="store_true", help="one line about this benchmark")
    parser.add_argument("--json", help="write the rows to this file")
    return parser


def write_rows(path, rows):
    """Where a file is asked for."""
    if path:
        Path(path).write_text(json.dumps(rows, indent=2) + "\n")
