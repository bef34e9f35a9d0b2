"""Inflation of a hollow cylinder or sphere, exactly: a two-point problem in the radius, solved by shooting.

Equilibrium of nominal stresses, dP_r/dR + k (P_r - P_t)/R = 0, P_r = 0 outside; k = 1 for a cylinder in plane strain,
2 for a sphere [Holzapfel 2000, chapter 6]."""

import cmath

STEPS = 200  # of Runge-Kutta through the wall: exact to about 1e-8
PARTS = 4  # in which the radius is brought to its end


def saint_venant_kirchhoff(young_modulus, poisson_ratio):
    """Nominal principal stresses [Pa] of three principal stretches."""
    lame_lambda = young_modulus * poisson_ratio / (1 + poisson_ratio) / (1 - 2 * poisson_ratio)
    lame_mu = young_modulus / 2 / (1 + poisson_ratio)

    def stress(stretch):
        strain = [(s * s - 1) / 2 for s in stretch]
        return [s * (lame_lambda * sum(strain) + 2 * lame_mu * e) for s, e in zip(stretch, strain)]

    return stress


def mooney_rivlin(a10, a01, bulk_modulus):
    def stress(stretch):
        J = stretch[0] * stretch[1] * stretch[2]
        square = [s * s for s in stretch]
        I1 = sum(square)
        I2 = square[0] * square[1] + square[1] * square[2] + square[2] * square[0]
        a, b = cmath.exp(-2 / 3 * cmath.log(J)), cmath.exp(-4 / 3 * cmath.log(J))
        return [a10 * a * (2 * s - 2 / 3 * I1 / s) + a01 * b * (2 * s * (I1 - q) - 4 / 3 * I2 / s)
                + bulk_modulus * (J - 1) * J / s for s, q in zip(stretch, square)]

    return stress


def pressure_for(stress, inner, outer, inner_deformed, is_sphere):
    """Pressure inside [Pa] that takes the inner radius to inner_deformed [m]."""
    k = 2 if is_sphere else 1

    def stretches(radial, around):
        return [radial, around, around if is_sphere else 1.0]

    def rates(R, r, radial):
        """dr/dR and the change of the radial stretch with R; derivatives of the stress by complex steps."""
        around, h = r / R, 1e-30
        P = stress(stretches(radial, around))
        by_radial = stress(stretches(radial + 1j * h, around))[0].imag / h
        by_around = stress(stretches(radial, around + 1j * h))[0].imag / h
        return radial, (-k / R * (P[0] - P[1]).real - by_around * (radial - around) / R) / by_radial

    def outer_stress(radial, r):
        R, h = inner, (outer - inner) / STEPS
        for _ in range(STEPS):
            a = rates(R, r, radial)
            b = rates(R + h / 2, r + h / 2 * a[0], radial + h / 2 * a[1])
            c = rates(R + h / 2, r + h / 2 * b[0], radial + h / 2 * b[1])
            d = rates(R + h, r + h * c[0], radial + h * c[1])
            r += h / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0])
            radial += h / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])
            R += h
        return stress(stretches(radial, r / R))[0].real

    radial = 1.0
    for part in range(1, PARTS + 1):  # each from the solution before
        r = inner + (inner_deformed - inner) * part / PARTS
        before, at_before = radial + 1e-4, outer_stress(radial + 1e-4, r)
        at_radial = outer_stress(radial, r)
        for _ in range(30):  # secant
            before, radial = radial, radial - at_radial * (radial - before) / (at_radial - at_before)
            at_before, at_radial = at_radial, outer_stress(radial, r)
            if abs(radial - before) < 1e-14 or at_radial == at_before:
                break
    around = inner_deformed / inner
    return -stress(stretches(radial, around))[0].real / around**k
