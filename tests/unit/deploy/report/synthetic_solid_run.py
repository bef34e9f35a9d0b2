"""Folders of runs of a solid alone whose content is known: cells of every shape, a valve that opens and closes, a path of equilibria."""

import json

import numpy

from synthetic_run import hex20_box, write_result

CUBE_TETRAHEDRA = ((0, 1, 3, 7), (0, 1, 7, 5), (1, 2, 3, 7), (1, 2, 7, 6), (0, 5, 7, 4), (1, 6, 7, 5))
TETRAHEDRON_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))


def hex8_box(n_x, n_y, n_z, length):
    """Node positions and cells of a box of 8-node hexahedra in VTK's order."""
    position, cells = hex20_box(n_x, n_y, n_z, length)
    used, corner = numpy.unique(cells.reshape(-1, 20)[:, :8], return_inverse=True)
    return position[used], corner.ravel()


def tet10_box(n_x, n_y, n_z, length):
    """Node positions and cells of a box of hexahedra, each cut into six 10-node tetrahedra, in VTK's order."""
    position, cells = hex8_box(n_x, n_y, n_z, length)
    number = {tuple(point): i for i, point in enumerate(position)}
    found = []
    for cell in cells.reshape(-1, 8):
        for corners in CUBE_TETRAHEDRA:
            nodes = [int(cell[c]) for c in corners]
            middles = [tuple(0.5 * (position[nodes[a]] + position[nodes[b]])) for a, b in TETRAHEDRON_EDGES]
            found += nodes + [number.setdefault(middle, len(number)) for middle in middles]
    return numpy.array(list(number)), numpy.array(found)


BOXES = {"hexahedron20": hex20_box, "hexahedron8": hex8_box, "tetrahedron10": tet10_box}


CODES = {"hexahedron20": 48, "hexahedron8": 9, "tetrahedron10": 38}


def mixed_boxes():
    """A cube of each shape beside the other: node positions, and cells as the file of mixed ones holds them."""
    positions, cells = [], []
    for shape, box in BOXES.items():
        position, cell = box(1, 1, 1, (1.0, 1.0, 1.0))
        n_cells = 6 if shape == "tetrahedron10" else 1
        cell = cell.reshape(n_cells, -1) + sum(map(len, positions))
        cells.append(numpy.hstack([numpy.full((n_cells, 1), CODES[shape]), cell]).ravel())
        positions.append(position + [2.0 * len(positions), 0, 0])
    return numpy.concatenate(positions), numpy.concatenate(cells)


def write_table(path, columns):
    numpy.savetxt(path, numpy.array(list(columns.values())).T, delimiter=",", header=",".join(columns), comments="")


def write_summary(folder, n_steps, end):
    (folder / "summary.json").write_text(json.dumps({
        "status": "finished", "steps": n_steps, "end_time": end, "wall_seconds": 2, "core_seconds": 1.5,
        "programs": {"solid-server": {"seconds": 1.5, "elements": 16.0, "nodes": 120.0}}}))


CONTACT_SCENE = """
title: "two bodies"
time { end: 0.1 step: 1e-3 }
solid {
  body { name: "lower" box { length { x: 0.02 y: 0.01 z: 0.01 } elements_x: 2 elements_y: 2 elements_z: 2 }
         material { density: 1000 neo_hookean { shear_modulus: 1e5 bulk_modulus: 1e6 } } fixed: "y_min" }
  body { name: "upper" mesh_file { file: "upper.msh" length_unit: 0.001 }
         material { density: 1000 neo_hookean { shear_modulus: 1e5 bulk_modulus: 1e6 } } points_per_element: 14
         region { name: "cover" material { density: 1040 saint_venant_kirchhoff { young_modulus: 2e4 poisson_ratio: 0.4 } } } }
  contact { first: "lower/y_max" second: "upper/bottom" distance: 1e-4 }
  gravity { direction { y: -1 } value { row { time: 0 value: 0 } row { time: 0.05 value: 9.81 } interpolation: COSINE } }
  prescribed_motion { nodes: "upper/top" y: "-1e-3*sin(pi*t/0.1)" x: "x*t" }
}
output { results_interval: 0.01 }
"""


def write_contact_run(folder, shapes=("hexahedron20", "tetrahedron10")):
    """Two bodies in two files; the upper one comes down by 1 mm in the middle of the run and goes up again."""
    folder.mkdir(parents=True)
    (folder / "resolved_scene.txtpb").write_text(CONTACT_SCENE)
    times = numpy.linspace(0, 0.1, 41)
    for name, shape, height in zip(("lower", "upper"), shapes, (0.0, 0.0102)):
        position, cells = BOXES[shape](2, 2, 2, (0.02, 0.01, 0.01))
        amount = -1e-3 if name == "upper" else -1e-4
        write_result(folder / "results", name, shape, position + [0, height, 0], cells, times,
                     lambda t, n=len(position), amount=amount: {"displacement": numpy.outer(numpy.full(n, amount * numpy.sin(numpy.pi * t / 0.1)), [0, 1, 0])})
    time = numpy.linspace(1e-3, 0.1, 100)
    touch = numpy.maximum(0, numpy.sin(numpy.pi * time / 0.1) - 0.5)
    write_table(folder / "history.csv", {
        "time [s]": time, "dt [s]": 0 * time + 1e-3, "inner_iterations [1]": 0 * time + 3, "solid.kinetic_energy [J]": 1e-6 * time,
        "solid.strain_energy [J]": 1e-6 * touch, "solid.contact_energy [J]": 1e-7 * touch, "solid.contact_force [N]": touch,
        "solid.contact_distance [m]": 1e-4 * (1 - touch), "solid.substeps [1]": 0 * time + 1, "solid.newton_iterations [1]": 2 + (touch > 0)})
    write_summary(folder, 100, 0.1)
    return folder


VALVE_SCENE = """
title: "a valve"
time { end: 0.1 step: 1e-3 }
solid {
  body { name: "valve" valve { tube_radius: 0.0105 height: 0.0147 thickness: 3e-4 elements_u: 20 elements_v: 16 elements_t: 1 }
         material { density: 1000 saint_venant_kirchhoff { young_modulus: 1.5e6 poisson_ratio: 0.4 } } fixed: "base" mass_damping: 100 }
  pressure { surface: "ventricular" value { row { time: 0 value: 0 } row { time: 0.05 value: 533 } row { time: 0.1 value: 0 } } }
  orifice { name: "orifice_area" surface: "ventricular" axis: X radius: 0.0105 }
}
"""


def valve_area(time):
    """Opens from 10 to 30 ms, flutters, closes from 70 to 90 ms: 3 cm^2 at most."""
    return numpy.interp(time, [0, 0.010, 0.030, 0.040, 0.045, 0.050, 0.070, 0.090, 0.1], [0, 0, 3e-4, 3e-4, 2e-4, 3e-4, 3e-4, 0, 0])


def write_valve_run(folder, n_elements=(2, 2, 2)):
    """A box in the place of leaflets, which moves as far as the orifice is open."""
    folder.mkdir(parents=True)
    (folder / "resolved_scene.txtpb").write_text(VALVE_SCENE)
    position, cells = hex20_box(*n_elements, (0.01, 0.01, 0.01))
    write_result(folder / "results", "valve", "hexahedron20", position, cells, numpy.linspace(0, 0.1, 101),
                 lambda t: {"displacement": numpy.outer(10 * valve_area(t) * position[:, 0] / 0.01, [0, 1, 0])})
    time = numpy.linspace(1e-3, 0.1, 100)
    write_table(folder / "history.csv", {"time [s]": time, "dt [s]": 0 * time + 1e-3, "inner_iterations [1]": 0 * time + 70,
                                         "edge.x [m]": 0 * time, "edge.y [m]": 10 * valve_area(time), "edge.z [m]": 0 * time,
                                         "solid.kinetic_energy [J]": 1e-6 * time, "solid.strain_energy [J]": valve_area(time),
                                         "solid.contact_force [N]": 0 * time, "solid.substeps [1]": 0 * time + 71, "orifice_area [m^2]": valve_area(time)})
    write_summary(folder, 100, 0.1)
    return folder


STATIC_SCENE = """
title: "a shallow arch"
time { end: 1 step: 0.1 }
solid {
  body { name: "arch" arch { span: 0.1 rise: 0.005 thickness: 0.001 width: 0.01 elements_x: 20 elements_y: 1 elements_z: 1 }
         material { density: 1000 saint_venant_kirchhoff { young_modulus: 1e9 poisson_ratio: 0.3 } } fixed: "left" fixed: "right" }
  node_force { nodes: "crown" value { direction { y: -1 } value { row { time: 0 value: 0 } row { time: 1 value: 40 } } } }
  time_integration { method: STATIC arc_length: true }
}
"""


def write_static_run(folder):
    """Ten equilibria of a probe under a growing force; no fields are stored."""
    folder.mkdir(parents=True)
    (folder / "resolved_scene.txtpb").write_text(STATIC_SCENE)
    time = numpy.linspace(0.1, 1, 10)
    write_table(folder / "history.csv", {"time [s]": time, "dt [s]": 0 * time + 0.1, "inner_iterations [1]": 0 * time + 4, "crown.x [m]": 0 * time,
                                         "crown.y [m]": -1e-3 * time**2, "crown.z [m]": 0 * time, "solid.kinetic_energy [J]": 0 * time,
                                         "solid.strain_energy [J]": 1e-3 * time, "solid.reaction.left.x [N]": 3 * time, "solid.reaction.left.y [N]": 20 * time,
                                         "solid.newton_iterations [1]": 3 + (time > 0.5)})
    write_summary(folder, 10, 1)
    return folder
