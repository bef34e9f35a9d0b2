#include "coupler/acceleration/make_acceleration.hpp"

#include "coupler/acceleration/aitken.hpp"
#include "coupler/acceleration/constant_relaxation.hpp"
#include "coupler/acceleration/iqn_ils.hpp"
#include "coupler/acceleration/iqn_imvj.hpp"

namespace couplet::coupling {

namespace {

QuasiNewtonOptions make_options(const v1::InterfaceQuasiNewton& scene) {
  QuasiNewtonOptions options;
  options.columns_max = scene.columns_max();
  options.steps_reused = scene.steps_reused();
  options.filter = scene.filter();
  if (scene.has_first_relaxation()) options.first_relaxation = scene.first_relaxation();
  return options;
}

}  // namespace

std::unique_ptr<Acceleration> make_acceleration(const v1::Coupling& coupling, InterfaceSize size,
                                                const Eigen::VectorXd& constant_factor) {
  switch (coupling.acceleration_case()) {
    case v1::Coupling::kConstant:
      return std::make_unique<ConstantRelaxation>(constant_factor);
    case v1::Coupling::kAitken: {
      const v1::Aitken& aitken = coupling.aitken();
      return std::make_unique<Aitken>(
          size, aitken.has_first_relaxation() ? std::optional(aitken.first_relaxation()) : std::nullopt);
    }
    case v1::Coupling::kIqnImvj:
      return std::make_unique<IqnImvj>(size, make_options(coupling.iqn_imvj()));
    case v1::Coupling::kIqnIls:
    case v1::Coupling::ACCELERATION_NOT_SET:
      break;
  }
  return std::make_unique<IqnIls>(size, make_options(coupling.iqn_ils()));
}

}  // namespace couplet::coupling
