#!/usr/bin/python3
"""Every rule of check_participant.py notices those who break it, names what they do, and lets a good program pass."""

import re
import subprocess
import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
PARTICIPANTS = HERE.parents[3] / "deploy" / "participant"
sys.path.insert(0, str(PARTICIPANTS))

from check_participant import RULES  # noqa: E402
from wrong_participant import FAULTS  # noqa: E402


def check(*command, rule=None):
    """Exit code and lines of a check of one rule."""
    words = [str(PARTICIPANTS / "check_participant.py"), "--scene", str(PARTICIPANTS / "check_scene.txtpb")]
    words += ["--rule", rule] if rule else []
    result = subprocess.run([*words, "--", *command], capture_output=True, text=True, timeout=200)
    return result.returncode, result.stdout.splitlines(), result.stderr


class WrongParticipantTest(unittest.TestCase):
    """A test for each fault is added below."""

    def expect_noticed(self, name, rule):
        code, lines, errors = check(str(HERE / "wrong_participant.py"), name, rule=rule)
        self.assertEqual((code, errors), (4, ""), lines)
        self.assertEqual(len(lines), 2, lines)
        self.assertRegex(lines[0], rf'^wrong  .*{re.escape(rule)}.*: .+ \(proto/README\.md, "[^"]+"\)$')
        self.assertNotIn("not reached", lines[0])
        self.assertEqual(lines[1], "1 of 1 rules are broken")


for _name, (_rule, _) in FAULTS.items():
    setattr(WrongParticipantTest, f"test_{_name.replace('-', '_')}",
            lambda self, name=_name, rule=_rule: self.expect_noticed(name, rule))


class CheckTest(unittest.TestCase):
    def test_every_rule_is_broken_by_somebody(self):
        for sentence, section, _ in RULES:
            self.assertTrue(any(rule in sentence for rule, _ in FAULTS.values()), sentence)
            page = (HERE.parents[3] / "proto" / "README.md").read_text()
            self.assertIn(f"\n## {section}\n", page)

    def test_a_good_program_passes(self):
        code, lines, errors = check(str(PARTICIPANTS / "mass_spring_wall.py"), rule="checkpoint")
        self.assertEqual((code, errors), (0, ""), lines)
        self.assertEqual(lines[-1], "all 3 rules are kept")

    def test_a_program_that_is_not_there_is_one_line(self):
        code, lines, errors = check("/no/such/program")
        self.assertEqual((code, lines), (2, []))
        self.assertEqual(len(errors.splitlines()), 1, errors)
        self.assertIn("/no/such/program", errors)

    def test_a_rule_that_there_is_not_is_one_line(self):
        code, lines, errors = check(str(PARTICIPANTS / "mass_spring_wall.py"), rule="colour")
        self.assertEqual((code, lines), (2, []))
        self.assertEqual(errors, "couplet: check-participant: --rule colour: no rule holds this text; without --rule all are listed\n")

    def test_what_follows_from_a_broken_rule_is_said_to_be_not_reached(self):
        code, lines, _ = check(str(HERE / "wrong_participant.py"), "ends-at-once", rule="checkpoint")
        self.assertEqual(code, 4)
        self.assertIn("not reached, because it ended with code 0 before it printed `listening ADDRESS`", lines[0])


if __name__ == "__main__":
    unittest.main()
