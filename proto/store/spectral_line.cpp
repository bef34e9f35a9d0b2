#include "proto/store/spectral_line.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <unsupported/Eigen/FFT>

#include "proto/report/failure.hpp"

namespace couplet::store {

namespace {

using std::numbers::pi;

/// Hann window over n samples: w_k = sin^2(pi (k + 1/2) / n).
Eigen::VectorXd hann(Eigen::Index n) {
  Eigen::VectorXd weights(n);
  for (Eigen::Index k = 0; k < n; ++k)
    weights(k) = std::pow(std::sin(pi * (static_cast<double>(k) + 0.5) / static_cast<double>(n)), 2);
  return weights;
}

/// The series without its mean and straight trend (least squares), times the window.
Eigen::VectorXd windowed(const UniformSeries& series) {
  const Eigen::Index n = series.values.size();
  const Eigen::VectorXd ramp = Eigen::VectorXd::LinSpaced(n, -1, 1);
  const double mean = series.values.mean();
  const double slope = ramp.dot(series.values) / ramp.squaredNorm();
  return (series.values.array() - mean - slope * ramp.array()) * hann(n).array();
}

Eigen::Index padded_length(Eigen::Index n) {
  Eigen::Index length = 1;
  while (length < 8 * n) length *= 2;
  return length;
}

/// |X_k|, k = 0 ... length / 2.
std::vector<double> magnitudes(const Eigen::VectorXd& signal, Eigen::Index length) {
  std::vector<double> padded(static_cast<std::size_t>(length), 0.0);
  std::copy(signal.data(), signal.data() + signal.size(), padded.begin());
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  fft.fwd(spectrum, padded);
  std::vector<double> result(spectrum.size());
  std::transform(spectrum.begin(), spectrum.end(), result.begin(), [](const auto& x) { return std::abs(x); });
  return result;
}

/// Index of the highest local maximum between two indices; 0 when there is none.
std::size_t highest_peak(const std::vector<double>& magnitude, double from, double to) {
  std::size_t best = 0;
  const auto last = static_cast<std::size_t>(std::clamp(to, 0.0, static_cast<double>(magnitude.size() - 2)));
  for (auto k = static_cast<std::size_t>(std::max(1.0, std::ceil(from))); k <= last; ++k) {
    const bool is_peak = magnitude[k] > magnitude[k - 1] && magnitude[k] >= magnitude[k + 1];
    if (is_peak && (best == 0 || magnitude[k] > magnitude[best])) best = k;
  }
  return best;
}

std::string hertz(double frequency) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g Hz", frequency);
  return text;
}

}  // namespace

SpectralLine find_main_line(const UniformSeries& series, double frequency_from, double frequency_to) {
  const Eigen::VectorXd signal = windowed(series);
  // A series that is constant but for round-off has no line.
  const double round_off = 1e-14 * series.values.cwiseAbs().maxCoeff();
  if (!(signal.cwiseAbs().maxCoeff() > round_off))
    throw report::NumericsError("history", "the column does not change in the window");
  const Eigen::Index length = padded_length(signal.size());
  const auto magnitude = magnitudes(signal, length);
  const double bin = 1 / (static_cast<double>(length) * series.step);  // [Hz]
  const std::size_t peak = highest_peak(magnitude, frequency_from / bin, frequency_to / bin);
  if (peak == 0)
    throw report::NumericsError(
        "history", "the column has no spectral line between " + hertz(frequency_from) + " and " + hertz(frequency_to),
        "widen frequency_from and frequency_to, or run longer");
  const double left = std::log(magnitude[peak - 1]), top = std::log(magnitude[peak]),
               right = std::log(magnitude[peak + 1]);
  const double frequency = bin * (static_cast<double>(peak) + 0.5 * (left - right) / (left - 2 * top + right));
  if (frequency * series.duration() < 3)
    throw report::NumericsError("history",
                                "fewer than 3 cycles of the main line (" + hertz(frequency) + ") lie in the window",
                                "run longer or take a longer window");
  return line_at(series, frequency);
}

SpectralLine line_at(const UniformSeries& series, double frequency) {
  const Eigen::VectorXd signal = windowed(series);
  const Eigen::Index n = signal.size();
  const double turn = 2 * pi * frequency * series.step;  // [rad] a sample
  std::complex<double> sum = 0;
  for (Eigen::Index k = 0; k < n; ++k) sum += signal(k) * std::polar(1.0, -turn * static_cast<double>(k));
  // The weights of the Hann window sum up to n / 2; half of a cosine's amplitude is in the line at +f.
  return {frequency, 4 * std::abs(sum) / static_cast<double>(n), std::arg(sum)};
}

}  // namespace couplet::store
