"""The bodies of a run over time: their outer surface, and moments that are worth a picture."""

import numpy

# Corners of the faces in the order of the normal out of the element, and the midside node of each edge, in the node orders of VTK.
HEXAHEDRON_FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
HEXAHEDRON_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
TETRAHEDRON_FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))
TETRAHEDRON_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
LARGEST_SAMPLE = 200  # states that are looked at to choose moments


def _with_midside_nodes(faces, edges):
    middle = {frozenset(edge): i for i, edge in enumerate(edges)}
    n_corners = 1 + max(max(edge) for edge in edges)
    return [face + tuple(n_corners + middle[frozenset((face[i - 1], face[i]))] for i in [*range(1, len(face)), 0]) for face in faces]


FACES = {"hexahedron20": _with_midside_nodes(HEXAHEDRON_FACES, HEXAHEDRON_EDGES), "hexahedron8": HEXAHEDRON_FACES,
         "tetrahedron10": _with_midside_nodes(TETRAHEDRON_FACES, TETRAHEDRON_EDGES)}
NODES_PER_CELL = {"hexahedron20": 20, "hexahedron8": 8, "tetrahedron10": 10}
SHAPE_OF_CODE = {48: "hexahedron20", 9: "hexahedron8", 38: "tetrahedron10"}  # numbers of XDMF, before each of mixed cells


def cells_of(states):
    """Cells of each shape, (n_cells, nodes of a cell): of mixed ones each stands after the number of its shape."""
    if states.shape != "mixed":
        return {states.shape: states.cell.reshape(-1, NODES_PER_CELL[states.shape])}
    found, at = {}, 0
    while at < len(states.cell):
        shape = SHAPE_OF_CODE[int(states.cell[at])]
        found.setdefault(shape, []).append(states.cell[at + 1:at + 1 + NODES_PER_CELL[shape]])
        at += 1 + NODES_PER_CELL[shape]
    return {shape: numpy.array(cells) for shape, cells in found.items()}


def outer_faces(states):
    """Faces that belong to one element only, one array (n_faces, nodes of a face) for each shape of elements: corners first, then the
    midside nodes of the edges 0-1, 1-2, ..."""
    groups, corners = [], []
    for shape, cell in cells_of(states).items():
        local = numpy.array(FACES[shape])
        face = cell[:, local].reshape(-1, local.shape[1])
        groups.append(face)
        key = numpy.sort(face[:, :3 if shape == "tetrahedron10" else 4], axis=1)
        corners.append(key if key.shape[1] == 4 else numpy.hstack([numpy.full((len(key), 1), -1), key]))
    _, place, count = numpy.unique(numpy.concatenate(corners), axis=0, return_index=True, return_counts=True)
    is_outer = numpy.zeros(sum(map(len, groups)), dtype=bool)
    is_outer[place[count == 1]] = True
    ends = numpy.cumsum([len(face) for face in groups])
    return [face[is_outer[end - len(face):end]] for face, end in zip(groups, ends)]


def face_grid(n_face_nodes, n_pieces):
    """How a face is cut into flat facets: (weights, facets, borders).

    weights (n_points, n_face_nodes): shape functions at the corners of the facets. facets (n_facets, 4): their points in the order of the
    normal, a triangle with its last one twice. borders (n_sides, 3): two points of each side on an edge of the face, and its facet.
    """
    return _triangle_grid(n_pieces) if n_face_nodes == 6 else _quadrilateral_grid(n_face_nodes, n_pieces)


def _quadrilateral_grid(n_face_nodes, n):
    xi, eta = (part.ravel() for part in numpy.meshgrid(*[numpy.linspace(-1, 1, n + 1)] * 2, indexing="ij"))
    corner = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    weights = [0.25 * (1 + a * xi) * (1 + b * eta) for a, b in corner]
    if n_face_nodes == 8:  # serendipity functions
        weights = [weight * (a * xi + b * eta - 1) for weight, (a, b) in zip(weights, corner)]
        weights += [0.5 * (1 - xi**2) * (1 - eta), 0.5 * (1 + xi) * (1 - eta**2), 0.5 * (1 - xi**2) * (1 + eta), 0.5 * (1 - xi) * (1 - eta**2)]
    point = numpy.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    facets = numpy.stack([point[:-1, :-1], point[1:, :-1], point[1:, 1:], point[:-1, 1:]], axis=-1).reshape(-1, 4)
    facet = numpy.arange(n * n).reshape(n, n)
    borders = [(edge[:-1], edge[1:], owner) for edge, owner in ((point[:, 0], facet[:, 0]), (point[-1], facet[-1]),
                                                                (point[:, -1], facet[:, -1]), (point[0], facet[0]))]
    return numpy.array(weights).T, facets, numpy.concatenate([numpy.stack(part, axis=-1) for part in borders])


def _triangle_grid(n):
    number = {(i, j): k for k, (i, j) in enumerate((i, j) for i in range(n + 1) for j in range(n + 1 - i))}
    second, third = numpy.array(list(number)).T / n
    first = 1 - second - third
    weights = [part * (2 * part - 1) for part in (first, second, third)] + [4 * first * second, 4 * second * third, 4 * third * first]
    facets, borders = [], []
    for i, j in number:
        if i + j < n:
            a, b, c = number[i, j], number[i + 1, j], number[i, j + 1]
            borders += [side + (len(facets),) for side, is_outer in (((a, b), j == 0), ((b, c), i + j == n - 1), ((c, a), i == 0)) if is_outer]
            facets.append((a, b, c, c))
        if i + j < n - 1:
            b, c = number[i + 1, j], number[i, j + 1]
            facets.append((b, number[i + 1, j + 1], c, c))
    return numpy.array(weights).T, numpy.array(facets), numpy.array(borders)


def progress(bodies):
    """How far the bodies are from rest in the direction in which they go farthest, over the sampled states: (states, share of it)."""
    sample = numpy.unique(numpy.linspace(0, len(bodies[0]) - 1, LARGEST_SAMPLE).astype(int))
    stride = max(1, sum(len(body.position) for body in bodies) // 5000)
    fields = numpy.array([numpy.concatenate([body.field(min(k, len(body) - 1), "displacement")[::stride].ravel() for body in bodies])
                          for k in sample])
    moved = numpy.nan_to_num(fields - fields[0], posinf=0, neginf=0)
    farthest = moved[(moved**2).sum(axis=1).argmax()]
    scale = (farthest**2).sum()
    return sample, moved @ farthest / scale if scale > 0 else numpy.zeros(len(sample))


def choose_moments(bodies, wanted_times=(), n_most=6):
    """Indices of states, in order: first and last, those nearest to wanted times, the extremes of the motion, then what differs most from these.
    States that are not finite are left out."""
    sample, share = progress(bodies)
    chosen = [0, len(bodies[0]) - 1] + [bodies[0].nearest(time) for time in wanted_times]
    if not wanted_times:
        chosen += [int(sample[share.argmax()]), int(sample[share.argmin()])]
    chosen = list(dict.fromkeys(chosen))[:n_most]
    span = max(numpy.ptp(bodies[0].time), 1e-300)
    place = numpy.stack([bodies[0].time[sample] / span, share / max(numpy.ptp(share), 1e-300)], axis=-1)
    while len(chosen) < min(n_most, len(sample)):
        taken = numpy.array([place[numpy.abs(sample - k).argmin()] for k in chosen])
        distance = numpy.linalg.norm(place[:, None] - taken[None], axis=-1).min(axis=1)
        distance[numpy.isin(sample, chosen)] = -1
        chosen.append(int(sample[distance.argmax()]))
    return sorted(k for k in chosen if all(numpy.isfinite(body.field(min(k, len(body) - 1), "displacement")).all() for body in bodies))
