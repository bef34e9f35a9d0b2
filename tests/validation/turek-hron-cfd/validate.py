#!/usr/bin/python3
"""Turek-Hron CFD1 to CFD3: a rigid flag behind a cylinder: drag, lift and shedding on finer and finer grids (about 1 core hour; --quick 1 minute)."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import flag_in_channel  # noqa: E402

if __name__ == "__main__":
    sys.exit(flag_in_channel.validate(__doc__, HERE, ["CFD1", "CFD2", "CFD3"]))
