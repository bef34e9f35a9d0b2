"""A Slurm of a few namespaces (namespaces.py), without systemd, thrown away afterwards."""

import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from namespaces import Hosts
from namespaces import why_not as why_no_namespaces

PROGRAMS = ["slurmctld", "slurmd", "sbatch", "squeue", "munged"]
STARTS_WITHIN = 60  # [s]


def why_not():
    missing = [program for program in PROGRAMS if not shutil.which(program, path=os.environ["PATH"] + ":/usr/sbin")]
    return f"not installed: {', '.join(missing)} (packages slurm-wlm, munge)" if missing else why_no_namespaces()


class Slurm:
    def __init__(self, n_nodes, n_cpus):
        self.hosts = Hosts(n_nodes)
        self.temporary = tempfile.TemporaryDirectory(prefix="couplet-slurm-")
        self.folder = Path(self.temporary.name)
        for name in ("state", "log", "run", "munge", *(f"spool/{h}" for h in self.hosts.names), *(f"tmp-{h}" for h in self.hosts.names)):
            (self.folder / name).mkdir(parents=True)
        self.folder.chmod(0o755)
        (self.folder / "munge").chmod(0o700)
        key = self.folder / "munge" / "key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        self.configuration = self.folder / "slurm.conf"
        self.configuration.write_text(self.text(n_cpus))
        self.environment = os.environ | {"SLURM_CONF": str(self.configuration), "PATH": os.environ["PATH"] + ":/usr/sbin",
                                         "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        try:
            self.start()
        except BaseException:
            self.close()
            raise

    def text(self, n_cpus):
        folder, first = self.folder, self.hosts.names[0]
        nodes = "".join(f"NodeName={h} NodeAddr={self.hosts.address(h)} CPUs={n_cpus} RealMemory=2000\n" for h in self.hosts.names)
        # TmpFS of its own for each node: PMIx would use one folder for all otherwise.
        return f"""ClusterName=couplet
SlurmctldHost={first}({self.hosts.address(first)})
SlurmUser=root
SlurmdUser=root
AuthInfo=socket={folder}/run/munge.socket
TmpFS={folder}/tmp-%n
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool/%n
SlurmctldPidFile={folder}/run/slurmctld.pid
SlurmdPidFile={folder}/run/slurmd-%n.pid
SlurmctldLogFile={folder}/log/slurmctld.log
SlurmdLogFile={folder}/log/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
MpiDefault=pmix
ReturnToService=2
SchedulerParameters=bf_interval=1,sched_interval=1,batch_sched_delay=0
KillWait=5
PropagateResourceLimits=NONE
{nodes}PartitionName=main Nodes={",".join(self.hosts.names)} Default=YES MaxTime=60 State=UP
"""

    def on(self, host, *command, **options):
        """Not by `ip netns exec`: it hides /sys/fs/cgroup, without which slurmd does not start."""
        enter = f'hostname {host}; mount --bind /etc/netns/{host}/hosts /etc/hosts; exec "$@"'
        return subprocess.run(["nsenter", f"--net=/run/netns/{host}", "unshare", "--uts", "--mount", "bash", "-c", enter, "_", *map(str, command)],
                              env=self.environment, **options)

    def start(self):
        run, first = self.folder / "run", self.hosts.names[0]
        subprocess.run(["munged", "--force", f"--key-file={self.folder}/munge/key", f"--socket={run}/munge.socket", f"--pid-file={run}/munged.pid",
                        f"--log-file={self.folder}/log/munged.log", f"--seed-file={self.folder}/munge/seed"], env=self.environment, check=True)
        self.on(first, "slurmctld", "-f", self.configuration, check=True)
        for host in self.hosts.names:
            self.on(host, "slurmd", "-f", self.configuration, "-N", host, check=True)
        deadline = time.monotonic() + STARTS_WITHIN
        while self.say("sinfo", "-h", "-t", "idle", "-o", "%D") != str(len(self.hosts.names)):
            if time.monotonic() > deadline:
                raise TimeoutError("the nodes are not idle:\n" + (self.folder / "log" / "slurmctld.log").read_text()[-2000:])
            time.sleep(0.1)

    def say(self, *command):
        return self.on(self.hosts.names[0], *command, capture_output=True, text=True).stdout.strip()

    def is_over(self, job):
        return self.say("squeue", "-h", "-j", job, "-o", "%T") in ("", "COMPLETED", "FAILED", "TIMEOUT", "CANCELLED")

    def close(self):
        for file in [*self.folder.glob("run/slurmd-*.pid"), self.folder / "run" / "slurmctld.pid", self.folder / "run" / "munged.pid"]:
            if file.exists() and file.read_text().strip():
                subprocess.run(["kill", file.read_text().strip()], check=False, capture_output=True)
        time.sleep(1)
        self.hosts.close()
        self.temporary.cleanup()
