"""Contact: Hertz spheres pressed together, two blocks that collide."""

from pathlib import Path

import h5py
import numpy

import abaqus_mesh
import stored_runs as runs
from solid_scene import STATIC, around, body, probe, saint_venant_kirchhoff, scene, solve, symmetry

# Hertz: two equal spheres are a sphere on the plane of symmetry, here a quarter of a large block whose top is the sphere's cap.
RADIUS, YOUNG_MODULUS, POISSON_RATIO = 10e-3, 15e3, 0.475
SIZE_OVER_CONTACT_RADIUS = 15  # of the block


def penalty(half_approach):
    """[Pa/m]: a depth of 1.2 % of half the approach under the peak pressure, which is taken off the approach."""
    return 1e9 * numpy.sqrt(0.1e-3 / half_approach)


def hertz(force):
    """Contact radius, peak pressure, approach of two equal spheres. [Johnson, Contact Mechanics, chapter 4]"""
    modulus = YOUNG_MODULUS / (2 * (1 - POISSON_RATIO**2))
    radius = RADIUS / 2
    a = (3 * force * radius / (4 * modulus)) ** (1 / 3)
    return a, 3 * force / (2 * numpy.pi * a**2), a**2 / radius


def cap_mesh(options, half_approach, n_fine, n_coarse):
    """Even elements over 1.4 contact radii, growing ones beyond; the cap is a paraboloid as in Hertz's theory, flat from 3 radii on."""
    a = numpy.sqrt(half_approach * RADIUS)
    fine, size = 1.4 * a, SIZE_OVER_CONTACT_RADIUS * a

    def graded(share):
        index = share * (n_fine + n_coarse)
        if index <= n_fine:
            return fine * index / n_fine
        return fine + (size - fine) * stretched((index - n_fine) / n_coarse)

    def stretched(s):  # from a slope that matches the even elements
        slope = fine / n_fine * n_coarse / (size - fine)
        return slope * s + (1 - slope) * s**3

    def place(x, y, z):
        x, z, depth = graded(x), graded(z), graded(1 - y)
        r = min(numpy.hypot(x, z), 3 * a)
        return x, RADIUS - r**2 / (2 * RADIUS) * (1 - depth / size) - depth, z

    n = (n_fine + n_coarse,) * 3
    nodes, elements = abaqus_mesh.block(n, place)
    path = Path(options.out).resolve() / "meshes" / f"cap-{half_approach}-{n_fine}-{n_coarse}.inp"
    abaqus_mesh.write(path, nodes, elements, {name: abaqus_mesh.side(n, axis, end) for name, axis, end in
                                              (("x_min", 0, 0), ("z_min", 2, 0), ("bottom", 1, 0), ("top", 1, 1))})
    return f'mesh_file {{ file: "{path}" }}'


def pressure_profile(folder, stiffness):
    """Contact radius and peak pressure by p^2 = p0^2 (1 - r^2/a^2), fitted to the penalty pressures of nodes on the cap."""
    with h5py.File(folder / "results" / "cap.h5") as file:
        last = int(file["n_states"][0]) - 1
        moved = file["mesh/position"][:] + file[f"state/{last}/displacement"][:].astype(float)
    pressure = stiffness * (moved[:, 1] - RADIUS)
    radius = numpy.hypot(moved[:, 0], moved[:, 2])
    inside = pressure > 0.3 * pressure.max()  # at the rim a node stands for an area that is in contact in part
    slope, square = numpy.polyfit(radius[inside] ** 2, pressure[inside] ** 2, 1)
    return numpy.sqrt(-square / slope), numpy.sqrt(square), int(inside.sum())


def hertz_rows(options):
    cases = ((0.1e-3, 3, 4),) if options.quick else ((0.1e-3, 3, 4), (0.1e-3, 6, 6), (0.025e-3, 6, 6), (0.00625e-3, 6, 6))
    for half_approach, n_fine, n_coarse in cases:
        name = f"hertz-{half_approach}-{n_fine}+{n_coarse}"
        stiffness = penalty(half_approach)
        solid = body("cap", cap_mesh(options, half_approach, n_fine, n_coarse), saint_venant_kirchhoff(YOUNG_MODULUS, POISSON_RATIO, 1040),
                     symmetry(x_min="X", z_min="Z"))
        solid += f'  prescribed_motion {{ nodes: "bottom"  x: "0"  y: "{half_approach!r}*t"  z: "0" }}\n'
        solid += f'  rigid_plane {{ plane {{ point {{ y: {RADIUS!r} }}  normal {{ y: -1 }} }}  stiffness: {stiffness!r}  surface: "top" }}\n'
        text = scene(name, 1.0, 0.25, solid, STATIC, probe("apex", (0, RADIUS, 0)) + "  results_interval: 1\n")
        history, folder = solve(options, name, text)
        force = 4 * history["solid.contact_force"][-1]
        a, peak, approach = hertz(force)
        found_a, found_peak, n_nodes = pressure_profile(folder, stiffness)
        varied = {"mesh": f"{n_fine}+{n_coarse}", "contact_radius_over_radius": a / RADIUS, "force": force, "nodes_in_contact": n_nodes,
                  "newton_iterations": history["solid.newton_iterations"].sum()}
        source = f"Hertz at the same force, {1e3 * force:.4g} mN"
        # Hertz is the limit of a small contact and a linear material: at a/R = 0.1 the tissue is strained by 8 % and Saint Venant-Kirchhoff's
        # law has lost as much of its stiffness. Gates are on the smallest contact, a/R = 0.025, where that is 2 %; its radius and pressure are
        # read from nodes a fifth of the radius apart, which cannot tell better than half of (1/5)^2.
        is_small = half_approach < 1e-5
        yield runs.row(name, "contact_radius", found_a, a, source, folder, around(a, 0.04) if is_small else None, **varied)
        yield runs.row(name, "peak_pressure", found_peak, peak, source, folder, around(peak, 0.04) if is_small else None, **varied)
        # The block is no half-space: one of 15 radii is stiffer by its share of the field, 2 a / (15 pi a) = 4 %, the less as its sides are free.
        yield runs.row(name, "approach", 2 * (half_approach - history["apex.y"][-1]), approach, source + ", half-space", folder,
                       around(approach, 2 / (numpy.pi * SIZE_OVER_CONTACT_RADIUS)) if is_small else None, **varied)


# Two blocks, Poisson ratio 0, meet with twice the speed: one-dimensional waves. A row of cubes each: elements wider than they are long
# move across the bar when their mass is lumped, which no finer mesh along it mends.
LENGTH, SPEED, BLOCK_DENSITY, GAP = 10e-3, 0.1, 1040.0, 1e-6


def block_file(options, name, n, start):
    elements = (n, 1, 1)
    nodes, blocks = abaqus_mesh.block(elements, lambda x, y, z: (start + LENGTH * x, LENGTH / n * y, LENGTH / n * z))
    path = Path(options.out).resolve() / "meshes" / f"{name}-{n}.inp"
    abaqus_mesh.write(path, nodes, blocks, {"start": abaqus_mesh.side(elements, 0, 0), "end": abaqus_mesh.side(elements, 0, 1)})
    return f'mesh_file {{ file: "{path}" }}'


def expected_duration(n):
    """A shock there, at the speed of its secant, the head of the release back, at that of the tangent, of P = E/2 (l^3 - l); and what
    the penalty k = E/h adds by giving way: with tau = rho c/(2k) the pressure falls as (2x + 2) exp(-x) - 1, x = t/tau, to 0 at 1.678."""
    wave_speed = numpy.sqrt(YOUNG_MODULUS / BLOCK_DENSITY)
    stretch = 1 - SPEED / wave_speed
    shock, release = numpy.sqrt(stretch * (stretch + 1) / 2), numpy.sqrt((3 * stretch**2 - 1) / 2)
    return LENGTH / wave_speed * (1 / shock + 1 / release + 1.678 / 2 / n)


def collision_rows(options):
    wave_speed = numpy.sqrt(YOUNG_MODULUS / BLOCK_DENSITY)
    pressure, duration = BLOCK_DENSITY * wave_speed * SPEED, 2 * LENGTH / wave_speed
    material = saint_venant_kirchhoff(YOUNG_MODULUS, 0.0, BLOCK_DENSITY)
    for n in (20,) if options.quick else (10, 20, 40):
        for method in ("CENTRAL_DIFFERENCE", "GENERALIZED_ALPHA"):
            name = f"collision-{n}-{method.lower()}"
            solid = "".join(body(block, block_file(options, block, n, start), material)
                            for block, start in (("left", -LENGTH), ("right", GAP)))
            solid += '  contact { first: "left/end"  second: "right/start" }\n'
            solid += f'  kick {{ time: 0  velocity {{ x: "-{SPEED}*x/sqrt(x*x + 1e-20)" }} }}\n'
            step = duration / 400
            text = scene(name, 400 * step * 2.0, step, solid, f"method: {method}",
                         probe("left", (-LENGTH / 2, 0, 0)) + probe("right", (LENGTH / 2 + GAP, 0, 0)))
            history, folder = solve(options, name, text)
            force = history["solid.contact_force"]
            touching = history["time"][force > 0]
            inside = (history["time"] > 0.2 * duration) & (history["time"] < 0.8 * duration)
            after = history["time"] > touching[-1] + 0.3 * duration
            varied = {"mesh": n, "method": method}
            yield runs.row(name, "contact_pressure", force[inside].mean() / (LENGTH / n) ** 2, pressure, "rho c v", folder,
                           around(pressure, 0.05), **varied)
            # Fronts are carried over two elements or so by the mesh, and lag by as much.
            front = 2 * LENGTH / n / wave_speed
            yield runs.row(name, "duration", touching[-1] - touching[0], expected_duration(n), "shock, release, penalty", folder,
                           (expected_duration(n) - front, expected_duration(n) + front), linear=duration, **varied)
            speed = numpy.polyfit(history["time"][after], history["left.x"][after], 1)[0]
            yield runs.row(name, "speed_after", speed, -SPEED, "exchanged", folder, around(-SPEED, 0.05), **varied)
            touches = numpy.count_nonzero((force[1:] > 0) & (force[:-1] == 0)) + (force[0] > 0)
            yield runs.row(name, "number_of_touches", touches, 1, "no chatter", folder, (1, 1), **varied)
            total = history["solid.kinetic_energy"] + history["solid.strain_energy"] + history["solid.contact_energy"]
            start = BLOCK_DENSITY * (LENGTH / n) ** 2 * LENGTH * SPEED**2
            yield runs.row(name, "largest_energy", total.max() / start, 1, "bounded", folder, **varied)


def rows(options, reference):
    yield from hertz_rows(options)
    yield from collision_rows(options)
