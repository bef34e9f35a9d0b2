"""Modes: a clamped beam against beam theory, a vocal fold against another finite-element program."""

import csv
import subprocess
from pathlib import Path

import numpy

import stored_runs as runs
from solid_scene import around, body, box, saint_venant_kirchhoff, scene


def frequencies(options, name, solid, count):
    """Frequencies of the modes [Hz], by `solid-server modes`, their direction shares, and the folder."""
    folder = Path(options.out).resolve() / name
    path = folder.with_name(name + ".txtpb")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(scene(name, 1.0, 0.1, solid + f"  modes {{ count: {count} }}\n"))
    subprocess.run(["rm", "-rf", str(folder)], check=True)
    program = Path(options.couplet).with_name("solid-server")
    done = subprocess.run([str(program), "modes", str(path), "--out", str(folder)], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{name}: exit code {done.returncode}: {done.stderr.strip().splitlines()[-1]}")
    print(f"  {name} done", flush=True)
    with open(folder / "modes.csv") as file:
        table = list(csv.DictReader(file))
    return [(float(row["frequency [Hz]"]), [float(row[f"share.{axis} [1]"]) for axis in "xyz"]) for row in table], folder


def timoshenko_frequencies(slenderness, poisson_ratio, wave_speed, length, count):
    """Bending of a clamped-free beam of square section, with shear and rotatory inertia [Timoshenko 1921]; Cowper's shear coefficient
    k = 10 (1 + nu) / (12 + 11 nu) [Cowper 1966, table 1]. `slenderness` is length over height. Collocation on Chebyshev points
    [Trefethen 2000, ch. 9] of W'' - phi' = -s W, phi'' + g (W' - phi) = -r phi over a beam of length 1."""
    shear = 10 * (1 + poisson_ratio) / (12 + 11 * poisson_ratio) / (2 * (1 + poisson_ratio))  # k G / E
    gyration = 1 / 12 / slenderness**2  # I / (A L^2)
    n = 40
    x = numpy.cos(numpy.pi * numpy.arange(n + 1) / n)
    c = numpy.r_[2, numpy.ones(n - 1), 2] * (-1.0) ** numpy.arange(n + 1)
    X = x[:, None] - x[None, :]
    D = numpy.outer(c, 1 / c) / (X + numpy.eye(n + 1))
    D -= numpy.diag(D.sum(1))
    D *= 2  # to 0 .. 1, from tip (first) to root (last)
    one, zero = numpy.eye(n + 1), numpy.zeros((n + 1, n + 1))
    # Rows: deflection, rotation. Unknowns W and phi; eigenvalue (omega L / c)^2, c^2 = E / rho.
    stiffness = -numpy.block([[shear * D @ D, -shear * D], [shear / gyration * D, D @ D - shear / gyration * one]])
    mass = numpy.eye(2 * n + 2)
    for row, condition in ((n, [one[n], zero[n]]), (2 * n + 1, [zero[n], one[n]]), (0, [D[0], -one[0]]), (n + 1, [zero[0], D[0]])):
        stiffness[row], mass[row] = numpy.concatenate(condition), 0
    held = [0, n, n + 1, 2 * n + 1]
    free = [i for i in range(2 * n + 2) if i not in held]
    onto = -numpy.linalg.solve(stiffness[numpy.ix_(held, held)], stiffness[numpy.ix_(held, free)])
    reduced = stiffness[numpy.ix_(free, free)] + stiffness[numpy.ix_(free, held)] @ onto
    squares = numpy.linalg.eigvals(reduced)
    squares = numpy.sort(squares[abs(squares.imag) < 1e-6 * abs(squares)].real)
    return numpy.sqrt(squares[squares > 0][:count]) * wave_speed / length / (2 * numpy.pi)


def beam_rows(options, reference):
    """With Poisson's ratio 0 a clamped end of a solid is that of a beam. With 0.3 it cannot contract sideways, which a beam's can: reported,
    without a band."""
    wave_speed = (15e3 / 1040) ** 0.5
    euler = numpy.array([1.87510407, 4.69409113, 7.85475744]) ** 2 * wave_speed / numpy.sqrt(12) / 10 / (2 * numpy.pi)
    for poisson_ratio in (0.0, 0.3):
        expected = timoshenko_frequencies(10, poisson_ratio, wave_speed, 1.0, 3)
        for elements in ((20, 2, 2),) if options.quick else ((5, 1, 1), (10, 1, 1), (10, 2, 2), (20, 2, 2), (40, 4, 4)):
            name = f"cantilever_modes-{poisson_ratio}-" + "x".join(map(str, elements))
            modes, folder = frequencies(options, name, body("beam", box((1, 0.1, 0.1), elements), saint_venant_kirchhoff(15e3, poisson_ratio, 1040),
                                                            'fixed: "x_min"'), 12)
            varied = {"mesh": "x".join(map(str, elements)), "poisson_ratio": poisson_ratio}
            is_gate = poisson_ratio == 0 and elements[0] >= 20
            for i in range(3):
                ours = min((f for f, share in modes if share[0] < 0.5), key=lambda f: abs(f - expected[i]))  # not the one along the beam
                # What Timoshenko's theory leaves out is of the order of the square of what it adds to Euler's; the mesh adds 0.02 %.
                band = around(expected[i], (euler[i] / expected[i] - 1) ** 2 + 2e-4) if is_gate else None
                yield runs.row(name, f"f{i + 1}", ours, expected[i], "Timoshenko beam, Cowper's coefficient", folder, band, **varied)
            along = min((f for f, share in modes if share[0] > 0.5), key=lambda f: abs(f - wave_speed / 4))
            # Exact for this ratio: c / (4 L). A quadratic element over a twentieth of the length errs by (omega h / c)^4 / 1440 = 3e-8.
            yield runs.row(name, "f_along", along, wave_speed / 4, "bar", folder, around(wave_speed / 4, 1e-6) if is_gate else None, **varied)


def fold_rows(options, reference):
    expected = [reference["vocal_fold_T1.75", "see vocal_fold_geometry.md", name] for name in ("f1 x", "f2 x antisym", "f3 z", "f4 y")]
    found = []
    for elements in ((6, 9, 12),) if options.quick else ((4, 6, 8), (6, 9, 12), (9, 14, 18)):
        name = "fold_modes-" + "x".join(map(str, elements))
        mesh = ("vocal_fold { medial_thickness: 1.75e-3  " + "  ".join(f"elements_{a}: {n}" for a, n in zip("xyz", elements)) + " }")
        modes, folder = frequencies(options, name, body("fold", mesh, saint_venant_kirchhoff(15e3, 0.475, 1040), 'fixed: "lateral"',
                                                        'fixed: "anterior"', 'fixed: "posterior"'), 4)
        found.append([frequency for frequency, share in modes[:4]])
        for i, value in enumerate(expected):
            yield runs.row(name, f"f{i + 1}", found[-1][i], value, "CalculiX 2.20, extrapolated over meshes", folder, mesh="x".join(map(str, elements)))
    if len(found) == 3:
        coarse, middle, fine = numpy.array(found)
        limit = fine - (middle - fine) ** 2 / (coarse - 2 * middle + fine)  # errors that fall by one factor from mesh to mesh [Aitken 1926]
        for i, value in enumerate(expected):
            # The reference is extrapolated likewise, from meshes of which the finest two differ by 0.2 %.
            yield runs.row("fold_modes-extrapolated", f"f{i + 1}", limit[i], value, "CalculiX 2.20, extrapolated over meshes", folder, around(value, 0.002))


def rows(options, reference):
    yield from beam_rows(options, reference)
    yield from fold_rows(options, reference)
