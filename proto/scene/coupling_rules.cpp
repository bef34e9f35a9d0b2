#include <algorithm>

#include "proto/scene/relation_rules.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

namespace {

void explicit_scheme_is_not_accelerated(const v1::Coupling& coupling, Review& review) {
  if (coupling.scheme() != v1::Coupling::EXPLICIT || coupling.acceleration_case() == 0) return;
  const auto* const choice = v1::Coupling::descriptor()->FindOneofByName("acceleration");
  const auto* const chosen = coupling.GetReflection()->GetOneofFieldDescriptor(coupling, choice);
  review.complain("coupling." + chosen->name(),
                  "contradicts scheme EXPLICIT, which does not iterate; delete it or choose SERIAL_IMPLICIT");
}

void criterion_makes_sense(const v1::Convergence& criterion, const std::string& path, Review& review) {
  const std::vector<std::string> fields = {"force", "displacement", "velocity"};
  if (criterion.has_field() && std::find(fields.begin(), fields.end(), criterion.field()) == fields.end()) {
    review.complain(path + ".field", "\"" + criterion.field() + "\" is not a field of the interface; " +
                                         suggestion(criterion.field(), fields, "choose"));
  }
  if (!criterion.has_absolute() && !criterion.has_relative()) {
    review.complain_missing_choice(path, {"absolute", "relative"},
                                   "has no limit; give absolute (SI unit of the field), relative or both");
  }
}

}  // namespace

void check_coupling_rules(const v1::Scene& scene, Review& review) {
  explicit_scheme_is_not_accelerated(scene.coupling(), review);
  for (int i = 0; i < scene.coupling().convergence_size(); ++i) {
    criterion_makes_sense(scene.coupling().convergence(i), "coupling.convergence[" + std::to_string(i) + "]", review);
  }
}

}  // namespace couplet::scene
