#pragma once
// A channel of rectangular section whose height is given as a function of place and time.

#include <functional>

#include "flow-server/one_dimensional/section_profile.hpp"
#include "flow-server/one_dimensional/station_axis.hpp"

namespace couplet::flow {

class PrescribedChannel {
 public:
  struct Shape {
    double length = 0;                                 // [m]
    double width = 0;                                  // [m]
    std::function<double(double x, double t)> height;  // [m]
    double contraction_start = 0;                      // x_a [m]
  };

  /// From x = 0 to x = length; `axis` must outlive this.
  PrescribedChannel(Shape shape, const StationAxis& axis);

  /// The channel at time t [s]. Throws NumericsError where the height is not above zero.
  const SectionProfile& at(double t);

 private:
  Shape shape_;
  const StationAxis* axis_;
  SectionProfile profile_;
};

}  // namespace couplet::flow
