"""How a quantity converges with one axis: observed order, extrapolated value and its uncertainty.

The model is f(h) = f0 + C h^p. Three levels give it exactly (Richardson), more by weighted least squares. The uncertainty is
a grid convergence index: a safety factor times the distance from the finest value to f0. [Roache 1998, Verification and
Validation in Computational Science and Engineering, ch. 5], [Eca and Hoekstra 2014, J. Comput. Phys. 262, 104]
"""

import numpy

TRUSTED_FACTOR = 1.25  # order observed and sensible [Roache 1998]
DOUBTFUL_FACTOR = 3.0  # otherwise
LOWEST_ORDER, HIGHEST_ORDER = 0.4, 8.0  # beyond these a fit describes noise


class Convergence:
    """Result of a fit. `order` is None where none can be observed, `remark` says why."""

    def __init__(self, value, order, uncertainty, remark=""):
        self.value, self.order, self.uncertainty, self.remark = value, order, uncertainty, remark

    @property
    def is_trusted(self):
        return self.order is not None


def observe(sizes, values):
    """`sizes` of what the levels resolve (any unit) and the quantity at each of them."""
    rows = sorted((h, f) for h, f in zip(sizes, values) if f is not None and numpy.isfinite(f))
    h = numpy.array([row[0] for row in rows])
    f = numpy.array([row[1] for row in rows])
    if len(h) == 0:
        return Convergence(None, None, None, "no value")
    spread = float(numpy.ptp(f[:3]))
    if len(h) < 3:
        remark = "three levels show an order" if len(h) == 2 else "one level only"
        return Convergence(float(f[0]), None, DOUBTFUL_FACTOR * spread if len(h) == 2 else None, remark)
    if spread <= 1e-13 * max(abs(f[0]), 1e-300):
        return Convergence(float(f[0]), None, 0.0, "does not depend on it")
    doubtful = DOUBTFUL_FACTOR * spread
    steps = numpy.diff(f[:3])
    if steps[0] * steps[1] <= 0:
        return Convergence(float(f[0]), None, doubtful, "not monotone: no order")
    order, f0, deviation = _fit(h, f)
    if not LOWEST_ORDER < order < HIGHEST_ORDER:
        return Convergence(float(f[0]), None, doubtful, "the differences do not shrink like a power: no order")
    uncertainty = TRUSTED_FACTOR * abs(f[0] - f0) + deviation
    return Convergence(float(f0), float(order), float(min(uncertainty, doubtful)))


def _fit(h, f):
    """Order, f0 and standard deviation of the fit: the best of a fine list of orders, then a closer look around it."""
    weights = 1 / h  # finer levels tell more
    orders = numpy.linspace(LOWEST_ORDER, HIGHEST_ORDER, 400)
    for _ in range(4):
        misfits = [_misfit(h, f, weights, order)[0] for order in orders]
        best = int(numpy.argmin(misfits))
        low, high = orders[max(best - 1, 0)], orders[min(best + 1, len(orders) - 1)]
        orders = numpy.linspace(low, high, 60)
    order = orders[int(numpy.argmin([_misfit(h, f, weights, order)[0] for order in orders]))]
    misfit, f0 = _misfit(h, f, weights, order)
    deviation = numpy.sqrt(misfit / weights.mean() / max(len(h) - 3, 1)) if len(h) > 3 else 0.0
    return order, f0, deviation


def _misfit(h, f, weights, order):
    """Weighted sum of squares of the best f0 + C h^order, and its f0."""
    root = numpy.sqrt(weights)
    columns = numpy.stack([numpy.ones_like(h), (h / h.max()) ** order], axis=1)
    solution, *_ = numpy.linalg.lstsq(columns * root[:, None], f * root, rcond=None)
    return float((((columns @ solution - f) * root) ** 2).sum()), float(solution[0])
