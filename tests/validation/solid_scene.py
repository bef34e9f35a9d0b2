"""Scenes of a solid as text: the parts that validations of the solid share."""

from pathlib import Path

import stored_runs as runs

STATIC = "method: STATIC"


def saint_venant_kirchhoff(young_modulus, poisson_ratio, density=1000):
    return f"density: {density}  saint_venant_kirchhoff {{ young_modulus: {young_modulus!r}  poisson_ratio: {poisson_ratio!r} }}"


def mooney_rivlin(a10, a01, bulk_modulus, density=1000):
    return f"density: {density}  mooney_rivlin {{ a10: {a10!r}  a01: {a01!r}  bulk_modulus: {bulk_modulus!r} }}"


def neo_hookean(young_modulus, poisson_ratio, density):
    """By the constants of linear elasticity."""
    shear_modulus = young_modulus / (2 * (1 + poisson_ratio))
    bulk_modulus = young_modulus / (3 * (1 - 2 * poisson_ratio))
    return f"density: {density}  neo_hookean {{ shear_modulus: {shear_modulus!r}  bulk_modulus: {bulk_modulus!r} }}"


def box(length, elements):
    return (f"box {{ length {vector(length)}  " + "  ".join(f"elements_{axis}: {n}" for axis, n in zip("xyz", elements)) + " }")


def vector(v):
    return f"{{ x: {float(v[0])!r}  y: {float(v[1])!r}  z: {float(v[2])!r} }}"


def symmetry(**normal_of):
    """symmetry(x_min="X"): the surface keeps its place along that axis."""
    return "\n    ".join(f'symmetry {{ surface: "{surface}"  normal: {axis} }}' for surface, axis in normal_of.items())


def body(name, mesh, material, *extra):
    lines = "\n    ".join((mesh, f"material {{ {material} }}", *extra))
    return f'  body {{\n    name: "{name}"\n    {lines}\n  }}\n'


def ramp(value, end=1.0):
    """A time table from zero."""
    return f"value {{ row {{ time: 0  value: 0 }}  row {{ time: {end}  value: {value!r} }} }}"


def constant(value):
    return f"value {{ row {{ time: 0  value: {value!r} }} }}"


def probe(name, position):
    return f'  probe {{ name: "{name}"  at {{ position {vector(position)} }} }}\n'


def scene(title, end, step, solid, time_integration="", output=""):
    """`solid`: bodies, loads, contact. Fields are written as scenes write them."""
    integration = f"  time_integration {{ {time_integration} }}\n" if time_integration else ""
    return (f'title: "{title}"\ntime {{ end: {end!r}  step: {step!r} }}\nsolid {{\n{solid}{integration}}}\n'
            f"output {{\n{output}}}\n")


def solve(options, name, text, settings=()):
    """Runs a scene that has to succeed; its history and folder."""
    folder = Path(options.out).resolve() / name
    code = runs.run_text(options.couplet, text, folder, [*settings, *options.set])
    if code != 0:
        raise RuntimeError(f"{name}: exit code {code}: {runs.last_words(folder)}")
    print(f"  {name} done", flush=True)
    return runs.read_history(folder), folder


def around(value, share):
    """The band of a relative deviation."""
    return tuple(sorted((value * (1 - share), value * (1 + share))))
