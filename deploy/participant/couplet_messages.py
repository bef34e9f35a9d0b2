"""The messages of the protocol as Python classes: `from couplet_messages import exchange_pb2`.

protoc makes them from proto/couplet/v1 when they are first needed and keeps them in the user's cache folder, one folder for
each state of the schema, so that neither a build nor a writable checkout is needed."""

import atexit
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


def give_up(sentence):
    print(f"couplet: {sentence}", file=sys.stderr)
    sys.exit(5)


def generate(folder):
    """Makes the classes and returns their folder: `folder`, or one that goes with this program where that cannot be written."""
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        fresh = tempfile.mkdtemp(prefix="messages-", dir=folder.parent)
    except OSError:
        fresh = tempfile.mkdtemp(prefix="couplet-messages-")
    atexit.register(shutil.rmtree, fresh, ignore_errors=True)
    try:
        subprocess.run(["protoc", "-I", str(SCHEMA), "--python_out", fresh, *map(str, FILES)], check=True)
    except FileNotFoundError:
        give_up("protoc is not there, which makes the classes of the messages; apt-get install protobuf-compiler")
    except subprocess.CalledProcessError:
        give_up(f"protoc cannot make the classes of {SCHEMA}/couplet/v1, as it says above; take a complete checkout")
    try:
        os.rename(fresh, folder)
    except OSError:  # another program was quicker, or it lies elsewhere
        return folder if folder.is_dir() else fresh
    return folder


if not FILES:
    give_up(f"{SCHEMA}/couplet/v1 holds no schema; take this module from a complete checkout")
kept = cache_folder()
sys.path.insert(0, str(kept if kept.is_dir() else generate(kept)))
from couplet.v1 import exchange_pb2  # noqa: E402, F401
