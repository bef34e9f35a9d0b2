#pragma once
// A number that may depend on place and time.

#include <array>
#include <functional>
#include <variant>

#include "proto/scene/time_table.hpp"

namespace couplet::flow {

using Point = std::array<double, 3>;  // [m]

class SpaceTimeValue {
 public:
  using Function = std::function<double(const Point&, double time)>;

  SpaceTimeValue(double constant = 0) : value_(constant) {}
  SpaceTimeValue(scene::TimeTable table) : value_(std::move(table)) {}
  SpaceTimeValue(Function function) : value_(std::move(function)) {}

  bool varies_in_space() const { return std::holds_alternative<Function>(value_); }
  bool varies_in_time() const { return !std::holds_alternative<double>(value_); }

  double at(const Point& point, double time) const {
    if (const double* constant = std::get_if<double>(&value_)) return *constant;
    if (const scene::TimeTable* table = std::get_if<scene::TimeTable>(&value_)) return table->at(time);
    return std::get<Function>(value_)(point, time);
  }

 private:
  std::variant<double, scene::TimeTable, Function> value_;
};

using VectorValue = std::array<SpaceTimeValue, 3>;

}  // namespace couplet::flow
