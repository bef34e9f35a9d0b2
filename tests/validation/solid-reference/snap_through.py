"""Snap-through of a shallow sinusoidal arch under a sinusoidal load."""

from pathlib import Path

import numpy

import abaqus_mesh
import stored_runs as runs
from solid_scene import STATIC, around, body, probe, saint_venant_kirchhoff, scene, symmetry

# Arch of span 1; its rise is some thicknesses. The hinges are lines of nodes, around which the end gives way like a piece of arch
# about a thickness long: the limit load falls short by about thickness over span.
SPAN, WIDTH, YOUNG_MODULUS = 1.0, 0.05, 1e6


def gyration(thickness):
    return thickness / numpy.sqrt(12)


def arch_mesh(options, ratio, n, thickness):
    """The middle line is a sine of rise 2 ratio rho; every column of nodes is a node set, its loads are consistent with a line load."""
    rise = 2 * ratio * gyration(thickness)

    def place(x, y, z):
        slope = rise * numpy.pi / SPAN * numpy.cos(numpy.pi * x)
        normal = numpy.array([-slope, 1]) / numpy.hypot(slope, 1)
        height = thickness * (y - 0.5)
        return SPAN * x + height * normal[0], rise * numpy.sin(numpy.pi * x) + height * normal[1], WIDTH * z

    elements = (n, 2, 1)
    nodes, blocks = abaqus_mesh.block(elements, place)
    column = {f"column_{i}": [key for key in nodes if key[0] == i and key[1] == 2] for i in range(1, 2 * n)}
    hinges = {name: [key for key in nodes if key[0] == i and key[1] == 2] for name, i in (("left", 0), ("right", 2 * n))}
    path = Path(options.out).resolve() / "meshes" / f"arch-{ratio}-{n}-h{thickness}.inp"
    abaqus_mesh.write(path, nodes, blocks, {"back": abaqus_mesh.side(elements, 2, 0)}, {**column, **hinges})
    return f'mesh_file {{ file: "{path}" }}', {name: len(members) for name, members in column.items()}


def column_weights(n):
    """The integral of sin(pi x) times the quadratic shape function of each column."""
    points, weights = numpy.polynomial.legendre.leggauss(6)
    found = numpy.zeros(2 * n + 1)
    for element in range(n):
        x = (element + (points + 1) / 2) / n
        shape = numpy.array([points * (points - 1) / 2, 1 - points**2, points * (points + 1) / 2])
        found[2 * element : 2 * element + 3] += (shape * weights * numpy.sin(numpy.pi * x)).sum(1) * SPAN / (2 * n)
    return found


def arch_rows(options, reference):
    source = "shallow arch, closed form"
    cases = [(1.5, 20, 0.01), (1.5, 20, 0.005), (1.5, 20, 0.0025), (2, 10, 0.005), (2, 20, 0.01), (2, 20, 0.005), (2, 20, 0.0025), (3, 20, 0.005)]
    for ratio, n, thickness in cases if not options.quick else [(2, 20, 0.005)]:
        unit = YOUNG_MODULUS * WIDTH * thickness**3 / 12 * (numpy.pi / SPAN) ** 4 * 2 * gyration(thickness)  # q0, force per length
        rise = 2 * ratio * gyration(thickness)
        limit = reference["sinusoidal_shallow_arch_pinned", f"lambda1={ratio:g}", "symmetric limit load / q0"]
        mesh, members = arch_mesh(options, ratio, n, thickness)
        weights = column_weights(n)
        # 100 steps between 0.93 and 1.03 of the expected limit: the load is known to 0.1 %.
        table = "value {{ row {{ time: 0  value: 0 }}  row {{ time: 20  value: {0!r} }}  row {{ time: 120  value: {1!r} }} }}"
        full = {i: limit * unit * weights[i] / members[f"column_{i}"] for i in range(1, 2 * n)}
        loads = "".join(f'  node_force {{ nodes: "column_{i}"  value {{ direction {{ y: -1 }}  {table.format(0.93 * load, 1.03 * load)} }} }}\n'
                        for i, load in full.items())
        name = f"arch-{ratio}-{n}-h{thickness}"
        text = scene(name, 120.0, 1.0, body("arch", mesh, saint_venant_kirchhoff(YOUNG_MODULUS, 0.0), 'fixed: "left"', 'fixed: "right"',
                                            symmetry(back="Z")) + loads, STATIC, probe("crown", (SPAN / 2, rise + thickness / 2, 0)))
        folder = Path(options.out).resolve() / name
        code = runs.run_text(options.couplet, text, folder, options.set)
        print(f"  {name} done", flush=True)
        history = runs.read_history(folder)
        load = numpy.interp(history["time"], [0, 20, 120], [0, 0.93 * limit, 1.03 * limit])
        varied = {"mesh": n, "thickness": thickness, "newton_iterations": history["solid.newton_iterations"].sum()}
        drop = numpy.diff(numpy.concatenate([[0], -history["crown.y"]]))
        if code == 0:
            jump = drop[20:].argmax() + 20
            at_limit = load[jump - 1 : jump + 1].mean()
            yield runs.row(name, "jump_of_crown/rise", drop[jump] / rise, None, "snaps through", folder, (0.5, 3), **varied)
        else:
            jump, at_limit = len(load), load[-1]
            yield runs.row(name, "exit_code", code, 0, runs.last_words(folder), folder, **varied)
        band = around(limit, 1.5 * thickness / SPAN + 0.002) if n == 20 else None
        yield runs.row(name, "limit_load/q0", at_limit, limit, source + ", symmetric", folder, band, **varied)
        unstable = numpy.flatnonzero(history["solid.negative_pivots"][:jump] > 0)
        if len(unstable):
            bifurcation = reference["sinusoidal_shallow_arch_pinned", "lambda1=3", "asymmetric bifurcation load / q0"]
            yield runs.row(name, "first_unstable_load/q0", load[unstable[0]], bifurcation if ratio == 3 else None,
                           source + ", asymmetric bifurcation, by negative pivots", folder, **varied)


def rows(options, reference):
    yield from arch_rows(options, reference)
