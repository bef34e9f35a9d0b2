"""Reads fields of the flow over time from results/flow.h5, which shows the files of all states (flow-server/output/field_writer.hpp)."""

import h5py
import numpy


class FlowStates:
    """Regions of the grid, surfaces of bodies, and their states. The file is opened only while it is read."""

    def __init__(self, folder):
        self.path = folder / "flow.h5"
        with h5py.File(self.path, "r") as file:
            self.regions = list(file["grid"])
            self.bodies = list(file.get("body", {}))
            self.groups = sorted(file.get("state", {}))
            self.time = numpy.array([float(file[f"state/{name}/time"][0]) for name in self.groups])

    def __len__(self):
        return len(self.groups)

    def faces(self, region):
        """Faces along x, y and z [m]."""
        with h5py.File(self.path, "r") as file:
            return [file[f"grid/{region}/{axis}"][()] for axis in "xyz"]

    def largest_region(self):
        return max(self.regions, key=lambda region: numpy.prod([len(faces) for faces in self.faces(region)]))

    def field_names(self, region):
        with h5py.File(self.path, "r") as file:
            return list(file[f"state/{self.groups[-1]}/{region}"])

    def slab(self, state, region, name, direction, begin, end):
        """The cells begin <= index < end along a direction (0: x), all along the others: (n_x, n_y, n_z) or with components behind."""
        cut = [slice(None)] * 3
        cut[2 - direction] = slice(begin, end)
        with h5py.File(self.path, "r") as file:
            values = file[f"state/{self.groups[state]}/{region}/{name}"][tuple(cut)].astype(float)
        return numpy.moveaxis(values, (0, 1, 2), (2, 1, 0))

    def triangles(self, body):
        """Corners of the triangles of a body's surface: (n_triangles, 3)."""
        with h5py.File(self.path, "r") as file:
            return file[f"body/{body}/triangle"][()]

    def on_body(self, state, body, name):
        """A field at the corners of a body's surface: position [m], force [N] and so on."""
        with h5py.File(self.path, "r") as file:
            return file[f"state/{self.groups[state]}/body/{body}/{name}"][()].astype(float)


def holds_flow_fields(folder):
    """Whether the results of a run are those of a flow in two or three dimensions."""
    try:
        with h5py.File(folder / "flow.h5", "r") as file:
            return "grid" in file
    except OSError:
        return False
