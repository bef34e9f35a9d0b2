"""The messages of the protocol as Python classes: `from couplet_messages import exchange_pb2`.

protoc makes them from proto/couplet/v1 when they are first needed and keeps them in the user's cache folder, one folder for
each state of the schema, so that neither a build nor a writable checkout is needed."""

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import google.protobuf

SCHEMA = Path(__file__).resolve().parents[2] / "proto"
FILES = sorted(SCHEMA.glob("couplet/v1/*.proto"))


def cache_folder():
    """Where the classes of this schema lie, or will lie."""
    digest = hashlib.sha256(google.protobuf.__version__.encode())
    for file in FILES:
        digest.update(file.name.encode() + file.read_bytes())
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(home) / "couplet" / f"messages-{digest.hexdigest()[:16]}"


def generate(folder):
    """Makes the classes and returns their folder: `folder`, or a temporary one where that cannot be written."""
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        fresh = tempfile.mkdtemp(prefix="messages-", dir=folder.parent)
    except OSError:
        fresh = tempfile.mkdtemp(prefix="couplet-messages-")
    try:
        subprocess.run(["protoc", "-I", str(SCHEMA), "--python_out", fresh, *map(str, FILES)], check=True)
        if Path(fresh).parent != folder.parent:
            return fresh
        os.rename(fresh, folder)
    except FileNotFoundError:
        shutil.rmtree(fresh, ignore_errors=True)
        print("couplet: protoc is not there, which makes the classes of the messages; apt-get install protobuf-compiler", file=sys.stderr)
        sys.exit(5)
    except OSError:  # another program was quicker
        shutil.rmtree(fresh, ignore_errors=True)
    return folder


if not FILES:
    print(f"couplet: {SCHEMA}/couplet/v1 holds no schema; take this module from a complete checkout", file=sys.stderr)
    sys.exit(5)
kept = cache_folder()
sys.path.insert(0, str(kept if kept.is_dir() else generate(kept)))
from couplet.v1 import exchange_pb2  # noqa: E402, F401
