"""Network namespaces of Linux as hosts: each has its own address and name; all share the disk, as hosts with a shared file system do."""

import os
import subprocess
import tempfile
from pathlib import Path

NETWORK = "10.77.213"  # .1, .2, ...
MARK = f"couplet{os.getpid()}"  # of names, so that two tests do not meet
SHELL = """#!/bin/bash
# SHELL HOST COMMAND...: a command on another host. Options as those of ssh are passed over, words joined as ssh joins them.
while [[ "$1" == -* ]]; do shift; done
host=$1; shift
exec ip netns exec "$host" unshare --uts bash -c "hostname $host; exec bash -c \\"\\$0\\"" "$*"
"""


def why_not():
    """Why there can be no namespaces here; empty when there can."""
    if os.geteuid() != 0:
        return "network namespaces need root"
    tried = subprocess.run(["ip", "netns", "add", f"{MARK}t"], capture_output=True, text=True)
    if tried.returncode != 0:
        return f"no network namespaces here: {tried.stderr.strip()}"
    entered = subprocess.run(["ip", "netns", "exec", f"{MARK}t", "unshare", "--uts", "true"], capture_output=True, text=True)
    subprocess.run(["ip", "netns", "del", f"{MARK}t"], check=False)
    return "" if entered.returncode == 0 else f"namespaces cannot be entered: {entered.stderr.strip()}"


def ip(*words):
    subprocess.run(["ip", *words], check=True)


class Hosts:
    """`n` hosts on a switch of their own; nothing reaches the network of the machine."""

    def __init__(self, n):
        self.names = [f"{MARK}h{i}" for i in range(1, n + 1)]
        self.switch = f"{MARK}s"
        self.folder = tempfile.TemporaryDirectory(prefix="couplet hosts ")
        self.shell = Path(tempfile.gettempdir()) / f"{MARK}-shell.sh"  # without blanks: it stands in a list of words
        self.shell.write_text(SHELL)
        self.shell.chmod(0o755)
        ip("netns", "add", self.switch)
        ip("-n", self.switch, "link", "add", "bridge", "type", "bridge")
        ip("-n", self.switch, "link", "set", "bridge", "up")
        table = "127.0.0.1 localhost\n" + "".join(f"{self.address(name)} {name}\n" for name in self.names)
        for i, name in enumerate(self.names):
            ip("netns", "add", name)
            ip("link", "add", "eth", "netns", name, "type", "veth", "peer", "name", f"port{i}", "netns", self.switch)
            ip("-n", self.switch, "link", "set", f"port{i}", "master", "bridge")
            ip("-n", self.switch, "link", "set", f"port{i}", "up")
            ip("-n", name, "link", "set", "lo", "up")
            ip("-n", name, "addr", "add", f"{self.address(name)}/24", "dev", "eth")
            ip("-n", name, "link", "set", "eth", "up")
            names = Path("/etc/netns") / name
            names.mkdir(parents=True)
            (names / "hosts").write_text(table)

    def address(self, name):
        return f"{NETWORK}.{self.names.index(name) + 1}"

    def file(self, flow, solid, coupler, spare=()):
        """A file of hosts; `flow` are pairs of a number of a host and its slots."""
        def host(i, more=""):
            name = self.names[i]
            return f'name: "{name}"  address: "{self.address(name)}"{more}'
        lines = [f'flow {{ {host(i, f"  slots: {slots}")} }}' for i, slots in flow]
        lines += [f"solid {{ {host(solid, '  threads: 1')} }}", f'coupler {{ name: "{self.names[coupler]}" }}']
        lines += [f"spare {{ {host(i)} }}" for i in spare]
        lines += [f'remote_shell: "{self.shell} {{host}} {{command}}"', f'network: "{NETWORK}.0/24"']
        path = Path(self.folder.name) / "hosts.txtpb"
        path.write_text("\n".join(lines) + "\n")
        return path

    def lose(self, i):
        """All that runs there ends, and nobody reaches it any more."""
        name = self.names[i]
        found = subprocess.run(["ip", "netns", "pids", name], capture_output=True, text=True, check=True)
        subprocess.run(["kill", "-9", *found.stdout.split()], check=False)
        ip("netns", "del", name)

    def close(self):
        for name in [*self.names, self.switch]:
            found = subprocess.run(["ip", "netns", "pids", name], capture_output=True, text=True)
            if found.returncode == 0:
                subprocess.run(["kill", "-9", *found.stdout.split()], check=False, capture_output=True)
                subprocess.run(["ip", "netns", "del", name], check=False)
            names = Path("/etc/netns") / name
            if names.exists():
                (names / "hosts").unlink()
                names.rmdir()
        self.shell.unlink(missing_ok=True)
        self.folder.cleanup()
