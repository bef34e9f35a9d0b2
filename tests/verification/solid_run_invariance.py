#!/usr/bin/python3
"""Runs of a solid alone: every mesh, law and method ends well; the same numbers on two threads and after an interruption."""

import csv
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy

SOLID_SERVER = os.environ["SOLID_SERVER"]
DEADLINE = 120  # [s] for one run on a busy machine; usually below 1

SOFT = "material { density: 1000 neo_hookean { shear_modulus: 4e3 bulk_modulus: 2e4 } }"
RIVLIN = "material { density: 1000 mooney_rivlin { a10: 2000 a01: 200 bulk_modulus: 5e4 } }"
KIRCHHOFF = "material { density: 1000 saint_venant_kirchhoff { young_modulus: 1e4 poisson_ratio: 0.3 } }"
HOLZAPFEL = ("material { density: 1000 holzapfel_gasser_ogden "
             "{ shear_modulus: 5e3 k1: 2e4 k2: 2 fibre_angle: 30 dispersion: 0.1 bulk_modulus: 1e5 } }")
MAY_NEWMAN = "material { density: 1000 may_newman { c0: 400 c1: 4 c2: 10 matrix_shear_modulus: 2e3 bulk_modulus: 1e5 } }"
BOX = "box { length { x: 0.01 y: 0.01 z: 0.01 } elements_x: 2 elements_y: 2 elements_z: 2 }"
VALVE = "valve { elements_u: 6 elements_v: 4 }"
IMPLICIT = "time_integration { method: GENERALIZED_ALPHA }"
STATIC = "time_integration { method: STATIC }"
AUTO = "time_integration { method: AUTO }"
OUTPUT = "output { results_interval: 1e-4 checkpoints { every_steps: 2 } }"

TETRAHEDRON = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 "foot"
3 2 "body"
$EndPhysicalNames
$Nodes
10
1 0 0 0
2 0.01 0 0
3 0 0.01 0
4 0 0 0.01
5 0.005 0 0
6 0.005 0.005 0
7 0 0.005 0
8 0 0 0.005
9 0 0.005 0.005
10 0.005 0 0.005
$EndNodes
$Elements
2
1 9 2 1 1 1 3 2 7 6 5
2 11 2 2 2 1 2 3 4 5 6 7 8 9 10
$EndElements
"""


def pressure(surface, value):
    return f'pressure {{ surface: "{surface}" value {{ row {{ time: 0 value: 0 }} row {{ time: 1e-3 value: {value} }} }} }}'


def held(mesh, material, *supports):
    return f'body {{ name: "b" {mesh} {material} {" ".join(supports)} }}'


def planes(*pairs):
    return " ".join(f'symmetry {{ surface: "{name}" normal: {axis} }}' for name, axis in pairs)


GRAVITY = "gravity { direction { y: -1 } value { row { time: 0 value: 9.81 } } }"
FIBRES = "fibres { constant { along { x: 1 } across { y: 1 } } }"
AROUND = "fibres { circumferential { point { x: 0.05 y: 0.05 } axis { z: 1 } } }"
FOOT = 'fixed: "x_min"'
TWO_BODIES = (held(BOX, SOFT, 'fixed: "y_min"').replace('"b"', '"lower"')
              + held("ball { radius: 0.005 centre { x: 0.005 y: 0.0151 z: 0.005 } elements: 1 }", RIVLIN).replace('"b"', '"upper"')
              + 'contact { first: "lower/y_max" second: "upper/surface" distance: 2e-4 } kick { time: 0 velocity { y: "y>0.01 ? -0.5 : 0" } }')

SCENES = {
    "fold": held("vocal_fold { medial_thickness: 2e-3 elements_x: 4 elements_y: 4 elements_z: 4 }", SOFT,
                 'fixed: ["lateral", "anterior", "posterior"]') + pressure("inferior", 200),
    "valve with an orifice": held(VALVE, SOFT, 'fixed: ["base", "commissure"]') + pressure("ventricular", 100)
                             + 'orifice { name: "area" surface: "ventricular" radius: 0.0105 cells: 64 }',
    "valve with regions": held(VALVE, "", 'fixed: ["base", "commissure"]',
                               *(f'region {{ name: "leaflet_{k}" {law} }}' for k, law in ((1, HOLZAPFEL), (2, SOFT), (3, KIRCHHOFF))))
                          + pressure("ventricular", 100) + IMPLICIT,
    "annulus": held("annulus { inner_radius: 0.01 outer_radius: 0.012 length: 0.01 angle: 90 elements_around: 3 elements_radial: 2 }",
                    RIVLIN, planes(("start", "Y"), ("end", "X"), ("z_min", "Z"))) + pressure("inner", 100) + STATIC,
    "hollow sphere": held("hollow_sphere { inner_radius: 0.01 outer_radius: 0.02 elements_radial: 2 elements_around: 2 }", SOFT,
                          "near_incompressible: true", planes(("x_min", "X"), ("y_min", "Y"), ("z_min", "Z")))
                     + pressure("inner", 100) + STATIC,
    "ball on a plane": held("ball { radius: 0.01 elements: 1 }", SOFT) + GRAVITY + 'kick { time: 0 velocity { y: "-1" } }'
                       + 'rigid_plane { plane { point { y: -0.01 } normal { y: 1 } } surface: "surface" stiffness: 1e6 }',
    "beam": held("cylinder_beam { elements_x: 10 elements_y: 2 }", KIRCHHOFF, 'fixed: "root"', planes(("front", "Z"), ("back", "Z")))
            + GRAVITY + IMPLICIT,
    "arch": held("arch { span: 1 rise: 0.05 thickness: 0.01 width: 0.02 }", SOFT, 'fixed: ["left_hinge", "right_hinge"]')
            + pressure("top", 1e-4) + STATIC,
    "tetrahedron from a file": held('mesh_file { file: "tetrahedron.msh" }', SOFT, 'fixed: "foot"') + GRAVITY,
    "fibres along": held(BOX, HOLZAPFEL, FIBRES, FOOT) + pressure("x_max", 300) + IMPLICIT,
    "fibres around": held(BOX, MAY_NEWMAN, AROUND, FOOT) + pressure("x_max", 300) + STATIC,
    "fibres of the mesh": held(VALVE, HOLZAPFEL, "fibres { from_mesh: true }", 'fixed: ["base", "commissure"]') + pressure("aortic", 100),
    "two bodies": TWO_BODIES,
    "two bodies, as it pays": TWO_BODIES + AUTO,
    "damping and settling": held(BOX, SOFT, FOOT, "mass_damping: 10 stiffness_damping: 1e-6") + pressure("x_max", 100)
                            + "settling { until: 5e-4 mass_damping: 2000 }",
    "forces on nodes": held(BOX, SOFT, FOOT) + IMPLICIT
                       + 'node_force { nodes: "x_max" value { direction { y: 1 } value { row { time: 0 value: 1e-4 } } } }',
    "traction without arcs": held(BOX, SOFT, FOOT) + "time_integration { method: STATIC arc_length: false }"
                             + 'traction { surface: "x_max" value { direction { y: 1 } value { row { time: 0 value: 50 } } } }',
    "prescribed motion": held(BOX, SOFT, FOOT) + 'prescribed_motion { nodes: "x_max" x: "0.002*sin(1000*t)" y: "0" z: "t" }',
}


class SolidRuns(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="couplet solid ")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        (self.folder / "tetrahedron.msh").write_text(TETRAHEDRON)

    def run_solid(self, solid, out, *more, end=6e-4):
        path = self.folder / "scene.txtpb"
        path.write_text(f'title: "t"\ntime {{ end: {end} step: 1e-4 }}\nsolid {{ {solid} }}\n{OUTPUT}\n')
        done = subprocess.run([SOLID_SERVER, "run", str(path), "--out", str(self.folder / out), "--quiet", *more],
                              capture_output=True, text=True, timeout=DEADLINE, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stderr

    def history(self, out):
        with open(self.folder / out / "history.csv", encoding="utf-8") as file:
            return list(csv.reader(file))

    def states(self, out):
        """Every stored field over time."""
        found = {}
        for path in sorted((self.folder / out / "results").glob("*.h5")):
            with h5py.File(path) as file:
                file.visititems(lambda name, item: found.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
        return found

    def expect_equal(self, one, other):
        self.assertEqual(self.history(one), self.history(other))
        ours, theirs = self.states(one), self.states(other)
        self.assertEqual(set(ours), set(theirs))
        for name, values in ours.items():
            self.assertTrue(numpy.array_equal(values, theirs[name]), name)

    def test_every_kind_of_scene_ends_well_and_moves(self):
        for name, solid in SCENES.items():
            with self.subTest(name):
                out = name.replace(" ", "_")
                self.run_solid(solid, out, end=3e-4)
                summary = json.loads((self.folder / out / "summary.json").read_text())
                self.assertEqual((summary["status"], summary["steps"]), ("finished", 3))
                titles, *rows = self.history(out)
                energy = [float(row[titles.index("solid.strain_energy [J]")]) for row in rows]
                self.assertGreater(max(energy), 0)

    def test_an_interrupted_run_gives_the_same_bits(self):
        moved = 'prescribed_motion { nodes: "upper/cut" x: "0.2*t" y: "-0.6*t" z: "0" }'
        pressed = (held(BOX, SOFT, 'fixed: "y_min"').replace('"b"', '"lower"')
                   + held("ball { radius: 0.005 centre { x: 0.005 y: 0.01505 z: 0.005 } part: LOWER_HALF elements: 1 }", RIVLIN)
                   .replace('"b"', '"upper"') + 'contact { first: "lower/y_max" second: "upper/surface" distance: 1e-4 }' + moved)
        for method in ("", IMPLICIT, STATIC):
            with self.subTest(method):
                name = method[-19:-2].replace(" ", "") or "explicit"
                self.run_solid(pressed, name)
                self.run_solid(pressed, name + "_begun", "--steps", "4")
                self.run_solid(pressed, name + "_ended", "--resume", str(self.folder / (name + "_begun")))
                titles, *rows = self.history(name)
                self.assertGreater(float(rows[3][titles.index("solid.contact_force [N]")]), 0, "in the middle of contact")
                self.assertEqual(self.history(name), self.history(name + "_ended"))

    def test_two_threads_give_the_same_bits(self):
        # 1,000 elements: below, a second thread is not worth its barriers.
        sheet = "box { length { x: 0.04 y: 0.05 z: 0.001 } elements_x: 25 elements_y: 40 }"
        loads = pressure("z_max", 5) + 'rigid_plane { plane { point { z: -1e-6 } normal { z: 1 } } surface: "z_min" stiffness: 1e6 }'
        for method in ("", IMPLICIT):
            with self.subTest(method):
                for threads in ("1", "2"):
                    self.run_solid(held(sheet, SOFT, FOOT) + loads + method, method[-19:-2].strip() + threads, "--threads", threads, end=1e-4)
                self.expect_equal(*(method[-19:-2].strip() + threads for threads in ("1", "2")))


if __name__ == "__main__":
    sys.exit(unittest.main(verbosity=2))
