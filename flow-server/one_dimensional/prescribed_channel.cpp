#include "flow-server/one_dimensional/prescribed_channel.hpp"

#include <cmath>
#include <sstream>
#include <utility>

#include "proto/report/failure.hpp"

namespace couplet::flow {

PrescribedChannel::PrescribedChannel(Shape shape, const StationAxis& axis) : shape_(std::move(shape)), axis_(&axis) {
  profile_.exit = shape_.length;
  profile_.contraction_start = shape_.contraction_start;
  profile_.area.setZero(axis.n_stations());
  profile_.perimeter.setZero(axis.n_stations());
}

const SectionProfile& PrescribedChannel::at(double t) {
  for (int k = 0; k < axis_->n_stations(); ++k) {
    const double x = axis_->fraction()[k] * shape_.length;
    const double height = shape_.height(x, t);
    if (!(height > 0) || !std::isfinite(height)) {
      std::ostringstream found;
      found << "the height is " << height << " m at x = " << x << " m, t = " << t << " s";
      throw report::NumericsError("flow.glottis.channel.height", found.str(),
                                  "the height must stay above zero and finite");
    }
    profile_.area[k] = shape_.width * height;
    profile_.perimeter[k] = 2 * (shape_.width + height);
  }
  return profile_;
}

}  // namespace couplet::flow
