#include "flow-server/immersed/time_function.hpp"

#include <cmath>
#include <numbers>

namespace couplet::flow {

double FourierSeries::at(double time) const {
  const double phase = 2 * std::numbers::pi * frequency * time;
  double sum = mean;
  for (std::size_t n = 0; n < cosine.size(); ++n) sum += cosine[n] * std::cos(static_cast<double>(n + 1) * phase);
  for (std::size_t n = 0; n < sine.size(); ++n) sum += sine[n] * std::sin(static_cast<double>(n + 1) * phase);
  return sum;
}

double FourierSeries::rate(double time) const {
  const double w = 2 * std::numbers::pi * frequency;
  double sum = 0;
  for (std::size_t n = 0; n < cosine.size(); ++n) {
    const double nw = static_cast<double>(n + 1) * w;
    sum -= nw * cosine[n] * std::sin(nw * time);
  }
  for (std::size_t n = 0; n < sine.size(); ++n) {
    const double nw = static_cast<double>(n + 1) * w;
    sum += nw * sine[n] * std::cos(nw * time);
  }
  return sum;
}

double TimeFormula::rate(double time) const {
  // f' = (8 (f(t+d) - f(t-d)) - (f(t+2d) - f(t-2d))) / (12 d) + O(d^4)
  const double near = value(time + interval) - value(time - interval);
  const double far = value(time + 2 * interval) - value(time - 2 * interval);
  return (8 * near - far) / (12 * interval);
}

double TimeFunction::at(double time) const {
  if (const double* constant = std::get_if<double>(&value_)) return *constant;
  if (const auto* table = std::get_if<scene::TimeTable>(&value_)) return table->at(time);
  if (const auto* series = std::get_if<FourierSeries>(&value_)) return series->at(time);
  return std::get<TimeFormula>(value_).at(time);
}

double TimeFunction::rate(double time) const {
  if (std::holds_alternative<double>(value_)) return 0;
  if (const auto* table = std::get_if<scene::TimeTable>(&value_)) return table->rate(time);
  if (const auto* series = std::get_if<FourierSeries>(&value_)) return series->rate(time);
  return std::get<TimeFormula>(value_).rate(time);
}

}  // namespace couplet::flow
