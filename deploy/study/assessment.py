"""What a study found for one quantity: order along every axis, the extrapolated value, the error of every run, the cheapest
run for a wanted error."""

import numpy

from convergence import observe


class Assessment:
    """`along[i]`: convergence along axis i with all others at their finest; None where its levels are no numbers.
    `errors[k]`: error of run k against the reference, relative where that is not zero; None for a run without the quantity."""

    def __init__(self, quantity, axes, runs, use_finest):
        self.quantity = quantity
        self.unit = next((run.units[quantity] for run in runs if quantity in run.units), "1")
        values = {run.combination.indices: run.values.get(quantity) for run in runs}
        self.finest = finest_indices(axes)
        self.finest_value = values.get(self.finest)
        self.along = [along(axes, i, self.finest, values) for i in range(len(axes))]
        self.value, self.uncertainty = self._extrapolate()
        self.is_extrapolated = not use_finest and self.value is not None and any(c and c.is_trusted for c in self.along)
        self.reference = self.value if self.is_extrapolated else self.finest_value
        self.errors = [self._error(values[run.combination.indices]) for run in runs]

    def _extrapolate(self):
        """The finest value plus what every axis still lacks; the uncertainties of the axes add up."""
        if self.finest_value is None:
            return None, None
        observed = [c for c in self.along if c is not None]
        value = self.finest_value + sum(c.value - self.finest_value for c in observed if c.is_trusted)
        uncertainties = [c.uncertainty for c in observed]
        return value, sum(uncertainties) if uncertainties and None not in uncertainties else None

    def _error(self, value):
        if value is None or self.reference is None:
            return None
        return abs(value - self.reference) / (abs(self.reference) or 1.0)


def finest_indices(axes):
    """The finest level of every axis; the last one where levels are no numbers."""
    return tuple(len(axis.levels) - 1 if axis.sizes() is None else int(numpy.argmin(axis.sizes())) for axis in axes)


def along(axes, i, finest, values):
    sizes = axes[i].sizes()
    if sizes is None or len(sizes) < 2:
        return None
    line = [values.get(finest[:i] + (k,) + finest[i + 1:]) for k in range(len(sizes))]
    return observe(sizes, line)


def cheapest(runs, assessments, wanted):
    """The run of least cost whose errors in all quantities are at most `wanted`; None when there is none."""
    good = [(run.cost, k) for k, run in enumerate(runs) if run.cost is not None and
            all(a.errors[k] is not None and a.errors[k] <= wanted for a in assessments)]
    return runs[min(good)[1]] if good else None


def efficient(runs, errors):
    """Runs that no other run beats in both cost and error, by rising cost."""
    front, best = [], numpy.inf
    for cost, error, k in sorted((run.cost, errors[k], k) for k, run in enumerate(runs) if run.cost is not None and errors[k] is not None):
        if error < best:
            front.append(k)
            best = error
    return front
