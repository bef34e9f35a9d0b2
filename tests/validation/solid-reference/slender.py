"""A cantilever with large rotations under end shear, against the Reissner beam."""

import stored_runs as runs
from solid_scene import STATIC, around, body, box, probe, ramp, saint_venant_kirchhoff, scene, solve

LENGTH, WIDTH, HEIGHT, YOUNG_MODULUS = 10.0, 1.0, 0.1, 1.2e6


def end_shear(options, elements, end_load, step, points):
    name = f"shear-P{end_load}-{'x'.join(map(str, elements))}-{points or 'default'}-{step}"
    mesh = box((LENGTH, WIDTH, HEIGHT), elements)
    load = f'  traction {{ surface: "x_max"  value {{ direction {{ z: 1 }}  {ramp(end_load / (WIDTH * HEIGHT))} }} }}\n'
    text = scene(name, 1.0, step, body("beam", mesh, saint_venant_kirchhoff(YOUNG_MODULUS, 0.0), 'fixed: "x_min"',
                                       *([f"points_per_element: {points}"] if points else [])) + load,
                 STATIC, probe("tip", (LENGTH, 0, HEIGHT / 2)))
    history, folder = solve(options, name, text)
    return history, folder, name


def shear_rows(options, reference):
    meshes = [(8, 1, 1), (16, 1, 1), (16, 2, 1), (32, 2, 1), (64, 2, 1)] if not options.quick else [(16, 1, 1), (16, 2, 1)]
    source = "Reissner beam with EA and 5/6 GA"
    cases = [(elements, 4, 0.25, None) for elements in meshes] + [((16, 2, 1), 4, 0.25, 14), ((16, 2, 1), 4, 0.25, 8), ((16, 2, 1), 4, 0.1, None), ((16, 2, 1), 4, 1.0, None)]
    for elements, end_load, step, points in cases:
        history, folder, name = end_shear(options, elements, end_load, step, points)
        varied = {"mesh": "x".join(map(str, elements)), "steps": len(history["time"]), "points": points or "default",
                  "newton_iterations": history["solid.newton_iterations"].sum()}
        # The solid has a finite thickness, h/L = 0.01: its Poisson ratio is 0 and its ends are free to follow, so the beam is its limit.
        band = 0.0005 if elements[0] >= 16 and elements[1] == 2 and not points else None
        for axis, sign, quantity in (("x", -1, "-U_tip"), ("z", 1, "W_tip")):
            expected = reference["cantilever_end_shear", f"P={end_load} Reissner EA,5/6GA", quantity]
            value = sign * history[f"tip.{axis}"][-1]
            yield runs.row(name, quantity, value, expected, source, folder, band and around(expected, band), **varied)
        yield runs.row(name, "newton_iterations", varied["newton_iterations"], 40, "at most; CalculiX 2.20: 72", folder,
                       (0, 40) if step == 0.25 and elements == (16, 2, 1) and not points else None, **varied)


def rows(options, reference):
    yield from shear_rows(options, reference)
