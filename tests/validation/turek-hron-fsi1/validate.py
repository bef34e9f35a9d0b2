#!/usr/bin/python3
"""Turek-Hron FSI1: a stream bends an elastic flag: tip, drag and lift on finer and finer grids (3 core minutes without the finest, estimated half an hour with it; --quick half a minute)."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import flag_in_channel  # noqa: E402

if __name__ == "__main__":
    sys.exit(flag_in_channel.validate(__doc__, HERE, ["FSI1"]))
