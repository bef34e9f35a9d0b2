"""Folders of runs whose content is known: a probe that swings at 130 Hz, a box of 20-node hexahedra, a channel."""

import json
import math

import h5py
import numpy

FREQUENCY = 130.0
SCENE = """
title: "a synthetic fold"
time { end: 0.5 step: 1e-5 }
flow { fluid { density: 1.13 viscosity: 1e-5 } glottis { model: M2 midplane: 0.0021 } }
solid { body { name: "fold" vocal_fold { medial_thickness: 1e-3 length: 0.02 elements_x: 2 elements_y: 2 elements_z: 2 } } }
coupling { scheme: SERIAL_IMPLICIT iqn_ils { columns_max: 50 } }
"""


def hex20_box(n_x, n_y, n_z, length):
    """Node positions and cells of a box of 20-node hexahedra in VTK's order."""
    corner = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
    edge = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    local = corner + [tuple((a + b) // 2 for a, b in zip(corner[i], corner[j])) for i, j in edge]
    number, cells = {}, []
    for i in range(n_x):
        for j in range(n_y):
            for k in range(n_z):
                cells += [number.setdefault((2 * i + a, 2 * j + b, 2 * k + c), len(number)) for a, b, c in local]
    position = numpy.array(list(number), dtype=float) * numpy.array(length) / (2 * numpy.array([n_x, n_y, n_z]))
    return position, numpy.array(cells)


def write_result(folder, name, shape, position, cells, times, fields):
    """One block; `fields` is a function of time that gives a dictionary of arrays."""
    folder.mkdir(exist_ok=True)
    with h5py.File(folder / f"{name}.h5", "w") as file:
        file["mesh/position"], file["mesh/cell"] = position, cells
        file["mesh/shape"] = shape
        file["field_names"] = ",".join(fields(0.0))
        file["n_states"], file["time"] = numpy.array([len(times)]), numpy.array(times)
        for i, time in enumerate(times):
            values = fields(time)
            for field, array in values.items():
                file[f"state/{i}/{field}"] = array.astype("f4")
            file[f"state/{i}/position"] = (position + values["displacement"]).astype("f4")
    (folder / f"{name}.xmf").write_text("<Xdmf/>")


def swing(time):
    return 1e-3 * numpy.sin(2 * math.pi * FREQUENCY * time)


def write_history(path, n_rows, end):
    time = numpy.linspace(end / n_rows, end, n_rows)
    area = 5e-6 + 4e-6 * numpy.sin(2 * math.pi * FREQUENCY * time)
    columns = {"time [s]": time, "dt [s]": numpy.full(n_rows, end / n_rows), "iterations [1]": numpy.full(n_rows, 3.0),
               "displacement.change [m]": numpy.full(n_rows, 1e-9), "displacement.relative_change [1]": numpy.full(n_rows, 1e-6),
               "exit.x [m]": 0 * time, "exit.y [m]": swing(time), "exit.z [m]": 0 * time,
               "flow.rate [m^3/s]": 40 * area, "flow.smallest_area [m^2]": area, "solid.strain_energy [J]": 1e-6 * area,
               "flow.exit_pressure [Pa]": 1e6 * area}
    numpy.savetxt(path, numpy.array(list(columns.values())).T, delimiter=",", header=",".join(columns), comments="")


def write_run(folder, n_rows=5000, end=0.5):
    """A complete run."""
    folder.mkdir(parents=True)
    (folder / "resolved_scene.txtpb").write_text(SCENE)
    write_history(folder / "history.csv", n_rows, end)
    iterations = [f"{step},{1e-4 * step},1e-4,{k},{10.0 ** -k},{10.0 ** -k}" for step in range(1, 6) for k in (1, 2, 3)]
    (folder / "iterations.csv").write_text("\n".join(
        ["step [1],time [s],dt [s],iteration [1],displacement.change [m],displacement.relative_change [1]"] + iterations) + "\n")
    times = list(numpy.arange(end - 3 / FREQUENCY, end, 1 / FREQUENCY / 40))
    position, cells = hex20_box(2, 2, 2, (0.004, 0.002, 0.02))
    write_result(folder / "results", "fold", "hexahedron20", position, cells, times,
                 lambda t: {"displacement": numpy.outer(position[:, 1] / 0.002 * swing(t), [0, 1, 0])})
    line = numpy.zeros((50, 3))
    line[:, 0] = numpy.linspace(0, 0.01, 50)
    write_result(folder / "results", "flow", "polyline", line, numpy.arange(50), times,
                 lambda t: {"displacement": 0 * line, "pressure": numpy.linspace(1000, 0, 50)[:, None],
                            "area": numpy.full((50, 1), 5e-6 + 4e-6 * math.sin(2 * math.pi * FREQUENCY * t))})
    summary = {"status": "finished", "scene": "scene.txtpb", "version": "1", "commit": "abc", "steps": n_rows, "end_time": end,
               "wall_seconds": 10.0, "core_seconds": 15.0, "coupling": {"iterations_mean": 3.0, "iterations_max": 3},
               "programs": {"flow": {"seconds": 4.0, "peak_memory_bytes": 1e7}, "solid": {"seconds": 5.0, "peak_memory_bytes": 2e7}},
               "quantities": {"frequency": {"value": FREQUENCY, "unit": "Hz", "spread": 0.5, "cycles": 26}}}
    (folder / "summary.json").write_text(json.dumps(summary))
    return folder


FLOW_SCENE = """
title: "synthetic vortices"
time { end: 2 step: 0.1 }
flow { fluid { density: 1 viscosity: 0.01 } navier_stokes { grid {
  x { uniform { start: 0 end: 6.3 cells: 16 } } y { uniform { start: 0 end: 6.3 cells: 16 } } z { uniform { start: 0 end: 6.3 cells: 16 } } }
  integral_quantities: true } }
"""


def box_surface(low, high):
    """Corners and triangles of a box, normals outward."""
    corner = numpy.array([[(low, high)[i >> d & 1][d] for d in range(3)] for i in range(8)], dtype=float)
    squares = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    return corner, numpy.array([triangle for a, b, c, d in squares for triangle in ((a, b, c), (a, c, d))])


def add_body(folder, low=(2, 2, 0), high=(3, 4, 6.2832), per_state=0.5):
    """A box in the flow of write_flow_run, which moves on along x from state to state; its forces in the history."""
    corner, triangles = box_surface(low, high)
    with h5py.File(folder / "results" / "flow.h5", "a") as file:
        file["body/block/triangle"] = triangles
        faces = [file[f"grid/flow/{axis}"][()] for axis in "xyz"]
        names = sorted(file["state"])
    x, y, z = numpy.meshgrid(*[0.5 * (f[1:] + f[:-1]) for f in faces], indexing="ij")
    for state, name in enumerate(names):
        shift = numpy.array([per_state * state, 0, 0])
        outside = (x < low[0] + shift[0]) | (x > high[0] + shift[0]) | (y < low[1]) | (y > high[1]) | (z < low[2]) | (z > high[2])
        with h5py.File(folder / "results" / f"flow.{name}.h5", "a") as own:
            own["body/block/position"] = (corner + shift).astype("f4")
            own["flow/fluid_share"] = outside.transpose(2, 1, 0).astype("f4")
    lines = (folder / "history.csv").read_text().splitlines()
    columns = ["body.block.force_x [N]", "body.block.viscous_force_x [N]", "body.block.moment_z [N m]", "body.block.power [W]", "around.force_balance_x [N]"]
    rows = [f"{line},{2 + 0.1 * n},{0.5},{-1 - n},{3 * n},{2.05 + 0.1 * n if n > 3 else 'nan'}" for n, line in enumerate(lines[1:])]
    (folder / "history.csv").write_text("\n".join([lines[0] + "," + ",".join(columns)] + rows) + "\n")
    return folder


def write_flow_run(folder, n_cells=(16, 16, 16), n_states=3):
    """A flow in two or three dimensions: a vortex about z in every state, and a history in which energy decays."""
    (folder / "results").mkdir(parents=True)
    (folder / "resolved_scene.txtpb").write_text(FLOW_SCENE)
    with h5py.File(folder / "results" / "flow.h5", "w") as file:
        faces = [numpy.linspace(0, 2 * math.pi, n + 1) for n in n_cells]
        for axis, values in zip("xyz", faces):
            file[f"grid/flow/{axis}"] = values
        x, y, z = numpy.meshgrid(*[0.5 * (f[1:] + f[:-1]) for f in faces], indexing="ij")
        for state in range(n_states):
            velocity = numpy.stack([numpy.sin(x) * numpy.cos(y), -numpy.cos(x) * numpy.sin(y), 0 * z], axis=-1) / (1 + state)
            name = f"flow.{state:06d}.h5"
            with h5py.File(folder / "results" / name, "w") as own:
                own["flow/velocity"] = velocity.transpose(2, 1, 0, 3).astype("f4")
                own["flow/pressure"] = (numpy.cos(2 * x) + numpy.cos(2 * y)).transpose(2, 1, 0).astype("f4")
                own["time"] = numpy.array([0.5 * state])
            file[f"state/{state:06d}"] = h5py.ExternalLink(name, "/")
    (folder / "results" / "flow.xmf").write_text("<Xdmf/>")
    columns = ["time [s]", "dt [s]", "inner_iterations [1]", "flow.substeps [1]", "flow.courant [1]", "flow.largest_speed [m/s]",
               "flow.divergence [1/s]", "flow.pressure_iterations [1]", "flow.pressure_residual [1]", "flow.kinetic_energy [J]",
               "flow.dissipation [W]", "flow.enstrophy [m^3/s^2]", "cut.flow_rate [m^3/s]", "cut.momentum_flux [N]",
               "wake.velocity_x [m/s]", "wake.pressure [Pa]", "flow.velocity_error_l2 [m/s]", "flow.velocity_error_max [m/s]",
               "flow.pressure_error_l2 [Pa]"]
    rows = [[0.1 * n, 0.1, 0, 1 + n % 2, 0.5, 1 - 0.01 * n, 1e-9 * (n + 1), 3, 1e-4, math.exp(-0.1 * n), 0.1 * math.exp(-0.1 * n), 5, math.sin(n),
             1, math.cos(n), 0.1 * n, 1e-3 * (n + 1), 2e-3 * (n + 1), 1e-4] for n in range(20)]
    (folder / "history.csv").write_text("\n".join([",".join(columns)] + [",".join(map(str, row)) for row in rows]) + "\n")
    (folder / "summary.json").write_text(json.dumps({
        "status": "finished", "steps": 20, "end_time": 2, "wall_seconds": 4,
        "programs": {"flow-server": {"seconds": 3.5, "peak_memory_bytes": 1e8, "cells": 4096.0, "cells_active": 4096.0, "ranks": 2.0,
                                     "ns_per_cell_step": 123.4, "bytes_per_cell": 180.0, "seconds_solve": 3.0, "seconds_measurements": 0.1,
                                     "seconds_results": 0.3, "seconds_checkpoints": 0.1}}}))
    return folder
