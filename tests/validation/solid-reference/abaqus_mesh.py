"""Mesh files of 20-node hexahedra (.inp) for shapes that the scene language has no mesh for."""

import numpy

# Natural coordinates of the nodes, in the order of C3D20: corners below, above, then midside nodes below, above, upright.
NODES = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1),
         (0, -1, -1), (1, 0, -1), (0, 1, -1), (-1, 0, -1), (0, -1, 1), (1, 0, 1), (0, 1, 1), (-1, 0, 1),
         (-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
# Side labels of hexahedra in .inp files, by axis and end.
SIDE = {(0, 0): "S6", (0, 1): "S4", (1, 0): "S3", (1, 1): "S5", (2, 0): "S1", (2, 1): "S2"}


def block(n, place):
    """A block of n[0] x n[1] x n[2] elements: nodes {(i, j, k): position} on the grid of half elements (0 .. 2 n, at most one
    odd index), elements {(i, j, k): its nodes' indices}. `place` maps three fractions in 0 .. 1 to a position."""
    elements = {}
    nodes = {}
    for element in numpy.ndindex(*n):
        keys = [tuple(2 * e + 1 + o for e, o in zip(element, offset)) for offset in NODES]
        elements[element] = keys
        for key in keys:
            if key not in nodes:
                nodes[key] = tuple(float(x) for x in place(*(index / (2 * count) for index, count in zip(key, n))))
    return nodes, elements


def write(path, nodes, elements, surfaces=None, node_sets=None, name="body"):
    """`surfaces`: {name: [(element, axis, end)]}; `node_sets`: {name: [node]}, by the indices of `block`."""
    number = {key: i + 1 for i, key in enumerate(nodes)}
    element_number = {key: i + 1 for i, key in enumerate(elements)}
    lines = ["*NODE"] + [f"{number[key]}, {x!r}, {y!r}, {z!r}" for key, (x, y, z) in nodes.items()]
    lines.append(f"*ELEMENT, TYPE=C3D20, ELSET={name}")
    for key, corners in elements.items():
        numbers = [str(number[node]) for node in corners]
        lines += [f"{element_number[key]}, " + ", ".join(numbers[:10]) + ",", ", ".join(numbers[10:])]
    for surface, sides in (surfaces or {}).items():
        lines.append(f"*SURFACE, NAME={surface}, TYPE=ELEMENT")
        lines += [f"{element_number[element]}, {SIDE[axis, end]}" for element, axis, end in sides]
    for node_set, members in (node_sets or {}).items():
        lines.append(f"*NSET, NSET={node_set}")
        lines += [f"{number[node]}," for node in members]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n")


def side(n, axis, end):
    """The elements' sides at one end of a block along an axis, for `surfaces`."""
    at = n[axis] - 1 if end else 0
    return [(element, axis, end) for element in numpy.ndindex(*n) if element[axis] == at]
