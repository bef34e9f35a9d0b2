"""Thick sphere and cylinder under inner pressure, against exact inflation: error against mesh and bulk modulus."""

import sys
from pathlib import Path

import stored_runs as runs
from solid_scene import STATIC, around, body, mooney_rivlin, probe, scene, solve, symmetry

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks" / "solid_peer"))
import inflation  # noqa: E402

INNER, OUTER = 1e-3, 2e-3
A10, A01 = 2290.0, 250.0
SHEAR_MODULUS = 2 * (A10 + A01)
RADII = (1.1, 1.25, 1.5, 2.0)
SHAPES = {
    "thick_sphere": ("hollow_sphere {{ inner_radius: {a!r}  outer_radius: {b!r}  elements_radial: {n}  elements_around: {n} }}",
                     symmetry(x_min="X", y_min="Y", z_min="Z"), "thick_sphere_MR_incompressible", "A=1 B=2, a={a:g}"),
    "thick_cylinder": ("annulus {{ inner_radius: {a!r}  outer_radius: {b!r}  length: 0.5e-3  angle: 90  elements_radial: {n}  elements_around: {m} }}",
                       symmetry(start="Y", end="X", z_min="Z", z_max="Z"), "thick_cylinder_MR_incompressible", "A=1 B=2 plane strain, a={a:g}"),
}


def solve_case(options, shape, reference, n, ratio, is_mixed):
    mesh, supports, test, case = SHAPES[shape]
    mesh = mesh.format(a=INNER, b=OUTER, n=n, m=2 * n)
    # The pressure of a sphere has its largest value, 4.672 kPa, at radius 2.1: a softer or coarser one has no equilibrium at that of radius 2.
    radii = RADII[:3] if shape == "thick_sphere" and ratio < 5000 else RADII
    pressures = [reference[test, case.format(a=a), "inner pressure"] * 1e3 for a in radii]
    times = [0.1, 0.2, 0.3, 0.4][: len(radii)]
    table = "".join(f" row {{ time: {time!r}  value: {value!r} }}" for time, value in zip((0.0, *times), (0.0, *pressures)))
    extra = [supports, "near_incompressible: true"] if is_mixed else [supports]
    name = f"{shape}-{n}-K{ratio}-{'near_incompressible' if is_mixed else 'standard'}"
    text = scene(name, times[-1], 0.05, body("wall", mesh, mooney_rivlin(A10, A01, ratio * SHEAR_MODULUS), *extra)
                 + f'  pressure {{ surface: "inner"  value {{{table} }} }}\n', STATIC, probe("inner", (INNER, 0, 0)))
    history, folder = solve(options, name, text)
    found = [1 + history["inner.x"][abs(history["time"] - time).argmin()] / INNER for time in times]
    return found, folder, name


def exact_radius(shape, bulk_modulus, pressure, near):
    """Inner radius over that at rest, of a wall with this bulk modulus; `near`: that of an incompressible one. By secants."""
    law = inflation.mooney_rivlin(A10, A01, bulk_modulus)

    def excess(radius):
        return inflation.pressure_for(law, INNER, OUTER, radius * INNER, shape == "thick_sphere") - pressure

    before, now = near, near * 1.0005
    excess_before, excess_now = excess(before), excess(now)
    while abs(now - before) > 1e-9:
        before, now = now, now - excess_now * (now - before) / (excess_now - excess_before)
        excess_before, excess_now = excess_now, excess(now)
    return now


def rows(options, reference):
    cases = [(2, 5000, True), (4, 5000, True), (8, 5000, True), (4, 50, True), (4, 500, True), (4, 500, False), (4, 5000, False)]
    for shape in SHAPES:
        case = SHAPES[shape][3]
        for n, ratio, is_mixed in cases if not options.quick else [(4, 5000, True)]:
            if shape == "thick_sphere" and n == 8:
                n = 6
            found, folder, name = solve_case(options, shape, reference, n, ratio, is_mixed)
            for radius, value in zip(RADII, found):
                pressure = reference[SHAPES[shape][2], case.format(a=radius), "inner pressure"] * 1e3
                exact = exact_radius(shape, ratio * SHEAR_MODULUS, pressure, radius)
                # The asked-for accuracy of the incompressible limit, with four elements across the wall.
                band = around(exact, 1e-3) if n >= 4 else None
                yield runs.row(name, f"a/A_at_pressure_of_{radius}", value, exact, "Mooney-Rivlin, shooting in the radius", folder, band,
                               mesh=n, bulk_over_shear=ratio, near_incompressible=is_mixed)
