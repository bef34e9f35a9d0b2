#!/usr/bin/python3
"""Studies find the orders, limits and cheapest settings that were built into the results they are given."""

import contextlib
import csv
import io
import sys
import tempfile
import unittest
from pathlib import Path

TOP = Path(__file__).resolve().parents[4]
sys.path[:0] = [str(TOP / "deploy" / "study"), str(TOP / "deploy" / "report")]

from combinations import combine, parse_vary  # noqa: E402
from convergence import observe  # noqa: E402
from study import main  # noqa: E402

FAKE_COUPLET = Path(__file__).resolve().parent / "fake_couplet.py"


class VaryTest(unittest.TestCase):
    def test_values_stand_between_commas(self):
        axis = parse_vary("time.step=2e-5,1e-5")
        self.assertEqual([level.settings for level in axis.levels], [["time.step=2e-5"], ["time.step=1e-5"]])

    def test_commas_inside_braces_belong_to_the_value(self):
        axis = parse_vary("law={a: 1, b: [2, 3]},{a: 4}")
        self.assertEqual([level.label for level in axis.levels], ["{a: 1, b: [2, 3]}", "{a: 4}"])

    def test_fields_that_vary_together_take_values_between_colons(self):
        axis = parse_vary("b.elements_x,b.elements_y=4:6,8:12")
        self.assertEqual(axis.levels[1].settings, ["b.elements_x=8", "b.elements_y=12"])
        self.assertEqual(axis.name, "elements_x,y")

    def test_wrong_number_of_values_is_refused(self):
        with self.assertRaisesRegex(ValueError, "4 gives 1 values for 2 fields"):
            parse_vary("a,b=4,8:12")

    def test_every_combination_is_made(self):
        combinations = combine([parse_vary("a=1,2"), parse_vary("b=3,4,5")])
        self.assertEqual(len({combination.label for combination in combinations}), 6)

    def test_more_elements_and_smaller_steps_are_finer(self):
        self.assertEqual(parse_vary("n=4,8,16").sizes(), [4, 2, 1])
        self.assertEqual(parse_vary("dt=4e-3,2e-3,1e-3").sizes(), [4, 2, 1])
        self.assertEqual(parse_vary("nx,ny=4:9,8:18").sizes(), [2, 1])
        self.assertIsNone(parse_vary("model=B1,M2").sizes())


class ConvergenceTest(unittest.TestCase):
    def test_three_levels_give_order_and_limit_exactly(self):
        h = [1.0, 1.5, 3.0]  # not a constant ratio
        found = observe(h, [7 + 0.3 * size**1.7 for size in h])
        self.assertAlmostEqual(found.order, 1.7, places=4)  # the search for the order ends at 1e-5
        self.assertAlmostEqual(found.value, 7, places=4)

    def test_the_limit_lies_inside_the_uncertainty(self):
        h = [1.0, 2.0, 4.0, 8.0]
        found = observe(h, [7 + 0.3 * size**2 + 0.02 * size**3 for size in h])  # a second power disturbs
        self.assertLess(abs(found.value - 7), found.uncertainty)

    def test_values_that_go_up_and_down_have_no_order(self):
        found = observe([1, 2, 4], [1.0, 1.1, 0.95])
        self.assertIsNone(found.order)
        self.assertGreaterEqual(found.uncertainty, 0.15)  # at least the range that was seen

    def test_differences_that_grow_towards_finer_levels_have_no_order(self):
        self.assertIsNone(observe([1, 2, 4], [0.0, 1.0, 1.1]).order)

    def test_two_levels_show_no_order(self):
        self.assertIsNone(observe([1, 2], [1.0, 1.1]).order)

    def test_a_quantity_that_does_not_depend_on_it_has_no_uncertainty(self):
        self.assertEqual(observe([1, 2, 4], [3.0, 3.0, 3.0]).uncertainty, 0)


class StudyTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="couplet study ")
        self.out = Path(self.folder.name) / "study"
        self.out.mkdir()
        self.scene = Path(self.folder.name) / "scene.txtpb"
        self.scene.write_text("title: 'a scene'")

    def tearDown(self):
        self.folder.cleanup()

    def study(self, *arguments):
        """Exit code, standard output and standard error of a study."""
        output, errors = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            code = main([str(self.scene), "--couplet", str(FAKE_COUPLET), "--out", str(self.out), *arguments])
        return code, output.getvalue(), errors.getvalue()

    def rows(self):
        with open(self.out / "study.csv", newline="") as file:
            return list(csv.DictReader(file))

    def n_runs(self):
        return len((self.out / "runs.txt").read_text().splitlines())

    def test_finds_both_orders_the_limit_and_the_cheapest_setting(self):
        code, output, errors = self.study("--vary", "nx,ny=4:4,8:8,16:16", "--vary", "time.step=4e-4,2e-4,1e-4", "--error", "0.012")
        self.assertEqual(code, 0, errors)
        self.assertIn("extrapolated 100 ", output)
        self.assertIn("with nx,ny: order 2.00", output)
        self.assertIn("with step: order 1.00", output)
        # errors: 2/256 + 50 dt; 16x16 with 1e-4 has 1.28 %, too much for 1.2 %
        self.assertIn("cheapest for an error of 1.2 %: none of these runs", output)
        best = min(self.rows(), key=lambda row: float(row["frequency_error"]))
        self.assertAlmostEqual(float(best["frequency_error"]), 2 / 256 + 50 * 1e-4, places=6)

    def test_takes_the_cheapest_of_the_runs_that_are_good_enough(self):
        _, output, _ = self.study("--vary", "nx=8,16,32", "--vary", "time.step=4e-4,2e-4,1e-4", "--error", "0.05")
        # errors are 2/(8 nx) + 50 dt: 8 and 1e-4 reach 3.6 %, 8 and 2e-4 4.1 %; 8 and 4e-4 have 5.1 %; 16 and 4e-4 3.6 %, at the cost of 8 and 2e-4
        self.assertIn("cheapest for an error of 5 %: nx=8, step=2e-4", output)

    def test_finished_runs_are_not_run_again(self):
        self.study("--vary", "time.step=4e-3,2e-3")
        self.study("--vary", "time.step=4e-3,2e-3,1e-3")
        self.assertEqual(self.n_runs(), 3)

    def test_a_changed_scene_is_run_again(self):
        self.study("--vary", "time.step=4e-3,2e-3")
        self.scene.write_text("title: 'another scene'")
        self.study("--vary", "time.step=4e-3,2e-3")
        self.assertEqual(self.n_runs(), 4)

    def test_a_run_that_fails_is_a_row_and_not_the_end(self):
        code, output, errors = self.study("--vary", "model=B2,M2")
        self.assertEqual(code, 0, errors)
        self.assertIn("diverged; choose another model", output)
        self.assertEqual([row["exit_code"] for row in self.rows()], ["3", "0"])

    def test_a_study_whose_runs_all_fail_ends_with_their_code(self):
        self.assertEqual(self.study("--vary", "model=B2")[0], 3)

    def test_an_unknown_quantity_is_refused_with_those_there_are(self):
        code, output, errors = self.study("--vary", "nx=4,8", "--quantity", "pitch")
        self.assertEqual(code, 2)
        self.assertIn("--quantity pitch: the runs have frequency", errors)

    def test_writes_a_page_with_pictures(self):
        self.study("--vary", "nx=4,8,16")
        page = (self.out / "report.html").read_text()
        self.assertEqual(page.count("<svg"), 2)
        self.assertNotIn('src="http', page)


if __name__ == "__main__":
    unittest.main()
