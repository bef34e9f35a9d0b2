"""Homogeneous states through the whole program: stress from reactions, lateral stretch from a probe."""

import numpy

import stored_runs as runs
from solid_scene import STATIC, around, body, box, mooney_rivlin, probe, saint_venant_kirchhoff, scene, solve, symmetry

LAW = {"MR": mooney_rivlin(2290.0, 250.0, 1e5), "SVK": saint_venant_kirchhoff(15e3, 0.475)}
SOURCE = "closed form"
# Elements reproduce a homogeneous state exactly: what is left is the tolerance of the iteration and the digits of the references (8).
BAND = 1e-6
INTEGRATION = STATIC + "  newton_tolerance: 1e-11"
MESH = box((1, 1, 1), (2, 2, 2))


def stretched(options, law, stretch, is_confined):
    sides = symmetry(x_min="X", y_min="Y", z_min="Z")
    if is_confined:
        sides += "\n    " + symmetry(y_max="Y", z_max="Z")
    motion = f'  prescribed_motion {{ nodes: "x_max"  x: "{stretch - 1!r}*x*t" }}\n'
    name = f"{'confined' if is_confined else 'uniaxial'}-{law}-{stretch}"
    text = scene(name, 1.0, 0.1, body("cube", MESH, LAW[law], sides) + motion, INTEGRATION, probe("corner", (1, 1, 1)))
    history, folder = solve(options, name, text)
    return history["solid.reaction.x_max.x"][-1], 1 + history["corner.y"][-1], folder, name


def sheared(options, law, gamma):
    faces = "".join(f'  prescribed_motion {{ nodes: "{face}"  x: "{gamma!r}*y*t"  y: "0"  z: "0" }}\n'
                    for face in ("y_max", "y_min", "x_min", "x_max", "z_min", "z_max"))
    name = f"shear-{law}-{gamma}"
    history, folder = solve(options, name, scene(name, 1.0, 0.1, body("cube", MESH, LAW[law]) + faces, INTEGRATION, probe("top", (1, 1, 1))))
    return history["solid.reaction.y_max.x"][-1], folder, name


def rows(options, reference):
    stretches = {"MR": (0.8, 1.5, 2.0), "SVK": (0.8, 1.2, 1.5)} if not options.quick else {"MR": (1.5,), "SVK": (1.2,)}
    for law, values in stretches.items():
        for stretch in values:
            stress, lateral, folder, name = stretched(options, law, stretch, False)
            expected = reference[f"uniaxial_{law}", f"stretch {stretch:g}", "nominal stress P11"] * 1e3
            yield runs.row(name, "P11", stress, expected, SOURCE, folder, around(expected, BAND))
            expected = reference[f"uniaxial_{law}", f"stretch {stretch:g}", "lateral stretch"]
            yield runs.row(name, "lateral_stretch", lateral, expected, SOURCE, folder, around(expected, BAND))
        stress, _, folder, name = stretched(options, law, 1.2, True)
        expected = reference[f"confined_{law}", "stretch 1.2", "P11"] * 1e3
        yield runs.row(name, "P11", stress, expected, SOURCE, folder, around(expected, BAND))
        stress, folder, name = sheared(options, law, 0.5)
        expected = reference[f"simple_shear_{law}", "gamma 0.5", "P12"] * 1e3
        yield runs.row(name, "P12", stress, expected, SOURCE, folder, around(expected, BAND))
