"""Snap-through: a shallow sinusoidal arch under a sinusoidal load, a von Mises truss."""

from pathlib import Path

import numpy

import abaqus_mesh
import stored_runs as runs
from solid_scene import STATIC, around, body, constant, probe, ramp, saint_venant_kirchhoff, scene, solve, symmetry

# Arch of span 1, slender enough for the theory of shallow arches: thickness 0.01, rise up to 1/58 of the span.
SPAN, THICKNESS, WIDTH, YOUNG_MODULUS = 1.0, 0.01, 0.05, 1e6
GYRATION = THICKNESS / numpy.sqrt(12)


def arch_mesh(options, ratio, n):
    """The middle line is a sine of rise 2 ratio rho; every column of nodes is a node set, its loads are consistent with a line load."""
    rise = 2 * ratio * GYRATION

    def place(x, y, z):
        slope = rise * numpy.pi / SPAN * numpy.cos(numpy.pi * x)
        normal = numpy.array([-slope, 1]) / numpy.hypot(slope, 1)
        height = THICKNESS * (y - 0.5)
        return SPAN * x + height * normal[0], rise * numpy.sin(numpy.pi * x) + height * normal[1], WIDTH * z

    elements = (n, 2, 1)
    nodes, blocks = abaqus_mesh.block(elements, place)
    column = {f"column_{i}": [key for key in nodes if key[0] == i and key[1] == 2] for i in range(1, 2 * n)}
    hinges = {name: [key for key in nodes if key[0] == i and key[1] == 2] for name, i in (("left", 0), ("right", 2 * n))}
    path = Path(options.out).resolve() / "meshes" / f"arch-{ratio}-{n}.inp"
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
    unit = YOUNG_MODULUS * WIDTH * THICKNESS**3 / 12 * (numpy.pi / SPAN) ** 4 * 2 * GYRATION  # q0, force per length
    source = "shallow arch, closed form"
    for ratio, n in [(1.5, 20), (2, 20), (3, 20)] if not options.quick else [(2, 20)]:
        limit = reference["sinusoidal_shallow_arch_pinned", f"lambda1={ratio:g}", "symmetric limit load / q0"]
        mesh, members = arch_mesh(options, ratio, n)
        weights = column_weights(n)
        # 100 steps between 0.9 and 1.1 of the expected limit: the load is known to 0.2 %.
        table = f"value {{ row {{ time: 0  value: 0 }}  row {{ time: 10  value: %r }}  row {{ time: 110  value: %r }} }}"
        loads = "".join(f'  node_force {{ nodes: "{name}"  value {{ direction {{ y: -1 }}  '
                        + table % (0.9 * limit * unit * weights[i] / members[name], 1.1 * limit * unit * weights[i] / members[name]) + " } }\n"
                        for i, name in ((i, f"column_{i}") for i in range(1, 2 * n)))
        name = f"arch-{ratio}-{n}"
        crown = (SPAN / 2, 2 * ratio * GYRATION + THICKNESS / 2, 0)
        text = scene(name, 110.0, 1.0, body("arch", mesh, saint_venant_kirchhoff(YOUNG_MODULUS, 0.0), 'fixed: "left"', 'fixed: "right"',
                                            symmetry(back="Z")) + loads, STATIC, probe("crown", crown))
        history, folder = solve(options, name, text)
        load = numpy.interp(history["time"], [0, 10, 110], [0, 0.9 * limit, 1.1 * limit])
        drop = numpy.diff(numpy.concatenate([[0], -history["crown.y"]]))
        jump = drop[10:].argmax() + 10
        varied = {"mesh": n, "newton_iterations": history["solid.newton_iterations"].sum()}
        yield runs.row(name, "limit_load/q0", load[jump - 1 : jump + 1].mean(), limit, source + ", symmetric", folder, around(limit, 0.01), **varied)
        yield runs.row(name, "jump_of_crown/rise", drop[jump] / (2 * ratio * GYRATION), None, "snaps through: above 1", folder, (0.5, 3), **varied)
        unstable = numpy.flatnonzero((history["solid.negative_pivots"] > 0) & (load < 0.999 * load[jump]))
        if ratio == 3:
            bifurcation = reference["sinusoidal_shallow_arch_pinned", "lambda1=3", "asymmetric bifurcation load / q0"]
            if len(unstable):
                yield runs.row(name, "first_unstable_load/q0", load[unstable[0]], bifurcation, source + ", by negative pivots", folder, **varied)


def truss_rows(options, reference):
    """Half of the truss: a bar with a hinge (the middle line of nodes of its end) at the support and one at the apex."""
    rise = 0.2
    limit = reference["von_mises_truss_SVK", f"half span 1 rise {rise:g} EA=1", "limit load"]
    length = numpy.hypot(1, rise)
    along, across = numpy.array([1, rise]) / length, numpy.array([-rise, 1]) / length
    for height in (0.02,) if options.quick else (0.04, 0.02, 0.01):
        width, elements = 0.1, (4, 2, 1)
        nodes, blocks = abaqus_mesh.block(elements, lambda x, y, z: (*(length * x * along + height * (y - 0.5) * across), width * z))
        mesh = Path(options.out).resolve() / "meshes" / f"bar-{height}.inp"
        abaqus_mesh.write(mesh, nodes, blocks, {}, {"support": [key for key in nodes if key[0] == 0 and key[1] == 2],
                                                    "apex": [key for key in nodes if key[0] == 8 and key[1] == 2],
                                                    "back": [key for key in nodes if key[2] == 0]})
        young_modulus = 1 / (width * height)
        name = f"truss-{rise}-h{height}"
        solid = body("bar", f'mesh_file {{ file: "{mesh}" }}', saint_venant_kirchhoff(young_modulus, 0.0), 'fixed: "support"',
                     symmetry(apex="X", back="Z"))
        solid += f'  prescribed_motion {{ nodes: "apex"  y: "-{2 * rise!r}*t" }}\n'
        history, folder = solve(options, name, scene(name, 1.0, 0.02, solid, STATIC, probe("apex", (1, rise, 0))))
        force = -2 * history["solid.reaction.apex.y"]
        top = force[:30].argmax()
        slope = numpy.polyfit(history["time"][top - 1 : top + 2], force[top - 1 : top + 2], 2)
        source = "two SVK bars, displacement of the apex prescribed"
        yield runs.row(name, "limit_load/EA", slope[2] - slope[1] ** 2 / (4 * slope[0]), limit, source, folder, mesh=height)
        yield runs.row(name, "drop_at_limit", -2 * rise * slope[1] / (2 * slope[0]), rise * (1 - 1 / numpy.sqrt(3)), source, folder, mesh=height)
        yield runs.row(name, "force_when_flat", numpy.interp(0.5, history["time"], force), 0, "by symmetry", folder, (-0.01 * limit, 0.01 * limit),
                       mesh=height)


def rows(options, reference):
    yield from arch_rows(options, reference)
    yield from truss_rows(options, reference)
