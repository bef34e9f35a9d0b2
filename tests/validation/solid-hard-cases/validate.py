#!/usr/bin/python3
"""Hard cases of the solid that must hold: nearly incompressible bending, thin leaflets, a pressed fold, long steps, restart, inverted elements (estimated: half an hour; --quick 10 minutes)."""

import subprocess
import sys
from pathlib import Path

import h5py
import numpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import stored_runs as runs  # noqa: E402
from solid_scene import STATIC, around, body, box, constant, neo_hookean, probe, ramp, saint_venant_kirchhoff, scene, solve  # noqa: E402


def energies(history):
    return history["solid.kinetic_energy"] + history["solid.strain_energy"] + history["solid.contact_energy"]


def bending_rows(options):
    """A cantilever of Poisson ratio 0.4999 under its end load, beside one of 0.49 on a fine mesh, whose bending stiffness is 1.0066 times less."""
    shear = f'  traction {{ surface: "x_max"  value {{ direction {{ z: 1 }}  {ramp(10.0)} }} }}\n'

    def deflection(name, elements, poisson_ratio, *extra):
        solid = body("beam", box((0.1, 0.01, 0.01), elements), neo_hookean(15e3, poisson_ratio, 1040), 'fixed: "x_min"', *extra)
        history, folder = solve(options, name, scene(name, 1.0, 0.25, solid + shear, STATIC, probe("tip", (0.1, 0.005, 0.01))))
        return history["tip.z"][-1], folder

    fine, _ = deflection("bending-0.4999-24x4x4", (24, 4, 4), 0.4999, "near_incompressible: true")
    for elements in ((6, 1, 1), (12, 2, 2), (24, 4, 4)):
        for mixed in (True, False):
            name = f"bending-0.4999-{'x'.join(map(str, elements))}" + ("" if mixed else "-standard")
            value, folder = deflection(name, elements, 0.4999, *(["near_incompressible: true"] if mixed else []))
            band = (0.99 * fine, 1.01 * fine) if mixed and elements[0] == 12 else None
            yield runs.row(name, "tip_deflection", value, fine, "finest mesh with near_incompressible", folder, band, mesh="x".join(map(str, elements)))


VALVE = """  body {{
    name: "valve"
    valve {{ thickness: {thickness!r}  elements_u: {n}  elements_v: {m} }}
    material {{ {material} }}
    fixed: "base"
    mass_damping: 6667
  }}
  pressure {{ surface: "ventricular"  value {{ row {{ time: 0  value: 0 }} row {{ time: 0.01  value: {opening} }} row {{ time: 0.04  value: {opening} }}
    row {{ time: 0.06  value: {closing} }} row {{ time: 1  value: {closing} }} interpolation: COSINE }} }}
  contact {{ first: "contact_1"  second: "contact_2"  distance: 1e-4 }}
  contact {{ first: "contact_2"  second: "contact_3"  distance: 1e-4 }}
  contact {{ first: "contact_3"  second: "contact_1"  distance: 1e-4 }}
  orifice {{ name: "orifice_area"  surface: "ventricular"  surface: "aortic"  axis: X  radius: 0.0105 }}
"""


def leaflet_rows(options):
    """Pressures of the structure-only valve in proportion to the thickness, 0.05 mm of 0.3 mm, and its damping: the same motion as a membrane."""
    thickness = 0.05e-3
    for method in ("CENTRAL_DIFFERENCE", "GENERALIZED_ALPHA"):
        # Leaflets that meet at 2 m/s, with a contact 0.125 mm deep, cut implicit steps to 8 us: thousands of them.
        if options.quick and method == "GENERALIZED_ALPHA":
            continue
        n, m = 12, 10
        name = f"thin_leaflets-{n}x{m}-{method.lower()}"
        solid = VALVE.format(thickness=thickness, n=n, m=m, material=saint_venant_kirchhoff(1.5e6, 0.4), opening=533 / 6, closing=-12670 / 6)
        history, folder = solve(options, name, scene(name, 0.07, 1e-3, solid, f"method: {method}", "  results_interval: 5e-3\n"))
        area = history["orifice_area"]
        open_area = numpy.pi * 0.0105**2
        varied = {"mesh": f"{n}x{m}", "method": method, "substeps": history["solid.substeps"].sum()}
        yield runs.row(name, "largest_open_share", area.max() / open_area, None, "opens", folder, (0.5, 1), **varied)
        yield runs.row(name, "open_share_at_the_end", area[-1] / open_area, 0, "closed but for the contact distance", folder, (0, 0.05), **varied)
        yield runs.row(name, "smallest_distance", history["solid.contact_distance"].min(), None, "m, of leaflets: not inside each other", folder, (0, 1e-4), **varied)
        yield runs.row(name, "largest_energy", energies(history).max(), None, "J, bounded", folder, **varied)


FOLD = """  body {{
    name: "fold"
    vocal_fold {{ medial_thickness: 1.75e-3  elements_x: 6  elements_y: 9  elements_z: 12  half_length: true }}
    material {{ density: 1040  mooney_rivlin {{ a10: 2290  a01: 250  bulk_modulus: 1e5 }} }}
    fixed: "lateral"
    fixed: "anterior"
    symmetry {{ surface: "posterior"  normal: Z }}
    wetted: "inferior"  wetted: "medial"  wetted: "superior"
    mass_damping: {damping}
  }}
  rigid_plane {{ y: 0.0101  stiffness: 1e8 }}
  traction {{ surface: "medial"  value {{ direction {{ y: 1 }}  {load} }} }}
"""
# A pressure from below pushes the fold open; what presses it flat is a load towards the plane: five times 1 kPa.
PLANE, PENALTY, PRESSING = 0.0101, 1e8, 5000.0


def medial_depths(folder):
    """How far the nodes of the medial surface that are free to move are beyond the plane in the last stored state [m]."""
    with h5py.File(folder / "results" / "fold.h5") as file:
        last = int(file["n_states"][0]) - 1
        rest = file["mesh/position"][:]
        y = rest[:, 1] + file[f"state/{last}/displacement"][:, 1]
    is_medial = (rest[:, 1] > rest[:, 1].max() - 1e-6) & (rest[:, 2] > 1e-6)  # the anterior end is fixed
    return y[is_medial] - PLANE


def fold_rows(options):
    """A fold pressed flat onto the plane of its smallest gap: all of its medial surface touches."""
    forces = {}
    for method, end, step in (("CENTRAL_DIFFERENCE", 0.05, 5e-4), ("GENERALIZED_ALPHA", 0.05, 5e-4), ("STATIC", 1.0, 0.05)):
        name = f"pressed_fold-{method.lower()}"
        text = scene(name, end, step, FOLD.format(damping=300, load=ramp(PRESSING, 0.4 * end)), f"method: {method}", f"  results_interval: {end}\n")
        history, folder = solve(options, name, text)
        depths = medial_depths(folder)
        forces[method] = history["solid.contact_force"][-1]
        varied = {"method": method, "substeps": history["solid.substeps"].sum()}
        yield runs.row(name, "share_pressed_flat", (depths > 0).mean(), 1, "nodes of the medial surface", folder, (1, 1), **varied)
        # Tissue beside the surface carries some of the load at its borders: mean and largest depth differ.
        yield runs.row(name, "largest_depth", depths.max(), PRESSING / PENALTY, "load over penalty", folder, (0.5 * PRESSING / PENALTY, 1.5 * PRESSING / PENALTY), **varied)
        # The same equilibrium by three methods; what is left of the motion after 30 ms of damping is 1e-4 of it.
        yield runs.row(name, "contact_force", forces[method], forces["CENTRAL_DIFFERENCE"], "N, explicit", folder, around(forces["CENTRAL_DIFFERENCE"], 1e-3), **varied)


def long_step_rows(options):
    """A bending column with implicit steps a hundred times the stable one of the explicit method."""
    def run(name, step, integration):
        solid = body("column", box((1, 6, 1), (4, 24, 4)), neo_hookean(17e6, 0.45, 1100), 'fixed: "y_min"')
        return solve(options, name, scene(name, 1.0, step, solid + '  kick { time: 0  velocity { x: "10*y/6" } }\n', integration, probe("corner", (1, 6, 1))))

    reference, _ = run("long_steps-explicit", 0.0025, "")
    stable = 0.0025 / reference["solid.substeps"][0]
    for factor in (10, 100):
        step = 1.0 / round(1.0 / (factor * stable))
        history, folder = run(f"long_steps-{factor}x", step, "method: GENERALIZED_ALPHA")
        total = energies(history)
        varied = {"dt": step, "stable_step": stable, "newton_iterations": history["solid.newton_iterations"].mean(), "substeps": history["solid.substeps"].sum()}
        yield runs.row(f"long_steps-{factor}x", "corner_x_at_end", history["corner.x"][-1], reference["corner.x"][-1], "explicit", folder, **varied)
        yield runs.row(f"long_steps-{factor}x", "energy_growth", total.max() / total[0], 1, "bounded", folder, (0, 1.01), **varied)


def last_state(folder):
    with h5py.File(sorted((folder / "checkpoint").glob("step-*/alone.h5"))[-1]) as file:
        return {name: file[name][()] for name in ("displacement", "velocity", "force") if name in file}


def restart_rows(options):
    """A fold stopped and resumed while it is pressed on the plane: the same bits as without."""
    for method in ("CENTRAL_DIFFERENCE", "GENERALIZED_ALPHA", "STATIC"):
        name = f"restart-{method.lower()}"
        text = scene(name, 0.02, 5e-4, FOLD.format(damping=300, load=ramp(PRESSING, 0.008)), f"method: {method}",
                     probe("middle", (0.012, 0.01, 0.01)) + "  checkpoints { every_steps: 20 }\n")
        history, folder = solve(options, name, text)
        half = folder.with_name(name + "-half")
        scene_file = folder.with_name(folder.name + ".txtpb")
        resumed = folder.with_name(name + "-resumed")
        for target, extra in ((half, ["--steps", "20"]), (resumed, ["--resume", str(half)])):
            subprocess.run(["rm", "-rf", str(target)], check=True)
            done = subprocess.run([options.couplet, "run", str(scene_file), "--out", str(target), "--quiet", "--no-report", *extra], capture_output=True, text=True)
            if done.returncode != 0:
                raise RuntimeError(f"{name}: exit code {done.returncode}: {(done.stdout + done.stderr).strip().splitlines()[-1]}")
        whole, again = last_state(folder), last_state(resumed)
        difference = sum(int((whole[field] != again[field]).sum()) for field in whole)
        at_restart = runs.read_history(half)["solid.contact_force"][-1]
        yield runs.row(name, "different_numbers", difference, 0, f"bits of {', '.join(whole)}", folder, (0, 0), method=method)
        yield runs.row(name, "contact_force_at_restart", at_restart, None, "N, in the middle of contact", folder, (1e-6, 10), method=method)


def inverted_rows(options):
    """A column whose end is driven through its root: exit code 3, a sentence with element and time, the last good state on disk."""
    for method in ("CENTRAL_DIFFERENCE", "GENERALIZED_ALPHA", "STATIC"):
        name = f"inverted-{method.lower()}"
        folder = Path(options.out).resolve() / name
        # The end passes the middle of the column at t = 0.05 s.
        motion = '  prescribed_motion { nodes: "y_max"  x: "0"  y: "-15*t"  z: "0" }\n'
        solid = body("column", box((1, 1, 1), (2, 2, 2)), saint_venant_kirchhoff(17e6, 0.3, 1100), 'fixed: "y_min"') + motion
        text = scene(name, 0.1, 1e-3, solid, f"method: {method}", "  results_interval: 1e-3\n  checkpoints { every_steps: 5 }\n")
        code = runs.run_text(options.couplet, text, folder, options.set)
        words = runs.last_words(folder)
        print(f"  {name}: {words}", flush=True)
        history = runs.read_history(folder)
        states = sorted((folder / "checkpoint").glob("step-*/complete"))
        yield runs.row(name, "exit_code", code, 3, "a numerical failure", folder, (3, 3), method=method)
        # In equilibrium the column loses its stability before an element turns: there is no element to name.
        parts = ("t = ", "lower") if method == "STATIC" else ("t = ", "lower", "element ")
        named = sum(part in words for part in parts)
        yield runs.row(name, "parts_of_the_sentence", named, len(parts), "time, advice, element", folder, (len(parts),) * 2, method=method, sentence=words)
        yield runs.row(name, "last_time", history["time"][-1], None, "s, of the history", folder, (1e-3, 0.1), method=method)
        yield runs.row(name, "checkpoints", len(states), None, "the last good states", folder, (1, 2), method=method)


CASES = {"bending": bending_rows, "thin_leaflets": leaflet_rows, "pressed_fold": fold_rows, "long_steps": long_step_rows, "restart": restart_rows,
         "inverted": inverted_rows}


def main():
    parser = runs.arguments(__doc__, "solid-hard-cases")
    parser.add_argument("--quick", action="store_true", help="leaflets explicit only")
    options = parser.parse_args()
    return runs.report_cases({name: (lambda case=case: case(options)) for name, case in CASES.items() if not options.only or name in options.only},
                             options.json)


if __name__ == "__main__":
    sys.exit(main())
