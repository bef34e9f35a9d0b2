"""What a scene says about its solid, in words and as loads over time."""

import ast
import math

import numpy

from scene_text import find

UNITS = {"young_modulus": " Pa", "shear_modulus": " Pa", "bulk_modulus": " Pa", "matrix_shear_modulus": " Pa", "a10": " Pa", "a01": " Pa",
         "k1": " Pa", "c0": " Pa", "fibre_angle": "°"}
LAWS = {"saint_venant_kirchhoff": "Saint Venant-Kirchhoff", "mooney_rivlin": "Mooney-Rivlin", "neo_hookean": "neo-Hookean",
        "holzapfel_gasser_ogden": "Holzapfel-Gasser-Ogden", "may_newman": "May-Newman"}
MESHES = ("vocal_fold", "box", "mesh_file", "valve", "annulus", "hollow_sphere", "ball", "cylinder_beam", "arch")
LOADS = (("pressure", "surface", "Pa"), ("traction", "surface", "Pa"), ("node_force", "nodes", "N"))
METHODS = {"CENTRAL_DIFFERENCE": "central difference", "GENERALIZED_ALPHA": "generalized alpha", "STATIC": "static equilibrium at every step",
           "AUTO": "central difference or generalized alpha, whichever costs less"}


def solid_of(scene):
    return find(scene, "solid", {})


def method(scene):
    """Time integration method by its name in the scene language."""
    return find(scene, "solid.time_integration.method", "CENTRAL_DIFFERENCE")


def facts(scene):
    """Rows (what, words) about bodies, loads, contact and time integration."""
    solid = solid_of(scene)
    bodies = solid.get("body", [])
    for body in bodies:
        of = f" of {find(body, 'name', '')}" if len(bodies) > 1 else ""
        if len(bodies) == 1:
            yield "body", str(find(body, "name", ""))
        yield "mesh" + of, _mesh(body)
        yield "material" + of, (_material(find(body, "material", {})) + _fibres(find(body, "fibres"))) or None
        for region in body.get("region", []):
            yield f"material of region {find(region, 'name')}{of}", _material(find(region, "material", {})) + _fibres(find(region, "fibres"))
        yield "supports" + of, _supports(body)
        yield "damping" + of, _damping(body)
    for place, words in _loads(solid):
        yield place, words
    for contact in solid.get("contact", []):
        other = find(contact, "second")
        yield "contact", (f"{find(contact, 'first')} with {other or 'itself'}" + _if(", within {}", _length(find(contact, "distance")))
                          + _if(", stiffness {:g} Pa/m", find(contact, "stiffness")))
    for plane in solid.get("rigid_plane", []):
        yield "rigid plane", _plane(plane)
    if solid.get("settling"):
        yield "settling", f"mass damping {find(solid, 'settling.mass_damping'):g} 1/s until {find(solid, 'settling.until'):g} s"
    for kick in solid.get("kick", []):
        yield "kick", f"at {find(kick, 'time'):g} s, velocity {_formulas(find(kick, 'velocity', {}))} m/s"
    if solid:
        yield "time integration", _time_integration(find(solid, "time_integration", {}), scene)


def _if(words, value):
    """Words about a value, or nothing where it is absent or zero."""
    return words.format(value) if value else ""


def _length(value):
    """A length in the unit in which one says it."""
    if not value:
        return ""
    return f"{value:g} m" if abs(value) >= 0.1 else f"{1e3 * value:g} mm"


def _vector(message):
    return "(" + ", ".join(f"{find(message or {}, axis, 0):g}" for axis in "xyz") + ")"


def _elements(mesh, *names):
    return " × ".join(str(find(mesh, "elements_" + name, "?")) for name in names) + " elements"


def _mesh(body):
    kind = next((name for name in MESHES if name in body), None)
    if kind is None:
        return "unknown"
    mesh = body[kind][0]
    words = _MESH_WORDS[kind](mesh)
    points = find(body, "points_per_element")
    return words + _if(", {} points each", points) + (", volume ratio averaged" if find(body, "near_incompressible") else "")


def _box(mesh):
    length = find(mesh, "length", {})
    return f"box, {' × '.join(_length(find(length, axis)) for axis in 'xyz')}, {_elements(mesh, *'xyz')}"


def _vocal_fold(mesh):
    half = find(mesh, "half_length")
    n_z = find(mesh, "elements_z")
    counts = " × ".join(str(n) for n in (find(mesh, "elements_x"), find(mesh, "elements_y"), n_z // 2 if half and n_z else n_z))
    return f"vocal fold{', half of the length' if half else ''}, medial thickness {_length(find(mesh, 'medial_thickness'))}, {counts} elements"


def _valve(mesh):
    return (f"three leaflets in a tube, radius {_length(find(mesh, 'tube_radius'))}, height {_length(find(mesh, 'height'))}, "
            f"thickness {_length(find(mesh, 'thickness'))}; of each {find(mesh, 'elements_u')} elements along the free edge, "
            f"{find(mesh, 'elements_v')} up to its middle, {find(mesh, 'elements_t')} through the thickness")


def _annulus(mesh):
    angle = find(mesh, "angle", 360)
    return (f"hollow cylinder, radii {_length(find(mesh, 'inner_radius'))} and {_length(find(mesh, 'outer_radius'))}, "
            f"length {_length(find(mesh, 'length'))}{f', {angle:g}° of it' if angle < 360 else ''}, "
            f"{_elements(mesh, 'radial', 'around', 'along')}")


def _hollow_sphere(mesh):
    return (f"eighth of a hollow sphere, radii {_length(find(mesh, 'inner_radius'))} and {_length(find(mesh, 'outer_radius'))}, "
            f"{find(mesh, 'elements_radial')} elements across the wall, {find(mesh, 'elements_around')} along half an edge")


def _ball(mesh):
    part = {"LOWER_HALF": "lower half of a ball", "UPPER_HALF": "upper half of a ball"}.get(find(mesh, "part"), "ball")
    return f"{part}, radius {_length(find(mesh, 'radius'))}, {find(mesh, 'elements')} elements along half an edge of its cube"


def _cylinder_beam(mesh):
    return (f"beam behind a cylinder, length {_length(find(mesh, 'length'))}, thickness {_length(find(mesh, 'thickness'))}, "
            f"cylinder radius {_length(find(mesh, 'cylinder_radius'))}, {_elements(mesh, *'xy')}")


def _arch(mesh):
    return (f"shallow arch, span {_length(find(mesh, 'span'))}, rise {_length(find(mesh, 'rise'))}, thickness {_length(find(mesh, 'thickness'))}, "
            f"{_elements(mesh, *'xyz')}")


def _mesh_file(mesh):
    unit = find(mesh, "length_unit", 1)
    return f"file {find(mesh, 'file')}" + (f", one unit is {_length(unit)}" if unit != 1 else "")


_MESH_WORDS = {"box": _box, "vocal_fold": _vocal_fold, "valve": _valve, "annulus": _annulus, "hollow_sphere": _hollow_sphere, "ball": _ball,
               "cylinder_beam": _cylinder_beam, "arch": _arch, "mesh_file": _mesh_file}


def _material(material):
    law = next((name for name in material if name != "density"), None)
    if law is None:
        return ""
    constants = ", ".join(f"{name.replace('_', ' ')} {values[0]:g}{UNITS.get(name, '')}" for name, values in material[law][0].items())
    return f"{LAWS.get(law, law.replace('_', ' '))}: {constants}; density {find(material, 'density', math.nan):g} kg/m³"


def _fibres(fibres):
    if not fibres:
        return ""
    if "constant" in fibres:
        return f"; fibres along {_vector(find(fibres, 'constant.along'))}"
    if "circumferential" in fibres:
        return f"; fibres around the axis {_vector(find(fibres, 'circumferential.axis'))}"
    return "; fibres as the mesh says"


def _supports(body):
    parts = [f"{', '.join(body['fixed'])} fixed"] if body.get("fixed") else []
    parts += [f"{find(plane, 'surface')} without motion along {str(find(plane, 'normal')).lower()}" for plane in body.get("symmetry", [])]
    return "; ".join(parts) or None


def _damping(body):
    mass, stiffness = find(body, "mass_damping"), find(body, "stiffness_damping")
    return ", ".join(part for part in (_if("mass {:g} 1/s", mass), _if("stiffness {:g} s", stiffness)) if part) or None


def _plane(plane):
    level = find(plane, "y")
    place = f"y = {_length(level) or '0 m'}" if "y" in plane else \
        f"through {_vector(find(plane, 'plane.point'))} m, normal {_vector(find(plane, 'plane.normal'))}"
    return place + _if(", stiffness {:g} Pa/m", find(plane, "stiffness")) + (f", for {', '.join(plane['surface'])}" if plane.get("surface") else "")


def _formulas(message, axes="xyz"):
    return ", ".join(f"{axis}: {find(message, axis)}" for axis in axes if axis in message and str(find(message, axis)) != "0")


def _table_words(table, unit):
    rows = [(find(row, "time", 0), find(row, "value", 0)) for row in table.get("row", [])]
    values = [value for _, value in rows]
    if min(values) == max(values):
        return f"{values[0]:g} {unit}"
    if len(rows) == 2:
        return f"{values[0]:g} {unit} at {rows[0][0]:g} s to {values[1]:g} {unit} at {rows[1][0]:g} s"
    return f"from {min(values):g} to {max(values):g} {unit}, {len(rows)} rows over time"


def _loads(solid):
    for kind, target, unit in LOADS:
        for load in solid.get(kind, []):
            vector = "direction" in find(load, "value", {})
            table = find(load, "value.value" if vector else "value", {})
            towards = f", towards {_vector(find(load, 'value.direction'))}" if vector else ""
            yield f"{kind.replace('_', ' ')} on {find(load, target)}", _table_words(table, unit) + towards
    if solid.get("gravity"):
        yield "gravity", f"{_table_words(find(solid, 'gravity.value', {}), 'm/s²')}, towards {_vector(find(solid, 'gravity.direction'))}"
    for motion in solid.get("prescribed_motion", []):
        yield f"motion of {find(motion, 'nodes')}", f"{_formulas(motion)} [m]"


def _time_integration(integration, scene):
    name = method(scene)
    words = METHODS.get(name, str(name).lower())
    if name in ("CENTRAL_DIFFERENCE", "AUTO"):
        words += _if(", substeps of {:g} of the stable step", find(integration, "safety"))
    if name in ("GENERALIZED_ALPHA", "AUTO"):
        words += _if(", spectral radius {:g}", find(integration, "spectral_radius"))
    if name == "STATIC" and find(integration, "arc_length"):
        words += ", by arc length through limit points"
    return words + _if(", no substep above {:g} s", find(integration, "largest_substep"))


def table_value(table, time):
    """A time table of the scene at times: held before its first and after its last row."""
    at = numpy.array([float(find(row, "time", 0)) for row in table["row"]])
    value = numpy.array([float(find(row, "value", 0)) for row in table["row"]])
    time = numpy.clip(time, at[0], at[-1])
    if find(table, "interpolation") != "COSINE" or len(at) < 2:
        return numpy.interp(time, at, value)
    k = numpy.clip(numpy.searchsorted(at, time, side="right") - 1, 0, len(at) - 2)
    share = 0.5 - 0.5 * numpy.cos(math.pi * (time - at[k]) / (at[k + 1] - at[k]))
    return value[k] + share * (value[k + 1] - value[k])


def loads_over_time(scene, time):
    """Loads and prescribed motions whose values change: (kind, name, unit, values at the times)."""
    solid = solid_of(scene)
    found = []
    for kind, target, unit in LOADS:
        for load in solid.get(kind, []):
            table = find(load, "value.value" if "direction" in find(load, "value", {}) else "value", {})
            if table.get("row"):
                found.append((kind.replace("_", " "), str(find(load, target)), unit, table_value(table, time)))
    table = find(solid, "gravity.value", {})
    if table.get("row"):
        found.append(("gravity", "gravity", "m/s²", table_value(table, time)))
    for motion in solid.get("prescribed_motion", []):
        for axis in "xyz":
            values = formula_over_time(str(find(motion, axis)), time) if axis in motion else None
            if values is not None:
                found.append(("prescribed motion", f"{find(motion, 'nodes')}, {axis}", "m", values))
    return [entry for entry in found if numpy.ptp(entry[3]) > 0]


FUNCTIONS = {"sin": numpy.sin, "cos": numpy.cos, "tan": numpy.tan, "exp": numpy.exp, "sqrt": numpy.sqrt, "abs": numpy.abs, "tanh": numpy.tanh,
             "min": lambda *values: numpy.minimum.reduce(numpy.broadcast_arrays(*values)),
             "max": lambda *values: numpy.maximum.reduce(numpy.broadcast_arrays(*values))}
OPERATORS = {ast.Add: numpy.add, ast.Sub: numpy.subtract, ast.Mult: numpy.multiply, ast.Div: numpy.divide, ast.Pow: numpy.power}


def formula_over_time(formula, time):
    """A formula of the scene at times; None where it depends on the place or holds what is unknown here."""
    names = {"t": time, "pi": math.pi}

    def value(node):
        if isinstance(node, ast.BinOp):
            return OPERATORS[type(node.op)](value(node.left), value(node.right))
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
            return -value(node.operand) if isinstance(node.op, ast.USub) else value(node.operand)
        if isinstance(node, ast.Call):
            return FUNCTIONS[node.func.id](*[value(argument) for argument in node.args])
        return names[node.id] if isinstance(node, ast.Name) else float(node.value)

    try:
        with numpy.errstate(all="ignore"):
            values = numpy.broadcast_to(value(ast.parse(formula.strip().replace("^", "**"), mode="eval").body), numpy.shape(time))
    except (SyntaxError, KeyError, AttributeError, TypeError, ValueError):
        return None
    return values if numpy.isfinite(values).all() else None
