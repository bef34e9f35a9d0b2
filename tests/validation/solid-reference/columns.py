"""Free motion without dissipation: bending and twisting columns, a spinning block. The references of the columns are finite-element runs."""

import h5py
import numpy

import stored_runs as runs
from solid_scene import body, box, neo_hookean, probe, saint_venant_kirchhoff, scene, solve

SIDE, HEIGHT, DENSITY = 1.0, 6.0, 1100.0
SOURCE = "finite elements elsewhere (prototype), no gate"


def column(options, name, n, poisson_ratio, kick, end, step, extra=""):
    mesh = box((SIDE, HEIGHT, SIDE), (n, 6 * n, n))
    text = scene(name, end, step, body("column", mesh, neo_hookean(17e6, poisson_ratio, DENSITY), 'fixed: "y_min"')
                 + f"  kick {{ time: 0  velocity {{ {kick} }} }}\n", extra, probe("corner", (SIDE, HEIGHT, SIDE)))
    return solve(options, name, text)


def at(history, column, time):
    return history[column][abs(history["time"] - time).argmin()]


def energy_drift(history, start=None):
    """From the first row on, unless the energy at the start is known; without dissipation all of it is an error of the time integration."""
    total = history["solid.kinetic_energy"] + history["solid.strain_energy"]
    return abs(total / (start or total[0]) - 1).max()


def bending_rows(options):
    expected = {0.5: (2.848, -1.237), 1.0: (-1.099, None), 1.5: (-2.765, -0.444)}
    for n in (2, 4) if options.quick else (2, 4, 6):
        name = f"bending_column-{n}"
        history, folder = column(options, name, n, 0.45, 'x: "10*y/6"', 1.5, 0.002)
        for time, values in expected.items():
            for axis, value in zip("xy", values):
                if value is not None:
                    yield runs.row(name, f"corner_{axis}_at_{time}", at(history, f"corner.{axis}", time), value, SOURCE, folder, mesh=n)
        top = history["corner.x"].argmax()
        yield runs.row(name, "largest_x", history["corner.x"][top], 2.876, SOURCE, folder, mesh=n)
        yield runs.row(name, "time_of_largest_x", history["time"][top], 0.456, SOURCE, folder, mesh=n)
        yield runs.row(name, "energy_drift", energy_drift(history), 0, "no dissipation", folder, mesh=n)


def twisting_rows(options):
    kick = 'x: "105*sin(pi*y/12)*(z - 0.5)"  z: "-105*sin(pi*y/12)*(x - 0.5)"'
    start = 0.5 * DENSITY * 105**2 * HEIGHT / 2 / 6  # half of rho omega^2 r^2
    for n in (4,) if options.quick else (4, 6, 8):
        name = f"twisting_column-{n}"
        history, folder = column(options, name, n, 0.495, kick, 0.3, 0.0005)
        for axis, value in zip("xyz", (-1.113, -0.090, -0.150)):
            yield runs.row(name, f"corner_{axis}_at_0.05", at(history, f"corner.{axis}", 0.05), value, SOURCE, folder, mesh=n)
        for axis, value in zip("xyz", (-0.178, 0.026, 0.127)):
            yield runs.row(name, f"corner_{axis}_at_0.1", at(history, f"corner.{axis}", 0.1), value, SOURCE + ", not converged", folder, mesh=n)
        for time, value in ((0.05, 0.445), (0.10, 0.054), (0.15, 0.681)):
            yield runs.row(name, f"kinetic_share_at_{time}", at(history, "solid.kinetic_energy", time) / start, value, SOURCE, folder, mesh=n)
        # Of second order in h omega, where the motion has some 20 rad/s and a substep is below 3e-4 s: (h omega)^2 = 4e-5. A step beyond
        # the stable one multiplies the energy within some hundred substeps.
        yield runs.row(name, "energy_drift", energy_drift(history), 0, "stable recoil with the default substep", folder, (0, 1e-4), mesh=n)


def block_masses(cells, mass):
    """HRZ masses of the corners and midside nodes of an element of a cube of cells^3 equal elements: the diagonal of the consistent mass,
    scaled to the element's mass. [Hinton, Rock, Zienkiewicz 1976]"""
    points, weights = numpy.polynomial.legendre.leggauss(5)
    grid = numpy.array(numpy.meshgrid(points, points, points, indexing="ij"))
    weight = numpy.einsum("i,j,k->ijk", weights, weights, weights)
    x, y, z = grid
    corner = (1 + x) * (1 + y) * (1 + z) * (x + y + z - 2) / 8
    middle = (1 - x**2) * (1 + y) * (1 + z) / 4
    diagonal = numpy.array([(weight * corner**2).sum(), (weight * middle**2).sum()])
    return diagonal / (8 * diagonal[0] + 12 * diagonal[1]) * mass / cells**3


def newest_checkpoint(folder):
    return max(folder.glob("checkpoint/step-*/alone.h5"), key=lambda path: path.stat().st_mtime)


def spin_rows(options):
    cells, omega, end = 4, 20.0, 0.5 if options.quick else 2.0
    name = f"free_spin-{end}s"
    n_steps = round(end / 0.002)
    text = scene(name, end, 0.002, body("block", box((1, 1, 1), (cells,) * 3), saint_venant_kirchhoff(17e6, 0.3, DENSITY))
                 + f'  kick {{ time: 0  velocity {{ x: "-{omega}*(y - 0.5)"  y: "{omega}*(x - 0.5)" }} }}\n',
                 "", probe("corner", (1, 1, 1)) + f"  results_interval: {end}\n  checkpoints {{ every_steps: {n_steps} }}\n")
    history, folder = solve(options, name, text)
    with h5py.File(folder / "results" / "block.h5") as file:
        position = file["mesh/position"][:]
        cell = file["mesh/cell"][:]
    share = block_masses(cells, DENSITY)
    mass = numpy.zeros(len(position))
    numpy.add.at(mass, cell[:, :8], share[0])
    numpy.add.at(mass, cell[:, 8:], share[1])
    from_centre = position - 0.5
    velocity = omega * numpy.stack([-from_centre[:, 1], from_centre[:, 0], 0 * mass], axis=1)
    before = (mass[:, None] * numpy.cross(from_centre, velocity)).sum(0)
    with h5py.File(newest_checkpoint(folder)) as file:  # in double precision, where results are in single
        after = (mass[:, None] * numpy.cross(from_centre + file["displacement"][:], file["velocity"][:])).sum(0)
    start = 0.5 * (mass * (velocity**2).sum(1)).sum()
    varied = {"mesh": cells, "substeps": history["solid.substeps"].sum()}
    yield runs.row(name, "energy_error", energy_drift(history, start), 6.9e-5, "worst; prototype", folder, (0, 1e-4), **varied)
    # Each substep adds round-off of about 1e-16 to a sum over 425 nodes; they add up like a random walk, at worst in line: 4600 of them.
    yield runs.row(name, "angular_momentum_error", abs(after - before).max() / abs(before).max(), 0, "no torque", folder, (0, 1e-12), **varied)


def rows(options, reference):
    yield from bending_rows(options)
    yield from twisting_rows(options)
    yield from spin_rows(options)
