#pragma once
// A number over time whose rate is known too.

#include <functional>
#include <variant>
#include <vector>

#include "proto/scene/time_table.hpp"

namespace couplet::flow {

/// mean + sum over n = 1, 2, ... of cosine_n cos(2 pi n f t) + sine_n sin(2 pi n f t)
struct FourierSeries {
  double frequency = 1;  // f [Hz]
  double mean = 0;
  std::vector<double> cosine;  // from n = 1
  std::vector<double> sine;    // from n = 1; may differ from cosine in length

  double at(double time) const;
  double rate(double time) const;
};

/// A formula of time. Its rate is a central difference of fourth order over twice `interval` on either side: with a
/// fiftieth of a time step its error is far below that of the step.
struct TimeFormula {
  std::function<double(double time)> value;
  double interval;  // > 0 [s]

  double at(double time) const { return value(time); }
  double rate(double time) const;
};

class TimeFunction {
 public:
  TimeFunction(double constant = 0) : value_(constant) {}
  TimeFunction(scene::TimeTable table) : value_(std::move(table)) {}
  TimeFunction(FourierSeries series) : value_(std::move(series)) {}
  TimeFunction(TimeFormula formula) : value_(std::move(formula)) {}

  double at(double time) const;

  /// Per second. At a row of a table that bends there: of the part that ends there, the one that a step up to then has
  /// gone through.
  double rate(double time) const;

  bool is_constant() const { return std::holds_alternative<double>(value_); }

 private:
  std::variant<double, scene::TimeTable, FourierSeries, TimeFormula> value_;
};

}  // namespace couplet::flow
