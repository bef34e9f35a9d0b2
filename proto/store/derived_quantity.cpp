#include "proto/store/derived_quantity.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "proto/report/failure.hpp"
#include "proto/store/cycles.hpp"
#include "proto/store/spectral_line.hpp"
#include "proto/store/uniform_series.hpp"

namespace couplet::store {

namespace {

constexpr int n_cycles_min = 3;

/// The columns and the part of the run that a quantity is about.
struct Evidence {
  const v1::Quantity& quantity;
  const Table& history;

  const std::vector<double>& time() const { return history.values[history.find("time")]; }
  double until() const { return quantity.has_until() ? quantity.until() : time().back(); }
  double from() const {
    return until() - (quantity.has_window() ? quantity.window() : 0.5 * (until() - time().front()));
  }
  UniformSeries series(const std::string& column) const {
    return part_between(time(), history.values[history.find(column)], from(), until());
  }
  UniformSeries scaled_column() const {
    UniformSeries result = series(quantity.column());
    result.values *= quantity.factor();
    return result;
  }
  SpectralLine main_line(const UniformSeries& series) const {
    return find_main_line(series, quantity.frequency_from(), quantity.frequency_to());
  }
};

std::vector<Cycle> whole_cycles(const Evidence& evidence, const UniformSeries& series) {
  auto cycles = cut_cycles(series, 1 / evidence.main_line(series).frequency);
  if (cycles.size() < n_cycles_min)
    throw report::NumericsError("history", "only " + std::to_string(cycles.size()) + " whole cycles lie in the window",
                                "run longer or take a longer window");
  return cycles;
}

/// Mean and standard deviation of one number per cycle.
void set_from_cycles(SummaryQuantity& result, const std::vector<Cycle>& cycles,
                     const std::function<double(const Cycle&)>& number) {
  const auto count = static_cast<double>(cycles.size());
  double sum = 0, squares = 0;
  for (const Cycle& cycle : cycles) sum += number(cycle);
  const double mean = sum / count;
  for (const Cycle& cycle : cycles) squares += std::pow(number(cycle) - mean, 2);
  result.value = mean;
  result.spread = std::sqrt(squares / (count - 1));
  result.n_cycles = count;
}

void set_frequency(SummaryQuantity& result, const Evidence& evidence) {
  const UniformSeries series = evidence.scaled_column();
  const SpectralLine line = evidence.main_line(series);
  set_from_cycles(result, whole_cycles(evidence, series), [](const Cycle& cycle) { return 1 / cycle.duration; });
  result.value = line.frequency;
  result.unit = "Hz";
}

void set_line_amplitude(SummaryQuantity& result, const Evidence& evidence) {
  const UniformSeries series = evidence.scaled_column();
  const SpectralLine line = evidence.main_line(series);
  result.value = line.amplitude;
  result.n_cycles = std::floor(line.frequency * series.duration());
}

/// In (-180, 180] degrees; a positive one says that the column leads: it peaks earlier than the reference.
void set_phase(SummaryQuantity& result, const Evidence& evidence) {
  const UniformSeries series = evidence.scaled_column();
  const SpectralLine reference = evidence.main_line(evidence.series(evidence.quantity.reference()));
  const double degrees = (line_at(series, reference.frequency).phase - reference.phase) * 180 / std::numbers::pi;
  result.value = degrees - 360 * std::ceil((degrees - 180) / 360);
  result.unit = "deg";
  result.n_cycles = std::floor(reference.frequency * series.duration());
}

/// Over whole cycles where there are any; a column that does not oscillate has its plain mean over the window.
void set_mean(SummaryQuantity& result, const Evidence& evidence) {
  const UniformSeries series = evidence.scaled_column();
  std::vector<Cycle> cycles;
  try {
    cycles = whole_cycles(evidence, series);
  } catch (const report::NumericsError&) {
    result.value = series.values.mean();
    return;
  }
  set_from_cycles(result, cycles, [](const Cycle& cycle) { return cycle.mean; });
  double integral = 0, duration = 0;
  for (const Cycle& cycle : cycles) {
    integral += cycle.mean * cycle.duration;
    duration += cycle.duration;
  }
  result.value = integral / duration;
}

/// The samples of the window as they stand in the history, at least one, times the factor.
std::vector<double> samples(const Evidence& evidence) {
  const auto& time = evidence.time();
  const auto& column = evidence.history.values[evidence.history.find(evidence.quantity.column())];
  const double from = evidence.from(), until = evidence.until(), round_off = 1e-9 * std::abs(until);
  const auto after = std::upper_bound(time.begin(), time.end(), until + round_off) - time.begin();
  if (after == 0) throw report::NumericsError("history", "it has no row up to the end of the window", "run longer");
  const auto first = std::lower_bound(time.begin(), time.begin() + after - 1, from - round_off) - time.begin();
  std::vector<double> values(column.begin() + first, column.begin() + after);
  for (double& value : values) value *= evidence.quantity.factor();
  return values;
}

}  // namespace

SummaryQuantity derive_quantity(const v1::Quantity& quantity, const Table& history) {
  const Evidence evidence{quantity, history};
  SummaryQuantity result{.name = quantity.name(), .unit = history.columns[history.find(quantity.column())].unit};
  if (quantity.has_result_unit()) result.unit = quantity.result_unit();
  if (history.n_rows() == 0) throw report::NumericsError("history", "it has no rows", "run longer");
  const double offset = quantity.offset();
  const auto by_cycle = [&](const std::function<double(const Cycle&)>& number) {
    const UniformSeries series = evidence.scaled_column();
    set_from_cycles(result, whole_cycles(evidence, series), number);
  };
  switch (quantity.kind()) {
    case v1::Quantity::FREQUENCY:
      set_frequency(result, evidence);
      break;
    case v1::Quantity::LINE_AMPLITUDE:
      set_line_amplitude(result, evidence);
      break;
    case v1::Quantity::PHASE_DELAY:
      set_phase(result, evidence);
      break;
    case v1::Quantity::MEAN:
      set_mean(result, evidence);
      result.value -= offset;
      break;
    case v1::Quantity::FINAL:
      result.value = samples(evidence).back() - offset;
      break;
    case v1::Quantity::LARGEST:
      result.value = std::ranges::max(samples(evidence)) - offset;
      break;
    case v1::Quantity::SMALLEST:
      result.value = std::ranges::min(samples(evidence)) - offset;
      break;
    case v1::Quantity::MAXIMUM:
      by_cycle([&](const Cycle& cycle) { return cycle.largest - offset; });
      break;
    case v1::Quantity::PEAK_TO_PEAK:
      by_cycle([](const Cycle& cycle) { return cycle.largest - cycle.smallest; });
      break;
  }
  return result;
}

}  // namespace couplet::store
