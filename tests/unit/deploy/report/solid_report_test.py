#!/usr/bin/python3
"""The page of a run shows its solid: bodies of every shape, what held and moved them, what came out; and nothing that was not there."""

import sys
import tempfile
import time
import unittest
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy

TOP = Path(__file__).resolve().parents[4]
sys.path[:0] = [str(TOP / "deploy" / "report"), str(Path(__file__).resolve().parent)]

from figures import new_figure  # noqa: E402
from report import report_page  # noqa: E402
from run_folder import RunFolder  # noqa: E402
from scene_text import parse_scene_text  # noqa: E402
from solid_facts import facts, formula_over_time, loads_over_time, table_value  # noqa: E402
from solid_pictures import Camera, Painter, from_the_side, sensible_camera  # noqa: E402
from solid_sections import cycles_of_opening  # noqa: E402
from solid_states import choose_moments, face_grid, outer_faces  # noqa: E402
from synthetic_run import write_result  # noqa: E402
from synthetic_solid_run import BOXES, CONTACT_SCENE, STATIC_SCENE, mixed_boxes, valve_area, write_contact_run, write_static_run, write_valve_run  # noqa: E402


class FolderTest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="couplet report ")
        self.folder = Path(self.temporary.name)

    def tearDown(self):
        self.temporary.cleanup()


def sections_of(page):
    return {part[: part.index("</h2>")]: part for part in page.split("<h2>")[1:]}


class SurfaceTest(unittest.TestCase):
    def test_encloses_the_volume_of_the_body_with_normals_outward(self):
        for shape, box in BOXES.items():
            position, cells = box(2, 1, 3, (2.0, 1.0, 3.0))
            faces, = outer_faces(SimpleNamespace(shape=shape, cell=cells))
            for n_pieces in (1, 3):
                weights, facets, _ = face_grid(faces.shape[1], n_pieces)
                corner = numpy.einsum("pn,fnc->fpc", weights, position[faces])[:, facets]
                a, b, c, d = (corner[:, :, i] for i in range(4))
                volume = sum(numpy.einsum("fpc,fpc->", p, numpy.cross(q, r)) for p, q, r in ((a, b, c), (a, c, d))) / 6
                self.assertAlmostEqual(volume, 6.0, delta=1e-12, msg=f"{shape}, {n_pieces} pieces")  # flat sides: exact but for round-off

    def test_has_only_the_faces_of_one_element(self):
        for shape, n_faces in (("hexahedron20", 22), ("hexahedron8", 22), ("tetrahedron10", 44)):
            _, cells = BOXES[shape](2, 1, 3, (2.0, 1.0, 3.0))
            faces, = outer_faces(SimpleNamespace(shape=shape, cell=cells))
            self.assertEqual(len(faces), n_faces, shape)

    def test_of_mixed_cells_has_the_faces_of_all_shapes(self):
        position, cells = mixed_boxes()
        faces = outer_faces(SimpleNamespace(shape="mixed", cell=cells))
        self.assertEqual([part.shape for part in faces], [(6, 8), (6, 4), (12, 6)])
        self.assertEqual(len(numpy.unique(numpy.concatenate([part.ravel() for part in faces]))), 20 + 8 + 8 + 18)  # of the outer surface
        self.assertLess(max(part.max() for part in faces), len(position))

    def test_borders_of_a_face_are_its_edges(self):
        for n_face_nodes, length in ((4, 8.0), (8, 8.0), (6, 2 + 2**0.5)):
            weights, _, borders = face_grid(n_face_nodes, 4)
            corner = [(-1, -1), (1, -1), (1, 1), (-1, 1)] if n_face_nodes != 6 else [(0, 0), (1, 0), (0, 1)]
            nodes = corner + [tuple(0.5 * (numpy.array(a) + b)) for a, b in zip(corner, corner[1:] + corner[:1])][: n_face_nodes - len(corner)]
            point = weights @ numpy.array(nodes)
            self.assertAlmostEqual(numpy.linalg.norm(point[borders[:, 0]] - point[borders[:, 1]], axis=1).sum(), length, delta=1e-12)


class MomentTest(FolderTest):
    def test_holds_start_end_and_the_extremes(self):
        position, cells = BOXES["hexahedron8"](1, 1, 1, (1.0, 1.0, 1.0))
        times = numpy.linspace(0, 1, 65)
        write_result(self.folder / "results", "body", "hexahedron8", position, cells, times,
                     lambda t: {"displacement": numpy.outer(position[:, 0] * numpy.sin(2 * numpy.pi * t) * (1 - 0.5 * t), [0, 1, 0])})
        moments = choose_moments(RunFolder(self.folder).bodies())
        amount = numpy.sin(2 * numpy.pi * times) * (1 - 0.5 * times)
        self.assertEqual(len(moments), 6)
        self.assertEqual(moments, sorted(set(moments)))
        for state in (0, 64, int(amount.argmax()), int(amount.argmin())):
            self.assertIn(state, moments)

    def test_of_one_state_is_that_one(self):
        position, cells = BOXES["hexahedron8"](1, 1, 1, (1.0, 1.0, 1.0))
        write_result(self.folder / "results", "body", "hexahedron8", position, cells, [0.0], lambda t: {"displacement": 0 * position})
        self.assertEqual(choose_moments(RunFolder(self.folder).bodies()), [0])

    def test_leaves_out_what_is_not_finite(self):
        position, cells = BOXES["hexahedron8"](1, 1, 1, (1.0, 1.0, 1.0))
        write_result(self.folder / "results", "body", "hexahedron8", position, cells, [0.0, 1.0, 2.0],
                     lambda t: {"displacement": (numpy.nan if t == 2 else t) * numpy.ones_like(position)})
        self.assertEqual(choose_moments(RunFolder(self.folder).bodies()), [0, 1])


class PictureTest(FolderTest):
    def test_colours_by_a_scalar_in_kilopascals(self):
        position, cells = BOXES["hexahedron8"](1, 1, 1, (1.0, 1.0, 1.0))
        write_result(self.folder / "results", "body", "hexahedron8", position, cells, [0.0],
                     lambda t: {"displacement": 0 * position, "largest_principal_stress": 1000 * position[:, :1]})
        painter = Painter(RunFolder(self.folder).bodies(), [0], scalar="largest_principal_stress")
        scale, words = painter.scale()
        self.assertEqual(words, "largest principal stress [kPa]")
        self.assertEqual(scale.get_clim(), (0.0, 1.0))

    def painter(self, displacement, may_enlarge=True):
        position, cells = BOXES["hexahedron20"](2, 2, 2, (1.0, 1.0, 1.0))
        write_result(self.folder / "results", "body", "hexahedron20", position, cells, [0.0, 1.0],
                     lambda t: {"displacement": t * displacement * numpy.ones_like(position)})
        return Painter(RunFolder(self.folder).bodies(), [0, 1], may_enlarge)

    def test_shows_what_faces_the_viewer_only(self):
        painter = self.painter(0.1)
        for towards, n_sides in (((0, 0, 1), 1), ((1, 0, 1), 2), ((1, 1, 1), 3)):
            outlines = painter._facets(0, painter.faces[0][0], painter.displacement(0, 0), Camera(towards, (0, 1, 0)))[0]
            self.assertEqual(len(outlines), n_sides * 4 * painter.n_pieces**2, towards)

    def test_enlarges_what_could_not_be_seen_by_a_round_factor(self):
        self.assertEqual(self.painter(0.1).enlarged, 1)
        small = self.painter(1e-5)
        self.assertIn(f"{small.enlarged:.0e}"[0], "125")
        self.assertGreater(small.enlarged * small.largest, 0.01 * small.size)
        self.assertEqual(self.painter(1e-5, may_enlarge=False).enlarged, 1)

    def test_looks_straight_at_a_flat_body(self):
        camera = sensible_camera(numpy.zeros(3), numpy.array([1, 0.5, 0.01]))
        self.assertTrue(numpy.allclose(camera.towards, from_the_side(0).towards))

    def test_a_body_of_three_thousand_elements_takes_little_time(self):
        run = RunFolder(write_valve_run(self.folder / "run", n_elements=(50, 60, 1)))
        painter = Painter(run.bodies(), [0, 40])
        _, axes = new_figure()
        started = time.process_time()
        painter.draw(axes, 40, Camera((1, 1, 1), (0, 1, 0)), painter.limits(Camera((1, 1, 1), (0, 1, 0))))
        axes.figure.canvas.draw()
        self.assertLess(time.process_time() - started, 1.5)  # 0.1 s here; six moments are to stay well within ten seconds anywhere


class PageTest(FolderTest):
    def test_of_two_bodies_in_contact(self):
        page = report_page(RunFolder(write_contact_run(self.folder / "run")))
        found = sections_of(page)
        for title in ("The bodies", "Loads", "Energy of the solid", "Contact", "Steps of the solid", "What was run"):
            self.assertIn(title, found)
        for title in ("Open area", "Load and displacement", "Reactions", "The body", "What else the programs reported"):
            self.assertNotIn(title, found)
        self.assertIn("results/lower.xmf, results/upper.xmf", found["The bodies"])
        self.assertIn("smallest distance", found["Contact"])
        self.assertIn("Newton iterations", found["Steps of the solid"])
        self.assertIn("substeps of every step", found["Steps of the solid"])
        self.assertNotIn('class="trouble"', page)
        for picture in page.split("<svg")[1:]:
            ElementTree.fromstring("<svg" + picture[: picture.index("</svg>") + 6])

    def test_of_bodies_of_every_shape(self):
        for shape in BOXES:
            page = report_page(RunFolder(write_contact_run(self.folder / shape, (shape, shape))))
            self.assertEqual(page.count("data:image/png;base64,"), 1, shape)

    def test_of_mixed_cells(self):
        position, cells = mixed_boxes()
        write_result(self.folder / "results", "body", "mixed", position, cells, [0.0, 1.0], lambda t: {"displacement": t * position})
        self.assertIn("<h2>The body</h2>", report_page(RunFolder(self.folder)))

    def test_of_a_valve(self):
        found = sections_of(report_page(RunFolder(write_valve_run(self.folder / "run"))))
        self.assertIn("from the side", found["The body"])
        self.assertIn("opening and closing", found["The body"])
        self.assertIn(">3</td>", found["Open area"])  # cm^2
        self.assertIn(">0.0003</td>", found["Open area"])  # m^2
        for moment in ("0.012", "0.028", "0.072", "0.088"):  # 10 and 90 % of the ramps
            self.assertIn(f">{moment}</td>", found["Open area"])
        for title in ("Contact", "Coupling", "Load and displacement", "What else the programs reported"):
            self.assertNotIn(title, found)

    def test_of_a_path_of_equilibria(self):
        found = sections_of(report_page(RunFolder(write_static_run(self.folder / "run"))))
        self.assertIn("node force on crown", found["Load and displacement"])
        self.assertIn("Reactions", found)
        self.assertNotIn("The body", found)  # no fields are stored
        self.assertNotIn("Displacement at the probes", found)  # shown over the load instead
        self.assertNotIn("solid.reaction", found["Load and displacement"])

    def test_of_a_damaged_file_names_it_and_goes_on(self):
        run = write_contact_run(self.folder / "run")
        (run / "results" / "upper.h5").write_bytes(b"torn")
        page = report_page(RunFolder(run))
        self.assertIn("results/upper.h5 cannot be read", page)
        self.assertIn("<h2>The bodies</h2>", page)


class OpeningTest(unittest.TestCase):
    def test_a_flutter_is_part_of_one_opening(self):
        moments = numpy.linspace(0, 0.1, 1001)
        cycle, = cycles_of_opening(moments, valve_area(moments))
        for key, exact in (("opens", 0.012), ("is_open", 0.028), ("closes", 0.072), ("is_closed", 0.088)):
            self.assertAlmostEqual(cycle[key], exact, delta=1e-12)  # straight lines between samples: exact but for round-off

    def test_of_a_run_that_ends_open_has_no_closing(self):
        moments = numpy.linspace(0, 0.047, 471)
        cycle, = cycles_of_opening(moments, valve_area(moments))
        self.assertEqual(set(cycle), {"opens", "is_open"})

    def test_every_cycle_counts(self):
        moments = numpy.linspace(0, 0.3, 3001)
        self.assertEqual(len(cycles_of_opening(moments, valve_area(moments % 0.1))), 3)


class FactsTest(unittest.TestCase):
    def words(self, text):
        return "\n".join(f"{name}: {value}" for name, value in facts(parse_scene_text(text)) if value)

    def test_names_every_kind_of_mesh(self):
        for text, words in (('vocal_fold { medial_thickness: 1e-3 elements_x: 6 elements_y: 9 elements_z: 12 half_length: true }', "6 × 9 × 6 elements"),
                            ('box { length { x: 1 y: 0.02 z: 3 } elements_x: 4 elements_y: 2 elements_z: 1 }', "box, 1 m × 20 mm × 3 m, 4 × 2 × 1"),
                            ('mesh_file { file: "a.msh" length_unit: 0.001 }', "file a.msh, one unit is 1 mm"),
                            ('valve { thickness: 3e-4 elements_u: 20 elements_v: 16 elements_t: 1 }', "thickness 0.3 mm; of each 20 elements along the free edge, 16 up to its middle, 1 through"),
                            ('annulus { inner_radius: 0.01 outer_radius: 0.02 length: 0.1 angle: 90 }', "90° of it"),
                            ('hollow_sphere { inner_radius: 0.01 outer_radius: 0.02 }', "eighth of a hollow sphere, radii 10 mm and 20 mm"),
                            ('ball { radius: 0.01 part: LOWER_HALF elements: 4 }', "lower half of a ball, radius 10 mm"),
                            ('cylinder_beam { length: 0.35 thickness: 0.02 cylinder_radius: 0.05 }', "length 0.35 m, thickness 20 mm"),
                            ('arch { span: 0.1 rise: 0.005 thickness: 0.001 }', "shallow arch, span 0.1 m, rise 5 mm")):
            self.assertIn(words, self.words(f'solid {{ body {{ name: "b" {text} }} }}'))

    def test_says_what_holds_and_moves_the_bodies(self):
        words = self.words(CONTACT_SCENE)
        for part in ("contact: lower/y_max with upper/bottom, within 0.1 mm", "supports of lower: y_min fixed", "14 points each",
                     "material of region cover of upper: Saint Venant-Kirchhoff: young modulus 20000 Pa, poisson ratio 0.4; density 1040 kg/m³",
                     "gravity: 0 m/s² at 0 s to 9.81 m/s² at 0.05 s, towards (0, -1, 0)", "motion of upper/top: x: x*t, y: -1e-3*sin(pi*t/0.1) [m]",
                     "time integration: central difference"):
            self.assertIn(part, words)
        self.assertNotIn("points each", words.splitlines()[0])
        self.assertIn("static equilibrium at every step, by arc length", self.words(STATIC_SCENE))

    def test_loads_over_time_are_those_of_the_scene(self):
        found = {kind: (name, values) for kind, name, _, values in loads_over_time(parse_scene_text(CONTACT_SCENE), numpy.array([0, 0.025, 0.05, 0.1]))}
        self.assertTrue(numpy.allclose(found["gravity"][1], [0, 9.81 / 2, 9.81, 9.81]))
        self.assertEqual(found["prescribed motion"][0], "upper/top, y")  # the one along x depends on the place
        self.assertTrue(numpy.allclose(found["prescribed motion"][1], [0, -1e-3 * 0.5**0.5, -1e-3, 0]))

    def test_a_table_holds_its_ends(self):
        table = parse_scene_text("row { time: 1 value: 2 } row { time: 2 value: 4 }")
        self.assertEqual(list(table_value(table, numpy.array([0, 1.5, 3]))), [2, 3, 4])

    def test_formulas_that_cannot_be_drawn_are_left_out(self):
        moments = numpy.array([0.0, 2.0])
        self.assertEqual(list(formula_over_time("-t^2 + abs(-1)", moments)), [1, -3])
        for formula in ("x*t", "t <", "t > 1 ? 2 : 3", "__import__('os')", "1/t", ""):
            self.assertIsNone(formula_over_time(formula, moments), formula)


if __name__ == "__main__":
    unittest.main()
