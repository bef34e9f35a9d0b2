"""What a run left in its folder, however far it came."""

import json
from pathlib import Path

import numpy

from flow_states import FlowStates, holds_flow_fields
from result_states import ResultStates
from scene_text import parse_scene_text
from solid_states import FACES


class Table:
    """Columns by name, with their units. A last line that was cut off by a crash is left out."""

    def __init__(self, path):
        self.units, self.values, self.names = {}, {}, []
        text = Path(path).read_text()
        lines = text.splitlines()
        if not lines:
            return
        if not text.endswith("\n"):
            lines.pop()
        header = lines[0].split(",")
        rows = [line for line in lines[1:] if line.count(",") == len(header) - 1]
        numbers = numpy.loadtxt(rows, delimiter=",", ndmin=2) if rows else numpy.empty((0, len(header)))
        for i, title in enumerate(header):
            name, _, unit = title.strip().partition(" [")
            self.names.append(name)
            self.units[name] = unit.rstrip("]")
            self.values[name] = numbers[:, i]

    def __contains__(self, name):
        return name in self.values

    def __getitem__(self, name):
        return self.values[name]

    def __len__(self):
        return len(self.values[self.names[0]]) if self.names else 0


class RunFolder:
    """The files of one run. What is missing or cannot be read is None, and `troubles` says why."""

    def __init__(self, path):
        self.path = Path(path)
        self.troubles = []
        self.summary = self._read("summary.json", lambda file: json.loads(file.read_text())) or {}
        self.history = self._read("history.csv", Table)
        self.iterations = self._read("iterations.csv", Table, is_needed=False)
        self.scene = self._read("resolved_scene.txtpb", lambda file: parse_scene_text(file.read_text())) or {}

    def results(self, shape):
        """Fields over time on cells of a shape: `hexahedron20` for a solid, `polyline` for a one-dimensional flow. None without them."""
        return next(self._all_results((shape,)), None)

    def bodies(self):
        """Displacements over time of all solid bodies. Shapes of free vibration, which stand under the name modes, are none."""
        return [states for states in self._all_results([*FACES, "mixed"]) if "displacement" in states.field_names and states.name != "modes"]

    def _all_results(self, shapes):
        for file in sorted((self.path / "results").glob("*.xmf")):
            if holds_flow_fields(file.parent) and (file.stem == "flow" or not file.with_suffix(".h5").exists()):
                continue  # a region of such a flow
            try:
                states = ResultStates(file.parent, file.stem)
            except (OSError, KeyError, ValueError) as error:
                trouble = f"results/{file.stem}.h5 cannot be read: {error}"
                if trouble not in self.troubles:
                    self.troubles.append(trouble)
                continue
            if states.shape in shapes and len(states):
                yield states

    def flow_fields(self):
        """Fields of a flow in two or three dimensions. None without them."""
        folder = self.path / "results"
        return FlowStates(folder) if holds_flow_fields(folder) else None

    def quantity(self, name):
        """Value of a quantity of the summary; None without it."""
        return self.summary.get("quantities", {}).get(name, {}).get("value")

    def _read(self, name, reader, is_needed=True):
        file = self.path / name
        if not file.exists():
            if is_needed:
                self.troubles.append(f"{name} is missing")
            return None
        try:
            return reader(file)
        except (OSError, ValueError, IndexError) as error:
            self.troubles.append(f"{name} cannot be read: {error}")
            return None
