"""Modes of the vocal fold, explicit steps: the element kernel, threads."""

import json
import subprocess

import calculix
import couplet
import measure

# Modes of a fold of 648 elements with 8 points on another mesh of the same shape, by CalculiX 2.20 [Hz].
FOLD_MODES = (73.28, 103.58, 120.78, 126.37)
FOLD = ('vocal_fold {{ medial_thickness: 1.75e-3 elements_x: {} elements_y: {} elements_z: {} }} fixed: "lateral" '
        'fixed: "anterior" fixed: "posterior" ')
KERNEL_TARGETS = {("saint_venant_kirchhoff", 8): 0.30, ("saint_venant_kirchhoff", 14): 0.45, ("saint_venant_kirchhoff", 27): 0.75,
                  ("mooney_rivlin", 8): 0.32, ("mooney_rivlin", 14): 0.51, ("mooney_rivlin", 27): 0.83}
TISSUE = (15e3, 0.475, 1040)


def fold_modes(bench):
    """The lowest frequencies, on our mesh by both programs. With 8 points CalculiX integrates the mass with 8 points, ours
    with 27; with 27 points both matrices are the same."""
    bench.family = "modes"
    for points, element in ((8, calculix.REDUCED), (27, calculix.FULL)):
        body = FOLD.format(6, 9, 12) + f"points_per_element: {points} " + couplet.saint_venant_kirchhoff(*TISSUE)
        ours = bench.solve(couplet.scene(body, "modes { count: 6 }"), "modes", points, verb="modes")
        add_modes(bench, "couplet", points, ours, "0.05 %, 2.8 core s" if points == 8 else "")
        if not bench.has_peer:
            continue
        mesh = ours.mesh()
        held = mesh.nodes_where(lambda x, y, z: (y < 1e-9) | (z < 1e-9) | (z > 0.02 - 1e-9))
        deck = calculix.Deck(mesh, element).hold(held).saint_venant_kirchhoff(*TISSUE).frequencies(6)
        theirs = calculix.solve(deck, bench.folder("modes", points, "calculix"))
        add_modes(bench, "calculix", points, theirs)
        apart = max(abs(a / b - 1) for a, b in zip(ours.frequencies[:4], theirs.frequencies))
        bench.table.add("fold, modes", "both", "6x9x12", setting=f"{points} points", error=apart, family=bench.family,
                        note="largest difference")


def add_modes(bench, program, points, solved, target=""):
    error = max(abs(found / known - 1) for found, known in zip(solved.frequencies, FOLD_MODES)) if points == 8 else None
    bench.table.add("fold, modes", program, "6x9x12", setting=f"{points} points", error=error, target=target,
                    core_seconds=solved.core_seconds, family=bench.family,
                    note=", ".join(f"{f:.3f}" for f in solved.frequencies[:4]) + " Hz",
                    **{f"frequency_{m}": f for m, f in enumerate(solved.frequencies, 1)})


def kernel(bench):
    """Internal force of a block of elements (bench hex20-kernel), and what an explicit increment of CalculiX costs."""
    bench.family = "explicit"
    program = bench.programs / "bench-hex20-kernel"
    path = bench.folder("kernel.json")
    if not program.exists():
        print(f"{program.name} is not built: its rows are left out")
        return
    subprocess.run([str(program), "--json", str(path)], check=True, capture_output=True)
    for row in json.loads(path.read_text()):
        target = KERNEL_TARGETS.get((row["material"], row["points"])) if row["threads"] == 1 else None
        bench.table.add("internal force", "couplet", str(row["elements"]), family=bench.family, error=row["relative_error"],
                        setting=f"{row['points']} points, {row['threads']} threads", us_per_element=row["us_per_element"],
                        note=f"{row['material']}, {row['us_per_element']:.3f} us an element",
                        target=f"{target} us" if target else "")


def explicit_increment(bench):
    """Cost of an explicit increment: the difference of a long and a short run."""
    bench.family = "explicit"
    n, ends = 10, (5e-4, 2.5e-3)
    body = (f"box {{ length {{ x: 0.01 y: 0.01 z: 0.01 }} elements_x: {n} elements_y: {n} elements_z: {n} }} fixed: \"z_min\" "
            + couplet.saint_venant_kirchhoff(*TISSUE))
    gravity = "gravity { direction { x: 1 } " + couplet.constant(9.81) + " }"

    def add(program, runs, counts):
        cost = 1e6 * (runs[1].core_seconds - runs[0].core_seconds) / (counts[1] - counts[0]) / n**3
        bench.table.add("explicit increment", program, f"{n}^3", core_seconds=runs[1].core_seconds, family=bench.family,
                        us_per_element=cost, note=f"{cost:.3f} us an element, {counts[1]:.0f} increments")

    ours = [bench.solve(couplet.scene(body, gravity, 20 * end, end, "CENTRAL_DIFFERENCE"), "explicit", end) for end in ends]
    add("couplet", ours, [run.of_solid["substeps"] for run in ours])
    if bench.has_peer:
        mesh = ours[0].mesh()
        theirs = [calculix.solve(calculix.Deck(mesh, calculix.REDUCED).hold(mesh.nodes_where(lambda x, y, z: z < 1e-9))
                                 .nodes("OBSERVED", [mesh.nearest((0.01, 0.01, 0.01))]).saint_venant_kirchhoff(*TISSUE)
                                 .explicit_dynamic(1e-5, end).gravity(9.81, (1, 0, 0)).print_displacement("OBSERVED"),
                                 bench.folder("explicit", "calculix", end)) for end in ends]
        add("calculix", theirs, [calculix.n_explicit_increments(run, end) for run, end in zip(theirs, ends)])


def explicit_threads(bench):
    """The fold with 18,000 elements of 27 points, since edges are curved, on one and two threads: the fastest of three long
    runs less the fastest of three short ones, in turns."""
    bench.family = "threads"
    body = FOLD.format(8, 30, 75) + couplet.saint_venant_kirchhoff(*TISSUE)
    gravity = "gravity { direction { x: 1 } " + couplet.constant(9.81) + " }"
    runs, substeps, step = {1: [], 2: []}, 0, 2e-4
    for _ in range(measure.REPEATS):
        for threads, found in runs.items():
            short, long = (bench.solve(couplet.scene(body, gravity, steps * step, step, "CENTRAL_DIFFERENCE"), "threads",
                                       threads=threads, repeats=1).of_solid for steps in (1, bench.choose(3, 6)))
            found.append((short["seconds"], long["seconds"]))
            substeps = long["substeps"] - short["substeps"]
    # The least difference would be that of a short run that was disturbed.
    seconds = {threads: min(long for _, long in found) - min(short for short, _ in found) for threads, found in runs.items()}
    for threads, found in seconds.items():
        speed_up = seconds[1] / found
        bench.table.add("explicit fold", "couplet", "8x30x75", setting=f"{threads} threads", family=bench.family,
                        speed_up=speed_up, wall_seconds=found, target="speed-up 1.8" if threads == 2 else "",
                        note=f"{found:.2f} s, {substeps:.0f} substeps, speed-up {speed_up:.2f}")
