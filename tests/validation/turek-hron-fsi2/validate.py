#!/usr/bin/python3
"""Turek-Hron FSI2: a heavy elastic flag swings widely: tip, drag and lift on finer and finer grids (estimated: 20 core minutes; no --quick)."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import flag_in_channel  # noqa: E402

if __name__ == "__main__":
    sys.exit(flag_in_channel.validate(__doc__, HERE, ["FSI2"]))
