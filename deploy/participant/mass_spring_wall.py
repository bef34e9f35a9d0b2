#!/usr/bin/python3
"""A solid: a flat wall that carries mass and stands on springs, so that each of its points swings by itself.

It is a rectangle in the plane y = Y with 8-node faces, and faces a flow above it. With m the mass and k the stiffness of a unit of
area, u'' + w^2 (u - d) = g(t), w^2 = k/m, where g comes from the force of the fluid by the mass matrix of the faces and d is where
the springs are at rest: the wall starts at u = 0 and is let go. The force is constant over a step, that of its end, and then the
motion is exact: in a vacuum u = d (1 - cos w t) to the last digit."""

import numpy as np

from couplet_participant import Failure, Opened, Participant, Surface, serve

# Corners and midsides of a face on the square from -1 to 1, against the clock seen from the fluid.
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]], dtype=float)


def shape_functions(a, b):
    """The eight of a face at a point (a, b) of that square."""
    s, t = CORNERS.T
    corner = (1 + s * a) * (1 + t * b) * (s * a + t * b - 1) / 4
    return np.where(s * t != 0, corner, np.where(s == 0, (1 - a * a) * (1 + t * b), (1 + s * a) * (1 - b * b)) / 2)


def face_mass(area):
    """Integral of N_i N_j over a face of that area [m^2], (8, 8)."""
    points, weights = np.polynomial.legendre.leggauss(3)
    return area / 4 * sum(w * v * np.outer(*[shape_functions(a, b)] * 2) for a, w in zip(points, weights) for b, v in zip(points, weights))


class Wall(Participant):
    """A wall of masses on springs."""

    @staticmethod
    def add_options(parser):
        number = {"type": float, "metavar": "X"}
        parser.add_argument("--mass", default=1, help="of a unit of area [kg/m^2]", **number)
        parser.add_argument("--stiffness", default=1e4, help="of a unit of area [N/m^3]", **number)
        parser.add_argument("--length", default=0.02, help="along x, from 0 [m]", **number)
        parser.add_argument("--width", default=0.01, help="along z, from 0 [m]", **number)
        parser.add_argument("--height", default=0, help="y of the wall at rest [m]", **number)
        parser.add_argument("--rest", default=0, help="where the springs are at rest: d along y in the middle [m]", **number)
        parser.add_argument("--shape", choices=("flat", "sine"), default="flat", help="of d along x")
        parser.add_argument("--faces", type=int, nargs=2, default=(10, 2), metavar=("NX", "NZ"), help="along x and along z")

    def __init__(self, options):
        for name in ("mass", "stiffness", "length", "width"):
            if not getattr(options, name) > 0:
                raise Failure("SCENE", f"{getattr(options, name)} is not above 0", f"--{name}", "give a positive number")
        if min(options.faces) < 1:
            raise Failure("SCENE", f"{options.faces} are not numbers of faces", "--faces", "give two whole numbers above 0")
        self.options = options

    def make_surface(self):
        """The rectangle, and the mass matrix of its nodes (n_nodes, n_nodes) [kg]."""
        o, (nx, nz) = self.options, self.options.faces
        index, faces = {}, []  # place on a grid of half faces: node
        for i in range(nx):
            for k in range(nz):
                # x, z and the normal y: corners run from x to z the other way round
                places = [(2 * i + 1 + int(a), 2 * k + 1 + int(b)) for b, a in CORNERS]
                faces.append([index.setdefault(place, len(index)) for place in places])
        places = np.array(list(index), dtype=float)
        position = np.column_stack([places[:, 0] * o.length / (2 * nx), np.full(len(places), o.height), places[:, 1] * o.width / (2 * nz)])
        mass = np.zeros((len(index), len(index)))
        for face in faces:
            mass[np.ix_(face, face)] += o.mass * face_mass(o.length / nx * o.width / nz)
        middle = int(np.argmin(np.hypot(position[:, 0] - o.length / 2, position[:, 2] - o.width / 2)))
        return Surface(position, faces, region=["wall"], marker={"middle": middle}), mass

    def open(self, request):
        surface, mass = self.make_surface()
        self.mass, self.inverse_mass = mass, np.linalg.inv(mass)
        n_nodes, o = len(mass), self.options
        if request.resume_from:
            with open(request.resume_from, "rb") as file:
                self.time, self.state = np.load(file), np.load(file)
            if self.state.shape != (2, n_nodes, 3):
                raise Failure("FILE", f"holds {self.state.shape[1]} nodes, the wall has {n_nodes}", request.resume_from, "give the same --faces")
        else:
            self.time, self.state = 0.0, np.zeros((2, n_nodes, 3))  # displacement, velocity
        self.rest = np.zeros((n_nodes, 3))
        self.rest[:, 1] = o.rest * (np.sin(np.pi * surface.node_position[:, 0] / o.length) if o.shape == "sine" else 1)
        return Opened(surface, ["force"], self.fields(self.state), float(self.time))

    @staticmethod
    def fields(state):
        return {"displacement": state[0], "velocity": state[1]}

    def solve_step(self, step, fields):
        u, v = self.state
        h, w = step.duration, np.sqrt(self.options.stiffness / self.options.mass)
        middle = self.rest + self.inverse_mass @ fields["force"] / w**2  # about which each point swings with this force
        c, s = np.cos(w * h), np.sin(w * h)
        self.trial = np.array([middle + (u - middle) * c + v / w * s, (middle - u) * w * s + v * c])
        self.trial_time = step.start + h
        return self.fields(self.trial)

    def accept_step(self, step):
        self.state, self.time = self.trial, self.trial_time
        stretch, velocity = self.state[0] - self.rest, self.state[1]
        stiffness = self.options.stiffness / self.options.mass * self.mass
        return {"solid.kinetic_energy": (0.5 * float(np.sum(velocity * (self.mass @ velocity))), "J"),
                "solid.elastic_energy": (0.5 * float(np.sum(stretch * (stiffness @ stretch))), "J")}

    def write_checkpoint(self, path):
        with open(path, "wb") as file:
            np.save(file, self.time)
            np.save(file, self.state)


if __name__ == "__main__":
    serve(Wall)
