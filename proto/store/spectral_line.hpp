#pragma once
// The main line in the spectrum of a series, and the strength and phase of a series at a frequency.

#include "proto/store/uniform_series.hpp"

namespace couplet::store {

/// value(t) = amplitude cos(2 pi frequency (t - start) + phase)
struct SpectralLine {
  double frequency = 0;  // [Hz]
  double amplitude = 0;  // in the unit of the series
  double phase = 0;      // [rad], in (-pi, pi]
};

/// The highest line between two frequencies: mean and straight trend removed, Hann window, zero padding to at least 8
/// times the length, parabola through the logarithm of the peak and its neighbours. Throws NumericsError when there is
/// no peak between the two, or fewer than 3 periods of it fit into the series.
SpectralLine find_main_line(const UniformSeries& series, double frequency_from, double frequency_to);

/// Amplitude and phase at a given frequency, with the same window.
SpectralLine line_at(const UniformSeries& series, double frequency);

}  // namespace couplet::store
