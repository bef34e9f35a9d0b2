"""Reads fields over time from results/NAME.h5 and its further blocks (proto/store/result_layout.hpp)."""

import h5py
import numpy


class ResultStates:
    """`name` of the result; `time` of every state [s]; `field` of one of them. Files are opened only while they are read."""

    def __init__(self, folder, name):
        self.name, self.places, self.time = name, [], []
        blocks = sorted(folder.glob(f"{name}.[0-9][0-9][0-9][0-9]*.h5"))
        with h5py.File(folder / f"{name}.h5", "r") as file:
            self.position = file["mesh/position"][()]
            self.cell = file["mesh/cell"][()].ravel()
            self.shape = _text(file["mesh/shape"])
            self.field_names = _text(file["field_names"]).split(",")
        for path in [folder / f"{name}.h5"] + blocks:
            with h5py.File(path, "r") as file:
                n_states = int(file["n_states"][()].ravel()[0])
                times = file["time"][()].ravel()[:n_states]
            self.places += [(path, slot) for slot in range(n_states)]
            self.time += list(times)
        self.time = numpy.array(self.time)

    def __len__(self):
        return len(self.places)

    def field(self, state, name):
        path, slot = self.places[state]
        with h5py.File(path, "r") as file:
            return file[f"state/{slot}/{name}"][()].astype(float)

    def nearest(self, time):
        """Index of the state nearest to a time."""
        return int(numpy.abs(self.time - time).argmin())


def _text(dataset):
    value = dataset[()]
    value = value.ravel()[0] if isinstance(value, numpy.ndarray) else value
    return value.decode() if isinstance(value, bytes) else str(value)
