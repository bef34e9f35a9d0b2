"""A mesh of 20-node hexahedra as solid-server wrote it: nodes and faces by where they are."""

import h5py
import numpy

# Corners, then midside nodes, of the faces in CalculiX's order 1 to 6 (the node orders of both programs are the same).
FACES = numpy.array([[0, 1, 2, 3, 8, 9, 10, 11], [4, 7, 6, 5, 15, 14, 13, 12], [0, 4, 5, 1, 16, 12, 17, 8],
                     [1, 5, 6, 2, 17, 13, 18, 9], [2, 6, 7, 3, 18, 14, 19, 10], [3, 7, 4, 0, 19, 15, 16, 11]])


class Mesh:
    def __init__(self, position, cell):
        self.position = position  # (n_nodes, 3) [m]
        self.cell = cell  # (n_elements, 20)

    def nearest(self, point):
        return int(numpy.argmin(numpy.linalg.norm(self.position - numpy.asarray(point), axis=1)))

    def nodes_where(self, is_there):
        """Nodes (n) of which is_there(x, y, z) is true."""
        return numpy.flatnonzero(is_there(*self.position.T))

    def faces_of(self, nodes):
        """(element, face) of all faces whose eight nodes are among these."""
        among = numpy.zeros(len(self.position), bool)
        among[nodes] = True
        return numpy.argwhere(among[self.cell[:, FACES]].all(axis=2))

    def force_weights(self, faces):
        """Integral of the shape functions over faces [m^2], (n_nodes): nodal forces of a traction, 3 x 3 points."""
        weights = numpy.zeros(len(self.position))
        point, weight = numpy.polynomial.legendre.leggauss(3)
        for element, face in faces:
            nodes = self.cell[element, FACES[face]]
            for xi, w_xi in zip(point, weight):
                for eta, w_eta in zip(point, weight):
                    shape, gradient = serendipity(xi, eta)
                    tangents = gradient @ self.position[nodes]
                    weights[nodes] += shape * numpy.linalg.norm(numpy.cross(*tangents)) * w_xi * w_eta
        return weights


def serendipity(xi, eta):
    """Shape functions (8) and natural gradient (2, 8) of the 8-node face [Zienkiewicz, Taylor, Zhu 2005]."""
    shape, gradient = numpy.empty(8), numpy.empty((2, 8))
    for a, (x, y) in enumerate([(-1, -1), (1, -1), (1, 1), (-1, 1)]):
        shape[a] = (1 + x * xi) * (1 + y * eta) * (x * xi + y * eta - 1) / 4
        gradient[:, a] = (x * (1 + y * eta) * (2 * x * xi + y * eta) / 4, y * (1 + x * xi) * (2 * y * eta + x * xi) / 4)
    for a, y in ((4, -1), (6, 1)):
        shape[a] = (1 - xi**2) * (1 + y * eta) / 2
        gradient[:, a] = (-xi * (1 + y * eta), y * (1 - xi**2) / 2)
    for a, x in ((5, 1), (7, -1)):
        shape[a] = (1 + x * xi) * (1 - eta**2) / 2
        gradient[:, a] = (x * (1 - eta**2) / 2, -eta * (1 + x * xi))
    return shape, gradient


def read(path):
    """The mesh of a results file."""
    with h5py.File(path, "r") as file:
        return Mesh(file["mesh/position"][:], file["mesh/cell"][:].astype(int))


def last_displacement(path):
    """Displacement (n_nodes, 3) [m] of the last state in a results file."""
    with h5py.File(path, "r") as file:
        return file[f"state/{int(file['n_states'][0]) - 1}/displacement"][:]
