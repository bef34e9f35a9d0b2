"""Rows of the table: printed as they come, kept for JSON and pictures."""

import numpy


def plain(value):
    """A number of JSON, whatever kind of number it was."""
    return float(value) if isinstance(value, numpy.floating) else value


class Table:
    def __init__(self):
        self.rows = []
        print(f"{'case':<20} {'program':<9} {'setting':<32} {'mesh':>9} {'error':>9} {'core s':>8} {'iterations':>10}  "
              f"{'':<50} target")

    def add(self, case, program, mesh, *, setting="", error=None, core_seconds=None, iterations=None, note="", target="",
            **numbers):
        """One row: error is relative, core_seconds user and system of the whole process; numbers go to JSON alone."""
        row = {"case": case, "program": program, "setting": setting, "mesh": mesh, "error": error,
               "core_seconds": core_seconds, "iterations": iterations, "note": note, "target": target, **numbers}
        self.rows.append({key: plain(value) for key, value in row.items()})
        shown = [f"{error:9.2e}" if error is not None else " " * 9,
                 f"{core_seconds:8.3f}" if core_seconds is not None else " " * 8,
                 f"{iterations:10d}" if iterations is not None else " " * 10]
        print(f"{case:<20} {program:<9} {setting:<32} {mesh:>9} {' '.join(shown)}  {note:<50} {target}".rstrip(),
              flush=True)

    def failed(self, case, program, mesh, solved, **named):
        """What a program said when it gave up."""
        lines = [line.strip() for line in solved.output.strip().splitlines() if line.strip()]
        errors = [line for line in lines if "ERROR" in line] or lines[-1:] or ["no output"]
        self.add(case, program, mesh, core_seconds=solved.core_seconds, note="failed: " + errors[0].strip("* "), failed=True,
                 **named)
