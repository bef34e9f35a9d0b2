"""Equilibrium: the flag of Turek and Hron, a cantilever, a hollow sphere, a hollow cylinder that is nearly incompressible."""

import numpy
from numpy.linalg import norm

import calculix
import couplet
import inflation

# Displacement of the tip of the flag [m] on the finest meshes of the authors' site (featflow, level 5+1), as printed in
# the tables of the fluid-structure benchmark; their first publication has -7.187/-66.10 and -0.469/-16.97 mm.
FLAG = {"CSM1": (1.4e6, (-7.18767e-3, -66.1023e-3)), "CSM2": (5.6e6, (-0.4690e-3, -16.9739e-3))}
FLAG_TIP = (0.6, 0.2, 0.0)
# Large-rotation cantilever under an end shear, P = 4: (u, w) of Reissner's beam with EA and 5/6 GA.
CANTILEVER = (-3.2895094, 6.7001325)
# What CalculiX is asked: first and largest load increment, and the out-of-balance force and correction that it allows,
# its own (5e-3, 1e-2) or ones at which its error is that of the mesh.
ASKED = ((1.0, None), (0.1, None), (1.0, 1e-6))
ELEMENTS = {8: calculix.REDUCED, 27: calculix.FULL}


def add_ours(bench, case, mesh_name, ours, error_of, setting="", target=""):
    """The mesh, or nothing where no results file was written."""
    named = {"setting": setting, "family": bench.family, "target": target}
    if ours.code != 0:
        bench.table.failed(case, "couplet", mesh_name, ours, **named)
        return ours.mesh() if ours.results else None
    mesh = ours.mesh()
    bench.table.add(case, "couplet", mesh_name, error=error_of(mesh, ours.displacement()), core_seconds=ours.core_seconds,
                    iterations=int(ours.of_solid["newton_iterations"]), elements=len(mesh.cell), **named)
    return mesh


def compare(bench, case, mesh_name, ours, error_of, deck_of, element, setting="", target="", repeats=3):
    """Our row, then CalculiX on exactly our mesh in each way of asking. error_of(mesh, displacement); deck_of(mesh,
    element, step) makes a deck in which step(deck) begins the step."""
    mesh = add_ours(bench, case, mesh_name, ours, error_of, setting, target)
    if not bench.has_peer or mesh is None:
        return
    for increment, tolerance in ASKED:
        asked = f", steps of {increment:g}" + (", tight" if tolerance else "")
        named = {"setting": setting + asked, "family": bench.family, "element": element, "increment": increment}
        deck = deck_of(mesh, element, lambda deck: deck.static(increment, tolerance)).print_displacement("OBSERVED")
        theirs = calculix.solve(deck, bench.folder(case, mesh_name, "calculix"), repeats=repeats)
        if theirs.code != 0:
            bench.table.failed(case, "calculix", mesh_name, theirs, iterations=theirs.n_iterations, **named)
            continue
        displacement = numpy.full(mesh.position.shape, numpy.nan)
        for node, value in theirs.displacement[-1][1].items():
            displacement[node] = value
        bench.table.add(case, "calculix", mesh_name, error=error_of(mesh, displacement), core_seconds=theirs.core_seconds,
                        iterations=theirs.n_iterations, elements=len(mesh.cell), **named)


def flag_body(young_modulus, nx, ny):
    return (f"cylinder_beam {{ elements_x: {nx} elements_y: {ny} }} "
            + couplet.saint_venant_kirchhoff(young_modulus, 0.4, 1000)
            + ' fixed: "root" symmetry { surface: "front" normal: Z } symmetry { surface: "back" normal: Z }')


def flag_deck(mesh, element, young_modulus):
    """The root lies on the cylinder, radius 0.05 m around (0.2, 0.2)."""
    root = mesh.nodes_where(lambda x, y, z: abs(numpy.hypot(x - 0.2, y - 0.2) - 0.05) < 1e-7)
    return (calculix.Deck(mesh, element).hold(root, 1, 2).hold(range(len(mesh.position)), 3, 3)
            .nodes("OBSERVED", [mesh.nearest(FLAG_TIP)]).saint_venant_kirchhoff(young_modulus, 0.4, 1000))


def static_flag(bench):
    """CSM1 and CSM2: the flag under its weight."""
    bench.family = "flag"
    for case, (young_modulus, tip) in FLAG.items():
        for nx, ny in bench.choose([(20, 2), (40, 4)], [(10, 1), (20, 2), (40, 4), (80, 8)]):
            gravity = "gravity { direction { y: -1 } " + couplet.ramp(2) + " }"
            ours = bench.solve(couplet.scene(flag_body(young_modulus, nx, ny), gravity), case, f"{nx}x{ny}")

            def error_of(mesh, displacement):
                return norm(displacement[mesh.nearest(FLAG_TIP)][:2] - tip) / norm(tip)

            def deck_of(mesh, element, step):
                return step(flag_deck(mesh, element, young_modulus)).gravity(2, (0, -1, 0))

            is_target = case == "CSM1" and nx == 40
            compare(bench, case, f"{nx}x{ny}", ours, error_of, deck_of, calculix.REDUCED, "8 points",
                    "0.1 %, 0.6 core s" if is_target else "")


def cantilever(bench):
    """Length 10, width 1, thickness 0.1, no lateral contraction; the end is pushed until it stands almost upright."""
    bench.family = "slender"
    tip = numpy.array(CANTILEVER)
    targets = {(8, (16, 2)): "0.02 %, 40 iterations", (27, (16, 1)): "converges"}
    meshes = {8: bench.choose([(16, 2), (16, 1)], [(4, 2), (8, 2), (16, 2), (16, 1)]),
              27: bench.choose([(16, 1)], [(8, 1), (16, 1), (32, 1), (64, 1)])}
    for points, sizes in meshes.items():
        for nx, ny in sizes:
            body = (f"box {{ length {{ x: 10 y: 1 z: 0.1 }} elements_x: {nx} elements_y: {ny} }} "
                    f"points_per_element: {points} fixed: \"x_min\" " + couplet.saint_venant_kirchhoff(1.2e6, 0))
            load = 'traction { surface: "x_max" value { direction { z: 1 } ' + couplet.ramp(40) + " } }"
            name = f"{nx}x{ny}x1"
            ours = bench.solve(couplet.scene(body, load), "cantilever", f"{name}-{points}")

            def error_of(mesh, displacement):
                return norm(displacement[mesh.nearest((10, 0, 0.05))][[0, 2]] - tip) / norm(tip)

            def deck_of(mesh, element, step):
                end = mesh.nodes_where(lambda x, y, z: x > 10 - 1e-9)
                deck = (calculix.Deck(mesh, element).hold(mesh.nodes_where(lambda x, y, z: x < 1e-9))
                        .nodes("OBSERVED", end).saint_venant_kirchhoff(1.2e6, 0))
                return step(deck).traction(mesh.faces_of(end), 3, 40)

            compare(bench, "cantilever", name, ours, error_of, deck_of, ELEMENTS[points], f"{points} points",
                    targets.get((points, (nx, ny)), ""))


def hollow_body(shape, points, near_incompressible, material):
    symmetry = {"hollow_sphere": (("x_min", "X"), ("y_min", "Y"), ("z_min", "Z")),
                "annulus": (("start", "Y"), ("end", "X"), ("z_min", "Z"), ("z_max", "Z"))}[shape.split()[0]]
    held = " ".join(f'symmetry {{ surface: "{name}" normal: {axis} }}' for name, axis in symmetry)
    how = "near_incompressible: true" if near_incompressible else f"points_per_element: {points}"
    return f"{shape} {held} {how} {couplet.mooney_rivlin(*material)}"


def inflate(bench, case, shapes, material, inner_deformed, is_sphere):
    """Radii 1 and 2; pressure brings the inner one to inner_deformed. Error: root mean square over the inner nodes."""
    pressure = inflation.pressure_for(inflation.mooney_rivlin(*material), 1, 2, inner_deformed, is_sphere)
    load = 'pressure { surface: "inner" ' + couplet.ramp(pressure) + " }"
    axes = (0, 1, 2) if is_sphere else (0, 1)

    def inner_nodes(mesh):
        return numpy.flatnonzero(abs(norm(mesh.position[:, axes], axis=1) - 1) < 1e-7)

    def error_of(mesh, displacement):
        inner = inner_nodes(mesh)
        exact = mesh.position[inner][:, axes] * (inner_deformed - 1)
        return norm(displacement[inner][:, axes] - exact) / norm(exact)

    def deck_of(mesh, element, step):
        deck = calculix.Deck(mesh, element).nodes("OBSERVED", inner_nodes(mesh)).mooney_rivlin(*material)
        for axis in range(3):
            at = mesh.position[:, axis]
            deck.hold(numpy.flatnonzero((abs(at) < 1e-9) | (not is_sphere and axis == 2)), axis + 1, axis + 1)
        return step(deck).pressure(mesh.faces_of(inner_nodes(mesh)), pressure)

    for mesh_name, shape in shapes:
        for setting, points, near_incompressible in (("8 points", 8, False), ("27 points", 27, False),
                                                     ("near_incompressible", 27, True)):
            if near_incompressible and is_sphere:
                continue
            body = hollow_body(shape, points, near_incompressible, material)
            ours = bench.solve(couplet.scene(body, load), case, f"{mesh_name}-{setting}")
            if near_incompressible:
                add_ours(bench, case, mesh_name, ours, error_of, setting)
            else:
                compare(bench, case, mesh_name, ours, error_of, deck_of, ELEMENTS[points], setting)


def hollow_sphere(bench):
    """An eighth of a sphere, Poisson ratio 0.4."""
    bench.family = "solid"
    shapes = [(f"{n}x{n}", f"hollow_sphere {{ inner_radius: 1 outer_radius: 2 elements_radial: {n} elements_around: {n} }}")
              for n in bench.choose([2, 4], [2, 4, 8])]
    inflate(bench, "hollow sphere", shapes, (2290, 250, bulk_modulus(5080, 0.4)), 1.3, True)


def hollow_cylinder(bench):
    """A quarter of a cylinder in plane strain, Poisson ratio 0.4999."""
    bench.family = "near_incompressible"
    shapes = [(f"{n}x{2 * n}", f"annulus {{ inner_radius: 1 outer_radius: 2 length: {0.5 / n} angle: 90 elements_radial: {n} "
                               f"elements_around: {2 * n} elements_along: 1 }}") for n in bench.choose([2, 4], [2, 4, 8, 16])]
    inflate(bench, "hollow cylinder", shapes, (2290, 250, bulk_modulus(5080, 0.4999)), 1.25, False)


def bulk_modulus(shear_modulus, poisson_ratio):
    return 2 * shear_modulus * (1 + poisson_ratio) / (3 * (1 - 2 * poisson_ratio))
