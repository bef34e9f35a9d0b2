"""Lines and cycles in a signal whose samples need not be equally spaced."""

import numpy


def resample(time, values, n_most=16384):
    """Equally spaced samples: (step, values)."""
    n = int(min(n_most, max(64, len(time))))
    even = numpy.linspace(time[0], time[-1], n)
    return even[1] - even[0], numpy.interp(even, time, values)


def spectrum(time, values):
    """One-sided amplitude spectrum under a Hann window: (frequency [Hz], amplitude)."""
    step, samples = resample(time, values)
    window = numpy.hanning(len(samples))
    n = 4 * len(samples)  # zeros behind the samples draw the lines smoothly
    amplitude = 2 * numpy.abs(numpy.fft.rfft((samples - samples.mean()) * window, n)) / window.sum()
    return numpy.fft.rfftfreq(n, step), amplitude


def main_frequency(time, values, lowest=20.0, highest=1000.0):
    """Frequency of the main line [Hz]: the peak of a parabola through the highest bin; None without an oscillation, also where the highest
    bin is but the flank of something slower."""
    if len(time) < 16 or time[-1] - time[0] < 2 / highest or numpy.ptp(values) <= 0:
        return None
    frequency, amplitude = spectrum(time, values)
    inside = numpy.flatnonzero((frequency >= lowest) & (frequency <= highest))
    if len(inside) == 0:
        return None
    k = inside[amplitude[inside].argmax()]
    if k > 0 and amplitude[k - 1] > amplitude[k]:
        return None
    if k == 0 or k + 1 >= len(amplitude):
        return float(frequency[k])
    left, peak, right = numpy.log(amplitude[k - 1: k + 2] + 1e-300)
    bend = left - 2 * peak + right
    shift = 0.5 * (left - right) / bend if bend < 0 else 0.0
    return float(frequency[k] + shift * (frequency[1] - frequency[0]))


def thin(time, values, n_bins=900):
    """Smallest and largest value of each bin, in order of time: what a plot of this width can show."""
    if len(time) <= 2 * n_bins:
        return time, values
    edges = numpy.linspace(0, len(time), n_bins + 1).astype(int)
    keep = []
    for first, last in zip(edges[:-1], edges[1:]):
        part = values[first:last]
        keep += sorted({first + int(part.argmin()), first + int(part.argmax())})
    keep = numpy.array(keep)
    return time[keep], values[keep]
