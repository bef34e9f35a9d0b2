#!/usr/bin/python3
"""Wrong input of a solid alone: the promised exit code, one line that says where, what and what to do, and what was computed so far."""

import csv
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py

SOLID_SERVER = os.environ["SOLID_SERVER"]
SCENE, NUMERICS, FILE = 2, 3, 5  # exit codes
DEADLINE = 60  # [s] for one run on a busy machine; usually 0.1

SOFT = "material { density: 1000 neo_hookean { shear_modulus: 4e3 bulk_modulus: 2e4 } }"
KIRCHHOFF = "material { density: 1000 saint_venant_kirchhoff { young_modulus: 1e4 poisson_ratio: 0.3 } }"
BOX = "box { length { x: 0.01 y: 0.01 z: 0.01 } elements_x: 2 elements_y: 2 elements_z: 2 }"
IMPLICIT = "time_integration { method: GENERALIZED_ALPHA }"
STATIC = "time_integration { method: STATIC }"
EVERY_METHOD = {"explicit": "", "implicit": IMPLICIT, "static": STATIC}

GOOD_INP = """*NODE
1,0,0,0
2,1,0,0
3,1,1,0
4,0,1,0
5,0,0,1
6,1,0,1
7,1,1,1
8,0,1,1
9,2,0,0
10,2,1,0
11,2,0,1
12,2,1,1
*ELEMENT, TYPE=C3D8, ELSET=A
1,1,2,3,4,5,6,7,8
2,2,9,10,3,6,11,12,7
*NSET,NSET=LEFT
1,4,5,8
"""


def scene(body=BOX + SOFT + 'fixed: "x_min"', acting="", step=1e-4, end=1e-3, output=""):
    """A body named b and what acts on it."""
    bodies = body if body.startswith("body") else f'body {{ name: "b" {body} }}'
    return f'title: "t"\ntime {{ end: {end} step: {step} }}\nsolid {{\n{bodies}\n{acting}\n}}\n{output}\n'


def pressure(value, surface="x_max", start=0.0, end=1e-3):
    return (f'pressure {{ surface: "{surface}" value {{ row {{ time: {start} value: 0 }} '
            f'row {{ time: {end} value: {value} }} }} }}')


def moved(formula, axis="x"):
    return f'prescribed_motion {{ nodes: "x_max" {axis}: "{formula}" }}'


class SolidCase(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="couplet solid ")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def run_solid(self, text, verb="run", out="run", more=()):
        path = self.folder / "scene.txtpb"
        path.write_text(text)
        command = [SOLID_SERVER, verb, str(path), *more]
        if verb == "run":
            command += ["--out", str(self.folder / out), "--quiet", "--threads", "1"]
        return subprocess.run(command, capture_output=True, text=True, timeout=DEADLINE, check=False)

    def expect(self, done, code, *patterns):
        """The code, and one line beside notes and warnings that matches all patterns."""
        lines = [line for line in done.stderr.splitlines() if "warning:" not in line and "time integration:" not in line]
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(len(lines), 1, done.stderr)
        for pattern in patterns:
            self.assertRegex(lines[0], pattern)
        self.assertIn("; ", lines[0], "what to do next")

    def summary(self, out="run"):
        return json.loads((self.folder / out / "summary.json").read_text())

    def history(self, out="run"):
        with open(self.folder / out / "history.csv", encoding="utf-8") as file:
            return list(csv.reader(file))


class RefusedScenes(SolidCase):
    def refuse(self, text, *patterns, code=SCENE):
        for verb in ("check", "run"):
            with self.subTest(verb=verb):
                self.expect(self.run_solid(text, verb), code, *patterns)
        self.assertFalse((self.folder / "run" / "results").exists() and any((self.folder / "run" / "results").iterdir()))

    def test_meshes_that_cannot_be_read(self):
        swapped = GOOD_INP.replace("1,1,2,3,4,5,6,7,8", "1,5,6,7,8,1,2,3,4")
        folded = GOOD_INP.replace("1,1,2,3,4,5,6,7,8", "1,1,2,4,3,5,6,7,8")
        apart = (GOOD_INP.replace("2,2,9,10,3,6,11,12,7", "2,13,9,10,14,15,11,12,16")
                 .replace("12,2,1,1\n", "12,2,1,1\n13,1,0,0\n14,1,1,0\n15,1,0,1\n16,1,1,1\n"))
        for name, content, patterns in (
                ("empty.msh", b"", (r"empty\.msh:1: the file is empty", "saved by Gmsh")),
                ("binary.msh", bytes(range(256)) * 8, (r"binary\.msh:1: this is not a Gmsh mesh",)),
                ("empty.inp", b"", (r"empty\.inp:1: this is not an input file of Abaqus",)),
                ("binary.inp", bytes(range(256)) * 8, (r"binary\.inp:\d+: this is not an input file",)),
                ("mesh.vtk", b"# vtk", (r"mesh\.vtk: meshes with the ending", r"\.msh file")),
                ("swapped.inp", swapped.encode(), (r"element 1 \(.*swapped\.inp, line 15\)", "wrong order")),
                ("folded.inp", folded.encode(), (r"element 1 \(.*line 15\)", "folded")),
                ("apart.inp", apart.encode(), (r"4 nodes stand at the place of another one", r"\(1, 0, 0\) m", "merge"))):
            with self.subTest(name):
                (self.folder / name).write_bytes(content)
                body = f'mesh_file {{ file: "{name}" }} {SOFT} fixed: "LEFT"'
                self.refuse(scene(body), *patterns)

    def test_names_that_the_mesh_does_not_have(self):
        (self.folder / "good.inp").write_text(GOOD_INP)
        mesh = 'mesh_file { file: "good.inp" }'
        self.refuse(scene(f'{mesh} {SOFT} fixed: "LEFFT"'), r"solid\.body\[0\]\.fixed\[0\]: the mesh has no .*\"LEFFT\"", "LEFT")
        self.refuse(scene(f'{mesh} fixed: "LEFT" region {{ name: "cover" {SOFT} }}'), 'region "A" of the mesh has no material')
        other = f'body {{ name: "a" {BOX} {SOFT} }} body {{ name: "b" {mesh} {SOFT} fixed: "LEFFT" }}'
        self.refuse(scene(other), r"solid\.body\[1\]\.fixed\[0\]: the mesh has no .*\"LEFFT\"")

    def test_more_elements_than_fit(self):
        for mesh, word in (
                ("box { length { x: 1 y: 1 z: 1 } elements_x: 1000 elements_y: 1000 elements_z: 1000 }", "box"),
                ("ball { radius: 1 elements: 1000 }", "ball"),
                ("annulus { inner_radius: 1 outer_radius: 2 length: 1 elements_radial: 1000 elements_around: 10000 elements_along: 9000 }",
                 "annulus"),
                ("valve { elements_u: 1000 elements_v: 1000 elements_t: 100 }", "valve"),
                ("vocal_fold { medial_thickness: 2e-3 elements_x: 1000 elements_y: 1000 elements_z: 1000 }", "vocal_fold"),
                ("hollow_sphere { inner_radius: 1 outer_radius: 2 elements_radial: 1000 elements_around: 1000 }", "hollow_sphere"),
                ("arch { span: 1 rise: 0.1 thickness: 0.1 width: 1 elements_x: 10000 elements_y: 100 elements_z: 1000 }", "arch")):
            with self.subTest(word):
                self.refuse(scene(mesh + SOFT), rf"solid\.body\[0\]\.{word}: \S+ elements are more than the \d+ million", "fewer elements")

    def test_steps_without_end(self):
        self.refuse(scene(step=1e9, end=1e9), r"time\.step: 1e\+09 s takes \S+ substeps of \S+ s", "GENERALIZED_ALPHA")
        self.refuse(scene(acting='rigid_plane { y: 0.011 stiffness: 1e30 surface: "y_max" }'), "substeps", "stiffness of contact")
        self.refuse(scene(acting="time_integration { method: GENERALIZED_ALPHA largest_substep: 1e-15 }"), "substeps")

    def test_values_that_are_no_numbers(self):
        self.refuse(scene(acting='kick { time: 0 velocity { x: "1/0" } }'), r"solid\.kick\[0\]\.velocity: the formulas give \(inf, 0, 0\) m/s at \(0, 0, 0\) m")
        self.refuse(scene(acting='kick { time: 0 velocity { y: "sqrt(x-0.005)" } }'), r"solid\.kick\[0\]\.velocity: .*nan")

    def test_a_body_that_cannot_move(self):
        held = 'box { length { x: 1 y: 1 z: 1 } } ' + SOFT + ' fixed: ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"]'
        for method in EVERY_METHOD.values():
            self.refuse(scene(held, acting=method), "no node of any body is free to move", "fix fewer surfaces")

    def test_a_leaflet_without_thickness(self):
        self.refuse(scene("valve { thickness: 0 elements_u: 6 elements_v: 4 }" + SOFT), r"valve\.thickness: 0 is not above 0")


class FailingRuns(SolidCase):
    def test_loads_that_turn_elements_inside_out(self):
        for name, method in EVERY_METHOD.items():
            for material in (SOFT, KIRCHHOFF):
                with self.subTest(name, material=material[29:40]):
                    done = self.run_solid(scene(BOX + material + 'fixed: "x_min"', pressure(1e9) + method), out=name + material[29:32])
                    # No element of soft tissue inverts before its equilibria end; everything else is told by its element.
                    ends = "no equilibrium is found" if (name, material) == ("static", SOFT) else r"element \d+ at \("
                    self.expect(done, NUMERICS, r"solid, t = \S+( to \S+)? s: ", ends)

    def test_a_motion_that_tears_a_body(self):
        for name, method in EVERY_METHOD.items():
            with self.subTest(name):
                self.expect(self.run_solid(scene(acting=moved("-1e3*t") + method), out=name), NUMERICS, r"solid, t = ", r"element \d+ at \(")

    def test_motions_that_are_no_numbers(self):
        for name, method in EVERY_METHOD.items():
            for formula, value in (("sqrt(-1-t)", "-?nan"), ("0.001*(sqrt(5e-4)-sqrt(5e-4-t))", "-?nan"), ("1/(0*t)", "-?(nan|inf)")):
                with self.subTest(name, formula=formula):
                    done = self.run_solid(scene(acting=moved(formula) + method), out=name + value + formula[:3])
                    self.expect(done, NUMERICS, rf"solid\.prescribed_motion \"x_max\", t = \S+ s: the formula of x gives {value} at \(0\.01, 0, 0\) m")

    def test_supports_that_leave_a_body_free(self):
        body = BOX + SOFT + 'symmetry { surface: "x_min" normal: X }'
        load = 'traction { surface: "x_max" value { direction { y: 1 } value { row { time: 0 value: 1 } } } }'
        self.expect(self.run_solid(scene(body, load + STATIC)), SCENE, "the body can shift along y and z and turn about x as a whole", "hold it by fixed")

    def test_what_was_computed_before_a_failure_stays_and_can_be_resumed(self):
        output = "output { results_interval: 1e-4 checkpoints { every_steps: 1 } }"
        text = scene(acting=pressure(1e8, start=5e-4, end=6e-4), output=output)
        self.expect(self.run_solid(text), NUMERICS, r"solid, t = 0\.000[56]\d* to 0\.000[67]\d* s: element \d+ at \(")
        summary = self.summary()
        self.assertEqual(summary["status"], "failed")
        self.assertIn("turned inside out", summary["failure"])
        self.assertGreaterEqual(summary["steps"], 5)
        self.assertEqual(len(self.history()), 1 + summary["steps"])
        with h5py.File(self.folder / "run" / "results" / "b.h5") as file:
            self.assertEqual(int(file["n_states"][()].ravel()[0]), 1 + summary["steps"])
        milder = scene(acting=pressure(10, start=5e-4, end=6e-4), output=output)
        done = self.run_solid(milder, out="again", more=("--resume", str(self.folder / "run" / "checkpoint" / "step-0000000005")))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(self.history("again")), 11)

    def test_a_checkpoint_of_another_mesh_is_refused(self):
        output = "output { checkpoints { every_steps: 1 } }"
        self.assertEqual(self.run_solid(scene(output=output), more=("--steps", "1")).returncode, 0)
        other = scene(BOX.replace("elements_x: 2", "elements_x: 3") + SOFT + 'fixed: "x_min"', output=output)
        done = self.run_solid(other, out="other", more=("--resume", str(self.folder / "run")))
        self.expect(done, FILE, "holds 81 nodes, but the body has 111", "resume with the scene")


class Warnings(SolidCase):
    def test_loss_of_stiffness_is_told_once_and_counted(self):
        body = BOX + KIRCHHOFF + 'fixed: "x_min" mass_damping: 2000'
        for name, method in (("explicit", ""), ("implicit", IMPLICIT)):  # an equilibrium ends there: it is not stable
            with self.subTest(name):
                done = self.run_solid(scene(body, moved("-5*t") + method, step=5e-5), out=name, more=("--steps", "6"))
                warnings = [line for line in done.stderr.splitlines() if "warning:" in line]
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual(len(warnings), 1, done.stderr)
                self.assertRegex(warnings[0], r"t = 0\.000\d+ s: element \d+ at \(.*\) m is compressed so much that saint_venant_kirchhoff")
                rows = self.history(name)
                counts = [float(row[[c.split(" ")[0] for c in rows[0]].index("solid.softened_elements")]) for row in rows[1:]]
                self.assertEqual(counts[0], 0)
                self.assertGreater(counts[-1], 0)
                told = float(warnings[0].split("t = ")[1].split(" ")[0])
                first = next(float(row[0]) for row, count in zip(rows[1:], counts) if count > 0)
                self.assertAlmostEqual(told, first, places=7)

    def test_other_laws_have_no_such_column(self):
        self.assertEqual(self.run_solid(scene(acting=pressure(10))).returncode, 0)
        self.assertFalse(any("softened" in name for name in self.history()[0]))

    def test_a_body_beyond_a_plane_at_rest(self):
        done = self.run_solid(scene(acting='rigid_plane { y: 0.0099 stiffness: 1e6 surface: "y_max" }'))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stderr, r"warning: t = 0 s: a body stands beyond a rigid plane at rest and is pushed back with 0\.01 N; move the plane")

    def test_the_summary_says_why_a_method_was_chosen(self):
        stiff = "material { density: 1000 neo_hookean { shear_modulus: 1e9 bulk_modulus: 2e9 } }"
        for material, step, method in ((SOFT, 1e-5, "CENTRAL_DIFFERENCE"), (stiff, 5e-4, "GENERALIZED_ALPHA")):
            with self.subTest(method):
                slender = "box { length { x: 0.1 y: 0.002 z: 0.002 } elements_x: 8 }"
                body = slender + material + 'fixed: "x_min"'
                done = self.run_solid(scene(body, "time_integration { method: AUTO }", step=step, end=4 * step), out=method)
                self.assertEqual(done.returncode, 0, done.stderr)
                reason = self.summary(method)["programs"]["solid-server"]["time_integration"]
                self.assertTrue(reason.startswith(method + ", because "), reason)
                self.assertIn(reason, done.stderr)


if __name__ == "__main__":
    sys.exit(unittest.main(verbosity=2))
