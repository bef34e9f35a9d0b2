"""Runs every combination once; a run that is finished in its folder is not run again."""

import hashlib
import json
import re
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor

NUMERICAL_FAILURE = 3  # would fail again in the same way


class StudyRun:
    """One combination and what came out of it."""

    def __init__(self, combination, folder):
        self.combination, self.folder = combination, folder
        self.exit_code, self.values, self.units, self.spreads = None, {}, {}, {}
        self.cost = self.wall_seconds = None
        self.status = "not run"

    def read(self):
        """What the folder holds; True when the run need not be done again."""
        code = self.folder / "exit_code.txt"
        if not code.exists():
            return False
        self.exit_code = int(code.read_text())
        summary = json.loads((self.folder / "summary.json").read_text()) if (self.folder / "summary.json").exists() else {}
        self.status = summary.get("status", "failed")
        self.cost, self.wall_seconds = summary.get("core_seconds"), summary.get("wall_seconds")
        if self.exit_code == 0:
            for name, entry in summary.get("quantities", {}).items():
                if entry.get("value") is not None:
                    self.values[name], self.units[name] = entry["value"], entry.get("unit", "1")
                    self.spreads[name] = entry.get("spread")
        return self.exit_code in (0, NUMERICAL_FAILURE)


class Runner:
    def __init__(self, couplet, scene, settings, extra, say):
        self.couplet, self.scene, self.settings, self.extra, self.say = couplet, scene, settings, extra, say
        self.scene_hash = hashlib.sha256(scene.read_bytes()).hexdigest()

    def run_all(self, runs, n_jobs):
        """Cheap ones first, as far as the settings tell: in the order given."""
        with ThreadPoolExecutor(n_jobs) as pool:
            list(pool.map(self.run_one, runs))

    def run_one(self, run):
        command = [self.couplet, "run", str(self.scene), "--out", str(run.folder), "--quiet", "--no-report", *self.extra]
        for setting in self.settings + run.combination.settings:
            command += ["--set", setting]
        stamp, wanted = run.folder / "command.txt", "\n".join(command[2:] + ["scene " + self.scene_hash, ""])
        if stamp.exists() and stamp.read_text() == wanted and run.read():
            self.say(f"  {run.combination.label}: {run.status} before")
            return
        if stamp.exists():  # ours, and of another or an unfinished study
            shutil.rmtree(run.folder)
        done = subprocess.run(command, capture_output=True, text=True)
        run.folder.mkdir(parents=True, exist_ok=True)
        stamp.write_text(wanted)
        (run.folder / "exit_code.txt").write_text(str(done.returncode))
        run.read()
        told = done.stderr.strip().splitlines()
        cost = f", {run.cost:.3g} core seconds" if run.cost is not None else ""
        self.say(f"  {run.combination.label}: {run.status}{cost}" + (f": {told[-1]}" if done.returncode and told else ""))


def folder_name(combination):
    """A name that a file system takes, and that tells the settings."""
    return re.sub(r"[^A-Za-z0-9_.,=+-]+", "_", combination.label.replace(", ", "+"))[:150]
