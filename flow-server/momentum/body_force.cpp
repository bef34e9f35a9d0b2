#include "flow-server/momentum/body_force.hpp"

namespace couplet::flow {

std::array<double, 3> BodyForce::uniform_change(double time, double weight) const {
  std::array<double, 3> change{};
  for (int d = 0; d < block_.n_dimensions; ++d)
    if (!force_[d].varies_in_space()) change[d] = weight / density_ * force_[d].at({}, time);
  return change;
}

void BodyForce::add(double time, double weight, bool with_uniform, VectorField& velocity) const {
  for (int d = 0; d < block_.n_dimensions; ++d) {
    if (!force_[d].varies_in_space() && (!with_uniform || force_[d].at({}, time) == 0)) continue;
    const Box box = block_.computed_faces(d);
    for (int k = box.begin[2]; k < box.end[2]; ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for_each_interval(block_.faces[d], j, k, box.begin[0], box.end[0], [&](int begin, int end) {
          for (int i = begin; i < end; ++i)
            velocity[d](i, j, k) += weight / density_ * force_[d].at(centre_of_face(block_, d, {i, j, k}), time);
        });
  }
}

}  // namespace couplet::flow
