#!/usr/bin/python3
"""A flow: columns of an incompressible liquid that stand on the surface of the solid and move with it.

Over each piece of the surface stands a column of height L, open at its far end, so the pressure on the surface is rho L a with a
the acceleration towards the liquid. A surface of mass m and stiffness k for a unit of area then swings with
w^2 = k / (m + rho L): the liquid is added mass, and with rho L above m a coupling without iterations blows up.

a is the second difference backward in time of the displacement: stable with any liquid, and it damps a little, by the ratio
w step / 4 at most, which leaves the frequency right to second order in the step."""

import numpy as np

from couplet_participant import Failure, Opened, Participant, serve

# Shape functions of a face, integrated over the reference square or triangle, over its area: uniform pressure as nodal forces.
SHARES = {3: [1 / 3] * 3, 4: [1 / 4] * 4, 6: [0] * 3 + [1 / 3] * 3, 8: [-1 / 12] * 4 + [1 / 3] * 4}


def corner_area(position, face):
    """Area vector of the polygon of the corners of a face [m^2], along its normal."""
    corners = position[face[: 4 if len(face) in (4, 8) else 3]]
    return 0.5 * np.sum(np.cross(corners, np.roll(corners, -1, axis=0)), axis=0)


class LiquidColumn(Participant):
    """Columns of liquid on a surface."""

    @staticmethod
    def add_options(parser):
        parser.add_argument("--height", type=float, default=0.1, help="of the columns [m]", metavar="X")
        parser.add_argument("--density", type=float, help="of the liquid [kg/m^3]; default: flow.fluid.density of the scene", metavar="X")

    def __init__(self, options):
        self.options = options

    def open(self, request):
        if request.surface is None or not request.surface.faces:
            raise Failure("SCENE", "there is no surface to stand on", "flow", "couple it with a solid that has faces")
        self.surface = request.surface
        density = self.options.density or request.scene.flow.fluid.density
        self.mass = density * self.options.height  # [kg/m^2]
        n_nodes = len(self.surface.node_position)
        self.time, self.state = 0.0, np.zeros((3, n_nodes, 3))  # displacement, velocity, force
        if request.resume_from:
            with open(request.resume_from, "rb") as file:
                self.time, self.state = np.load(file), np.load(file)
            if self.state.shape != (3, n_nodes, 3):
                raise Failure("FILE", f"holds {self.state.shape[1]} nodes, the surface has {n_nodes}", request.resume_from,
                              "resume with the solid that it was written with")
        return Opened(self.surface, ["displacement"], {"force": self.state[2]}, float(self.time))

    def solve_step(self, step, fields):
        displacement = fields["displacement"]
        velocity = (displacement - self.state[0]) / step.duration
        acceleration = (velocity - self.state[1]) / step.duration
        force = np.zeros_like(displacement)
        for face in self.surface.faces:
            area = corner_area(self.surface.node_position, face)
            normal = area / np.linalg.norm(area)
            share = np.array(SHARES[len(face)])
            # The column of a face moves as its area does on average.
            force[face] -= np.outer(share, area) * self.mass * float(share @ acceleration[face] @ normal)
        self.trial, self.trial_time = np.array([displacement, velocity, force]), step.start + step.duration
        return {"force": force}

    def accept_step(self, step):
        self.state, self.time = self.trial, self.trial_time

    def write_checkpoint(self, path):
        with open(path, "wb") as file:
            np.save(file, self.time)
            np.save(file, self.state)


if __name__ == "__main__":
    serve(LiquidColumn)
