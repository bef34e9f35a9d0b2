"""Snap-through: a shallow sinusoidal arch under a sinusoidal load, and the truss of von Mises."""

from pathlib import Path

import numpy

import abaqus_mesh
import stored_runs as runs
from solid_scene import STATIC, around, body, probe, saint_venant_kirchhoff, scene, solve, symmetry

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


def bar(options, n, thickness):
    """Half of the truss, lying along x: a bar of length 1 whose hinges are the middle lines of its ends."""
    elements = (n, 2, 1)
    nodes, blocks = abaqus_mesh.block(elements, lambda x, y, z: (SPAN * x, thickness * (y - 0.5), WIDTH * z))
    hinges = {name: [key for key in nodes if key[0] == i and key[1] == 2] for name, i in (("hinge", 0), ("crown", 2 * n))}
    path = Path(options.out).resolve() / "meshes" / f"bar-{n}-h{thickness}.inp"
    abaqus_mesh.write(path, nodes, blocks, {"back": abaqus_mesh.side(elements, 2, 0)}, hinges)
    return f'mesh_file {{ file: "{path}" }}', len(hinges["crown"])


def truss_rows(options, reference):
    """A bar that lies at an angle and may only move up and down at its crown. The load on a node line is carried into the section over
    about a thickness, which adds to the compliance: the stiffness k [N/m] of the bar is measured on the same mesh by a small pull.
    Energy of the bar k (l^2 - L^2)^2 / (8 L^2), l^2 = L^2 - H^2 + (H - w)^2: largest load on it k H^3 / (3 sqrt(3) L^2) at w = H (1 - 1 / sqrt(3))."""
    angle = 2.0
    rise = SPAN * numpy.sin(numpy.radians(angle))
    for n, thickness in ((20, 0.05), (40, 0.05), (40, 0.04)) if not options.quick else ((20, 0.05),):
        mesh, n_crown = bar(options, n, thickness)
        material = saint_venant_kirchhoff(YOUNG_MODULUS, 0.0)
        pull = 1e-6 * SPAN
        motion = f'  prescribed_motion {{ nodes: "crown"  x: "{pull!r}"  y: "0" }}\n'
        history, folder = solve(options, f"bar-{n}-h{thickness}",
                                scene("bar", 1.0, 1.0, body("bar", mesh, material, 'fixed: "hinge"', symmetry(back="Z")) + motion, STATIC))
        stiffness = -history["solid.reaction.hinge.x"][-1] / pull
        limit = stiffness * rise**3 / (3 * numpy.sqrt(3) * SPAN**2)
        row = "row {{ time: {0}  value: {1!r} }}"
        table = " ".join(row.format(time, share * limit / n_crown) for time, share in ((0, 0.0), (20, 0.93), (120, 1.03)))
        load = f'  node_force {{ nodes: "crown"  value {{ direction {{ y: -1 }}  value {{ {table} }} }} }}\n'
        turned = f"placement {{ rotation_axis {{ z: 1 }}  rotation_angle: {angle!r} }}"
        name = f"truss-{n}-h{thickness}"
        history, folder = solve(options, name, scene(name, 120.0, 1.0, body("bar", mesh, material, 'fixed: "hinge"', symmetry(back="Z", crown="X"),
                                                                            turned) + load, STATIC, probe("crown", (SPAN * numpy.cos(numpy.radians(angle)), rise, 0))))
        share = numpy.interp(history["time"], [0, 20, 120], [0, 0.93, 1.03])
        drop = -history["crown.y"]
        jump = numpy.diff(drop).argmax() + 1
        varied = {"mesh": n, "thickness": thickness, "newton_iterations": history["solid.newton_iterations"].sum()}
        # Steps of the load are 0.1 %. Bending of a bar that is not quite straight, over its Euler load, is of second order.
        yield runs.row(name, "limit_load/exact", share[jump - 1 : jump + 1].mean(), 1, "von Mises truss of bars with the measured stiffness", folder,
                       around(1, 0.003), **varied)
        # Below the limit by d in load, the drop lies below that of the limit by the root of d: a step of 0.1 % is worth 3 % of it.
        yield runs.row(name, "drop_before_the_jump/rise", drop[jump - 1] / rise, 1 - 1 / numpy.sqrt(3), "von Mises truss", folder, **varied)
        after = 1 + 2 / numpy.sqrt(3)  # the other equilibrium under the limit load; 0.1 % more load moves it by 0.01 %
        yield runs.row(name, "drop_after_the_jump/rise", drop[jump] / rise, after, "von Mises truss", folder, around(after, 1e-3), **varied)


def rows(options, reference):
    yield from arch_rows(options, reference)
    yield from truss_rows(options, reference)
