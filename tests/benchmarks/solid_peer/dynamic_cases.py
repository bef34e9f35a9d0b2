"""Motion: the flag that falls (CSM3), one implicit step of a cube, steps of three leaflets."""

import numpy

import calculix
import couplet
import static_cases

# Mean and amplitude of the tip [m], frequency [Hz] for each step [s]: featflow's finest mesh, and Feel++ (P4), as their
# authors' tables print them. They differ by 0.7 % in amplitude and 0.3 % in frequency: several modes vibrate, undamped, and
# the highest and lowest point of a period differ from period to period.
PUBLISHED = {"featflow": {0.02: (-64.371e-3, 64.695e-3, 1.0956), 0.01: (-64.766e-3, 64.948e-3, 1.0978),
                          0.005: (-63.607e-3, 65.160e-3, 1.0995)},
             "feelpp": {0.005: (-64.095e-3, 65.640e-3, 1.0966)}}
# Lowest point of the first swing [m]: ours with 160 x 16 elements and steps of 5, 2.5 and 1.25 ms, between -129.609e-3 and
# -129.638e-3.
FIRST_SWING = -129.63e-3
# Spectral radius 0.9 is the damping of CalculiX' alpha = -0.05: rho = (1 + alpha)/(1 - alpha).
SPECTRAL_RADIUS, ALPHA = 0.9, -0.05


def extremum(time, y, i):
    """Time and value where a parabola through three points turns."""
    a, b, c = y[i - 1], y[i], y[i + 1]
    shift = (a - c) / (2 * (a - 2 * b + c))
    return time[i] + shift * (time[1] - time[0]), b - (a - c) * shift / 4


def minima(time, y):
    """Lowest points of the swings: deeper than half of the deepest."""
    return [extremum(time, y, i) for i in range(1, len(y) - 1)
            if y[i] < y[i - 1] and y[i] <= y[i + 1] and y[i] < 0.75 * y.min()]


def last_period(time, y):
    """Mean and amplitude from the highest and lowest point between the last two minima; frequency of all swings."""
    lowest = minima(time, y)
    during = (time > lowest[-2][0]) & (time < lowest[-1][0])
    i = int(numpy.flatnonzero(during)[numpy.argmax(y[during])])
    high, low = extremum(time, y, i)[1], lowest[-1][1]
    return (high + low) / 2, (high - low) / 2, (len(lowest) - 1) / (lowest[-1][0] - lowest[0][0])


def swinging_flag(nx, ny, step, end):
    gravity = "gravity { direction { y: -1 } " + couplet.constant(2) + " }"
    return couplet.scene(static_cases.flag_body(1.4e6, nx, ny), gravity, end, step, "GENERALIZED_ALPHA",
                         'probe { name: "A" at { marker: "A" } }', f"spectral_radius: {SPECTRAL_RADIUS}")


def tip_of(solved):
    time = numpy.array([t for t, _ in solved.displacement])
    return time, numpy.array([next(iter(values.values()))[1] for _, values in solved.displacement])


def swinging_deck(mesh, step, end):
    return (static_cases.flag_deck(mesh, calculix.REDUCED, 1.4e6).dynamic(step, end, ALPHA).gravity(2, (0, -1, 0))
            .print_displacement("OBSERVED", False))


def csm3(bench):
    """Ten seconds of the falling flag: last period against the published ones, milliseconds a step."""
    bench.family = "csm3"
    for nx, ny, step in bench.choose([(20, 2, 0.01)], [(20, 2, 0.02), (20, 2, 0.01), (20, 2, 0.005), (40, 4, 0.01), (40, 4, 0.005)]):
        name = f"{nx}x{ny}"
        ours = bench.solve(swinging_flag(nx, ny, step, 10), "CSM3", name, step, repeats=2)
        if ours.code != 0:
            bench.table.failed("CSM3", "couplet", name, ours, family=bench.family)
            continue
        add_periods(bench, "couplet", name, step, ours, ours.history["time"], ours.history["A.y"],
                    int(ours.of_solid["newton_iterations"]), "0.5 %, 0.2 %, 15 ms" if nx == 20 else "")
        if bench.has_peer and nx == 20:
            theirs = calculix.solve(swinging_deck(ours.mesh(), step, 10), bench.folder("CSM3", step, "calculix"))
            if theirs.code != 0:
                bench.table.failed("CSM3", "calculix", name, theirs, family=bench.family)
            else:
                add_periods(bench, "calculix", name, step, theirs, *tip_of(theirs), theirs.n_iterations)


def add_periods(bench, program, name, step, solved, time, y, n_iterations, target=""):
    """Errors against what was published for this step; the column is that of the amplitude."""
    mean, amplitude, frequency = last_period(time, y)
    errors = {f"{what}_error_{who}": found / number - 1 for who, published in PUBLISHED.items() if step in published
              for what, found, number in zip(("mean", "amplitude", "frequency"), (mean, amplitude, frequency),
                                             published[step])}
    ms = 1e3 * solved.core_seconds / len(time)
    bench.table.add("CSM3", program, name, setting=f"step {step:g} s", error=abs(errors["amplitude_error_featflow"]),
                    core_seconds=solved.core_seconds, iterations=n_iterations, target=target, ms_per_step=ms, mean=mean,
                    amplitude=amplitude, frequency=frequency, family=bench.family, **errors,
                    note=f"{1e3 * mean:.2f} +- {1e3 * amplitude:.2f} mm, {frequency:.4f} Hz "
                         f"({100 * errors['frequency_error_featflow']:+.2f} %), {ms:.2f} ms")


def first_swing(bench):
    """Its depth against that of a fine mesh."""
    bench.family = "dynamic"
    for nx, ny, step in bench.choose([(10, 1, 0.02), (20, 2, 0.01)],
                                     [(10, 1, 0.02), (20, 2, 0.01), (40, 4, 0.005), (80, 8, 0.005)]):
        name, setting = f"{nx}x{ny}", f"step {step:g} s"
        ours = bench.solve(swinging_flag(nx, ny, step, 0.6), "first swing", name)
        if ours.code != 0:
            bench.table.failed("first swing", "couplet", name, ours, family=bench.family)
            continue
        add_swing(bench, "couplet", name, setting, ours, ours.history["time"], ours.history["A.y"],
                  int(ours.of_solid["newton_iterations"]))
        if bench.has_peer:
            theirs = calculix.solve(swinging_deck(ours.mesh(), step, 0.6), bench.folder("first swing", name, "calculix"))
            add_swing(bench, "calculix", name, setting, theirs, *tip_of(theirs), theirs.n_iterations)


def add_swing(bench, program, name, setting, solved, time, y, n_iterations):
    depth = minima(time, y)[0][1]
    bench.table.add("first swing", program, name, setting=setting, error=abs(depth / FIRST_SWING - 1), depth=depth,
                    core_seconds=solved.core_seconds, iterations=n_iterations, family=bench.family,
                    note=f"{1e3 * depth:.3f} mm, {1e3 * solved.core_seconds / len(time):.2f} ms a step")


def cube(bench):
    """One implicit step of a soft cube of n^3 elements that starts to fall sideways."""
    bench.family = "implicit step"
    n = bench.choose(8, 17)
    body = (f"box {{ length {{ x: 0.01 y: 0.01 z: 0.01 }} elements_x: {n} elements_y: {n} elements_z: {n} }} fixed: \"z_min\" "
            + couplet.saint_venant_kirchhoff(15e3, 0.475, 1040))
    gravity = "gravity { direction { x: 1 } " + couplet.constant(9.81) + " }"
    ours = bench.solve(couplet.scene(body, gravity, 1e-4, 1e-4, "GENERALIZED_ALPHA"), "cube")
    mesh = ours.mesh()
    corner = mesh.nearest((0.01, 0.01, 0.01))
    moved = ours.displacement()[corner, 0]
    bench.table.add("cube, a step", "couplet", f"{n}^3", core_seconds=ours.core_seconds, family=bench.family, moved=moved,
                    iterations=int(ours.of_solid["newton_iterations"]), note=f"corner moves {moved:.5e} m",
                    target="25 core s, 2 iterations" if n == 17 else "",
                    memory_bytes=ours.of_solid["peak_memory_bytes"])
    if not bench.has_peer:
        return
    deck = (calculix.Deck(mesh, calculix.REDUCED).hold(mesh.nodes_where(lambda x, y, z: z < 1e-9)).nodes("OBSERVED", [corner])
            .saint_venant_kirchhoff(15e3, 0.475, 1040).dynamic(1e-4, 1e-4, ALPHA).gravity(9.81, (1, 0, 0))
            .print_displacement("OBSERVED"))
    theirs = calculix.solve(deck, bench.folder("cube", "calculix"))
    moved = theirs.displacement[-1][1][corner][0]
    bench.table.add("cube, a step", "calculix", f"{n}^3", core_seconds=theirs.core_seconds, iterations=theirs.n_iterations,
                    family=bench.family, moved=moved, note=f"corner moves {moved:.5e} m")


def leaflets(bench):
    """Three leaflets under a rising pressure: seconds of a later step, the first one and the set-up left out."""
    bench.family = "implicit step"
    sizes, counts = (24, 20, 2), bench.choose((2, 7), (2, 12))
    body = ("valve {{ elements_u: {} elements_v: {} elements_t: {} }} fixed: \"base\" fixed: \"commissure\" ".format(*sizes)
            + couplet.saint_venant_kirchhoff(1.5e6, 0.4, 1000))
    load = ('pressure { surface: "ventricular" value { row { time: 0 value: 0 } row { time: 0.01 value: 200 } } }')
    name = "x".join(map(str, sizes))
    for threads in (1, 2):
        short, long = (bench.solve(couplet.scene(body, load, steps * 2e-4, 2e-4, "GENERALIZED_ALPHA"), "leaflets", threads,
                                   threads=threads) for steps in counts)
        if long.code != 0:
            bench.table.failed("leaflets, a step", "couplet", name, long)
            return
        per_step = {key: (long.of_solid[key] - short.of_solid[key]) / (counts[1] - counts[0])
                    for key in ("seconds", "newton_iterations", "factorisations")}
        bench.table.add("leaflets, a step", "couplet", name, setting=f"{threads} threads", family=bench.family,
                        core_seconds=(long.core_seconds - short.core_seconds) / (counts[1] - counts[0]), wall_seconds=per_step["seconds"],
                        iterations=round(per_step["newton_iterations"]), elements=long.of_solid["elements"],
                        factorisations_per_step=per_step["factorisations"],
                        note=f"{per_step['seconds']:.2f} s wall, {per_step['factorisations']:.1f} factorisations",
                        target="1.5 s wall, 3 iterations" if threads == 2 else "")
