#!/usr/bin/python3
"""The page of a run shows what its folder holds, however little that is."""

import json
import sys
import tempfile
import unittest
from pathlib import Path
from xml.etree import ElementTree

import numpy

TOP = Path(__file__).resolve().parents[4]
sys.path[:0] = [str(TOP / "deploy" / "report"), str(Path(__file__).resolve().parent)]

from comparison import comparison_page  # noqa: E402
from body_sections import columns_shown, cut_by_plane  # noqa: E402
from flow_sections import vorticity_in_plane, without_bodies  # noqa: E402
from oscillation import main_frequency, thin  # noqa: E402
from report import report_page  # noqa: E402
from run_folder import RunFolder  # noqa: E402
from scene_text import find, parse_scene_text  # noqa: E402
from synthetic_run import FREQUENCY, add_body, box_surface, write_flow_run, write_history, write_run  # noqa: E402
from vocal_fold_sections import cycle_length, middle_outline  # noqa: E402


class FolderTest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="couplet report ")
        self.folder = Path(self.temporary.name)

    def tearDown(self):
        self.temporary.cleanup()


class PageTest(FolderTest):
    def test_shows_every_section_of_a_complete_run(self):
        page = report_page(RunFolder(write_run(self.folder / "run")))
        for title in ("Results", "Outline at mid length", "Displacement at the probes", "Glottal flow", "Pressure along the glottis",
                      "The body", "Energy of the solid", "Coupling", "Time spent where", "What else the programs reported", "What was run", "Machine and version"):
            self.assertIn(f"<h2>{title}</h2>", page)
        self.assertIn(">130</td>", page)

    def test_needs_nothing_from_outside(self):
        page = report_page(RunFolder(write_run(self.folder / "run"))).replace('src="data:image/png;base64,', "")
        for word in ("<script", "<link", "src=", "@import", "url(http"):
            self.assertNotIn(word, page)

    def test_every_picture_is_well_formed(self):
        page = report_page(RunFolder(write_run(self.folder / "run")))
        pictures = page.split("<svg")[1:]
        self.assertGreaterEqual(len(pictures), 8)
        for picture in pictures:
            ElementTree.fromstring("<svg" + picture[: picture.index("</svg>") + 6])

    def test_a_long_history_stays_a_small_page(self):
        page = report_page(RunFolder(write_run(self.folder / "run", n_rows=100_000)))
        self.assertLess(len(page.encode()), 3e6)

    def test_a_failed_run_says_why(self):
        run = write_run(self.folder / "run")
        summary = json.loads((run / "summary.json").read_text()) | {"status": "failed", "failure": "element 7 <is> turned inside out"}
        (run / "summary.json").write_text(json.dumps(summary))
        self.assertIn("element 7 &lt;is&gt; turned inside out", report_page(RunFolder(run)))

    def test_a_run_that_was_cut_off_shows_what_there_is(self):
        run = self.folder / "run"
        run.mkdir()
        write_history(run / "history.csv", 4000, 0.4)
        with open(run / "history.csv", "a") as file:
            file.write("0.4001,1e-4,3")  # the power failed here
        page = report_page(RunFolder(run))
        self.assertIn("has no summary", page)
        self.assertIn("4000 steps to t = 0.4 s", page)
        self.assertIn("<h2>Displacement at the probes</h2>", page)

    def test_damaged_files_are_named_and_do_not_stop_the_page(self):
        run = write_run(self.folder / "run")
        (run / "summary.json").write_text("{")
        (run / "results" / "fold.h5").write_bytes(b"torn")
        page = report_page(RunFolder(run))
        self.assertIn("summary.json cannot be read", page)
        self.assertIn("results/fold.h5 cannot be read", page)

    def test_an_empty_folder_still_has_a_page(self):
        self.assertIn("history.csv is missing", report_page(RunFolder(self.folder)))

    def test_a_comparison_names_what_differs(self):
        runs = [write_run(self.folder / name) for name in ("one", "two")]
        scene = (runs[1] / "resolved_scene.txtpb").read_text()
        (runs[1] / "resolved_scene.txtpb").write_text(scene.replace("model: M2", "model: B1"))
        page = comparison_page([RunFolder(run) for run in runs])
        self.assertIn("<td>flow.glottis.model</td><td>M2</td><td>B1</td>", page)
        self.assertNotIn("<td>time.step</td>", page)


class OutlineTest(FolderTest):
    def test_follows_the_edge_of_the_middle_section_without_the_wall(self):
        states = RunFolder(write_run(self.folder / "run")).results("hexahedron20")
        nodes = middle_outline(states, 0.02)
        position = states.position[nodes]
        self.assertEqual(len(nodes), 13)  # two elements up, two along, two down: six edges of two pieces each
        self.assertTrue(numpy.allclose(position[:, 2], 0.01))
        self.assertTrue(numpy.allclose(position[[0, -1], 1], 0))  # begins and ends at the wall
        self.assertTrue(numpy.allclose(numpy.abs(numpy.diff(position, axis=0)).sum(axis=1), [5e-4] * 4 + [1e-3] * 4 + [5e-4] * 4))

    def test_finds_the_cycle_from_the_probes(self):
        run = RunFolder(write_run(self.folder / "run"))
        self.assertAlmostEqual(1 / cycle_length(run), FREQUENCY, delta=0.3)  # a tenth of a bin of 4 Hz


class SignalTest(unittest.TestCase):
    def test_frequency_of_unevenly_spaced_samples(self):
        time = numpy.sort(numpy.random.default_rng(1).uniform(0, 0.5, 20000))
        self.assertAlmostEqual(main_frequency(time, numpy.sin(2 * numpy.pi * 137.3 * time)), 137.3, delta=0.1)

    def test_thinning_keeps_the_extremes(self):
        values = numpy.zeros(100_000)
        values[31_415], values[27_182] = 1.0, -2.0
        _, thinned = thin(numpy.arange(100_000.0), values)
        self.assertEqual((thinned.max(), thinned.min()), (1.0, -2.0))
        self.assertLess(len(thinned), 2000)


class SceneTextTest(unittest.TestCase):
    def test_reads_messages_lists_comments_and_texts(self):
        scene = parse_scene_text('# all\na { b: 1 b: 2.5 c: "x # y" } d: [1, 2] e < f: M2 >')
        self.assertEqual(scene["a"][0]["b"], [1, 2.5])
        self.assertEqual(find(scene, "a.c"), "x # y")
        self.assertEqual(scene["d"], [1, 2])
        self.assertEqual(find(scene, "e.f"), "M2")
        self.assertIsNone(find(scene, "a.z.q"))


class FlowPageTest(FolderTest):
    def test_shows_every_section_of_a_flow_in_space(self):
        page = report_page(RunFolder(write_flow_run(self.folder / "run")))
        for title in ("The flow", "Energy", "Planes and points", "Distance from the exact solution", "Time steps", "Time spent where"):
            self.assertIn(f"<h2>{title}</h2>", page)
        self.assertEqual(page.count("data:image/png;base64,"), 4, "three middle planes and the vorticity over time")
        self.assertIn(">123.4</td>", page)
        self.assertNotIn('class="trouble"', page)
        self.assertLess(len(page), 3e6)

    def test_shows_one_plane_of_a_flow_in_two_dimensions(self):
        page = report_page(RunFolder(write_flow_run(self.folder / "run", n_cells=(32, 16, 1))))
        self.assertEqual(page.count("data:image/png;base64,"), 2)
        self.assertIn("the plane of the flow", page)

    def test_shows_no_pictures_where_none_are_stored(self):
        run = write_flow_run(self.folder / "run")
        for file in (run / "results").iterdir():
            file.unlink()
        page = report_page(RunFolder(run))
        self.assertNotIn("<h2>The flow</h2>", page)
        self.assertIn("<h2>Energy</h2>", page)

    def test_shows_forces_on_bodies_beside_the_balance_of_momentum(self):
        run = RunFolder(add_body(write_flow_run(self.folder / "run", n_cells=(32, 32, 1))))
        page = report_page(run)
        self.assertIn("<h2>Forces on bodies</h2>", page)
        for words in ("force along x [N]", "moment about z [N m]", "power on its motion [W]", "balance of momentum, around"):
            self.assertIn(words, page)
        self.assertIn("results/body.block.xmf", page)
        self.assertNotIn("What else the programs reported", page)
        self.assertIn("around.force_balance_x", columns_shown(run))
        self.assertNotIn('class="trouble"', page)

    def test_leaves_the_inside_of_bodies_out_of_pictures(self):
        states = RunFolder(add_body(write_flow_run(self.folder / "run", n_cells=(32, 32, 1)))).flow_fields()
        for state in (0, 2):
            shown = without_bodies(states, "flow", state, 2, vorticity_in_plane(states, "flow", state, 2))
            centre = (numpy.arange(32) + 0.5) * 2 * numpy.pi / 32
            begin = 2 + 0.5 * state
            inside = ((centre > begin) & (centre < begin + 1))[:, None] & ((centre > 2) & (centre < 4))[None, :]
            numpy.testing.assert_array_equal(numpy.ma.getmaskarray(shown), inside)

    def test_outlines_are_where_a_plane_meets_the_surface(self):
        corner, triangles = box_surface((1, 2, 0), (2, 4, 3))
        segments = cut_by_plane(corner, triangles, 2, 1.1, [0, 1])
        self.assertEqual(len(segments), 8, "two triangles a side")
        length = numpy.linalg.norm(segments[:, 1] - segments[:, 0], axis=-1).sum()
        self.assertAlmostEqual(length, 2 * (1 + 2), delta=1e-12)  # round the box
        on_side = numpy.isclose(segments[..., 0], 1) | numpy.isclose(segments[..., 0], 2) | numpy.isclose(segments[..., 1], 2) | numpy.isclose(segments[..., 1], 4)
        self.assertTrue(on_side.all())
        self.assertEqual(len(cut_by_plane(corner, triangles, 2, 3.5, [0, 1])), 0)
        across_x = cut_by_plane(corner, triangles, 0, 1.5, [1, 2])
        self.assertAlmostEqual(numpy.linalg.norm(across_x[:, 1] - across_x[:, 0], axis=-1).sum(), 2 * (2 + 3), delta=1e-12)

    def testvorticity_in_plane_is_that_of_the_velocity(self):
        states = RunFolder(write_flow_run(self.folder / "run", n_cells=(64, 64, 1))).flow_fields()
        found = vorticity_in_plane(states, "flow", 0, 2)
        centre = (numpy.arange(64) + 0.5) * 2 * numpy.pi / 64
        exact = 2 * numpy.sin(centre)[:, None] * numpy.sin(centre)[None, :]
        inside = slice(2, -2)  # differences at the ends are one-sided
        self.assertLess(numpy.abs(found - exact)[inside, inside].max(), 2 * (2 * numpy.pi / 64) ** 2)


if __name__ == "__main__":
    unittest.main()
