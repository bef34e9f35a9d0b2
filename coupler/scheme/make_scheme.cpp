#include "coupler/scheme/make_scheme.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "coupler/acceleration/make_acceleration.hpp"
#include "coupler/predictor/make_predictor.hpp"
#include "coupler/scheme/explicit_step.hpp"
#include "coupler/scheme/fixed_point.hpp"
#include "coupler/scheme/implicit_step.hpp"
#include "proto/report/failure.hpp"

namespace couplet::coupling {

namespace {

std::vector<Segment> all_segments(const InterfaceLayout& layout) {
  std::vector<Segment> segments = layout.motion;
  segments.insert(segments.end(), layout.load.begin(), layout.load.end());
  return segments;
}

std::string unit_of(const std::string& field, const InterfaceLayout& layout) {
  std::string present;
  for (const Segment& segment : all_segments(layout)) {
    if (segment.name == field) return segment.unit;
    present += (present.empty() ? "" : ", ") + segment.name;
  }
  throw report::SceneError("coupling.convergence", "the field '" + field + "' is not exchanged; exchanged: " + present,
                           "name one of these");
}

constexpr double default_relative = 1e-5;

// When both solve at the same time, a motion that fits its load says nothing about a load that fits its motion.
void add_load_criteria(const InterfaceLayout& layout, std::vector<Criterion>& criteria) {
  double tightest = default_relative;
  for (const Criterion& criterion : criteria) tightest = std::min(tightest, criterion.relative.value_or(tightest));
  for (const Segment& segment : layout.load) {
    const auto names_it = [&](const Criterion& criterion) { return criterion.field == segment.name; };
    if (std::none_of(criteria.begin(), criteria.end(), names_it)) criteria.push_back({segment.name, {}, tightest});
  }
}

std::vector<Criterion> make_criteria(const v1::Coupling& coupling, const InterfaceLayout& layout) {
  std::vector<Criterion> criteria;
  if (coupling.scheme() == v1::Coupling::EXPLICIT) {
    for (const Segment& segment : layout.motion) criteria.push_back({segment.name, {}, {}});
    return criteria;
  }
  for (const v1::Convergence& convergence : coupling.convergence()) {
    Criterion criterion{convergence.field(), {}, {}};
    if (convergence.has_absolute()) criterion.absolute = convergence.absolute();
    if (convergence.has_relative()) criterion.relative = convergence.relative();
    if (!criterion.absolute && !criterion.relative) {
      throw report::SceneError("coupling.convergence", "the criterion for '" + criterion.field + "' has no limit",
                               "give absolute or relative");
    }
    criteria.push_back(std::move(criterion));
  }
  if (criteria.empty()) criteria.push_back({layout.motion.front().name, {}, default_relative});
  if (coupling.scheme() == v1::Coupling::PARALLEL_IMPLICIT) add_load_criteria(layout, criteria);
  return criteria;
}

double constant_factor(const v1::ConstantRelaxation& constant, const std::string& field) {
  if (field == "force") return constant.force();
  return field == "velocity" ? constant.velocity() : constant.displacement();
}

void fill_factors(const std::vector<Segment>& segments, const v1::ConstantRelaxation& constant,
                  Eigen::VectorXd& factors) {
  for (const Segment& segment : segments) {
    factors.segment(segment.offset, segment.size).setConstant(constant_factor(constant, segment.name));
  }
}

std::unique_ptr<FixedPoint> make_fixed_point(const v1::Coupling& coupling, InterfacePair& pair) {
  const InterfaceLayout& layout = pair.layout();
  Eigen::VectorXd motion_factor(layout.n_motion()), load_factor(layout.n_load());
  fill_factors(layout.motion, coupling.constant(), motion_factor);
  fill_factors(layout.load, coupling.constant(), load_factor);
  if (coupling.scheme() == v1::Coupling::PARALLEL_IMPLICIT) {
    const InterfaceSize size = {layout.n_primary_motion + layout.n_load(), layout.n_motion() + layout.n_load()};
    Eigen::VectorXd factor(size.n_total);
    factor << motion_factor.head(layout.n_primary_motion), load_factor, motion_factor.tail(layout.n_secondary_motion());
    return std::make_unique<ParallelFixedPoint>(pair, make_acceleration(coupling, size, factor));
  }
  const double load_relaxation = coupling.has_constant() ? coupling.constant().force() : 1;
  return std::make_unique<SerialFixedPoint>(
      pair, make_acceleration(coupling, {layout.n_primary_motion, layout.n_motion()}, motion_factor), load_relaxation);
}

}  // namespace

MappingKind make_mapping_kind(v1::Mapping mapping) {
  switch (mapping) {
    case v1::AUTOMATIC:
      return MappingKind::automatic;
    case v1::MATCHING:
      return MappingKind::matching;
    case v1::NEAREST_POINT:
      return MappingKind::nearest_point;
    case v1::CLOSEST_FACE:
      return MappingKind::closest_face;
  }
  return MappingKind::automatic;
}

ConvergenceHistory make_convergence_history(const v1::Coupling& coupling, const InterfaceLayout& layout) {
  std::vector<Criterion> criteria = make_criteria(coupling, layout);
  std::vector<std::string> units;
  for (const Criterion& criterion : criteria) units.push_back(unit_of(criterion.field, layout));
  return {std::move(criteria), std::move(units)};
}

std::unique_ptr<StepScheme> make_scheme(const v1::Coupling& coupling, InterfacePair& pair, ConvergenceHistory& history,
                                        double start_time) {
  std::unique_ptr<Predictor> motion_predictor = make_predictor(coupling, pair.layout().n_primary_motion);
  if (coupling.scheme() == v1::Coupling::EXPLICIT) {
    return std::make_unique<ExplicitStep>(pair, std::move(motion_predictor), start_time);
  }
  return std::make_unique<ImplicitStep>(pair, make_fixed_point(coupling, pair), history, std::move(motion_predictor),
                                        make_predictor(coupling, pair.layout().n_load()), coupling.iterations_max(),
                                        start_time);
}

}  // namespace couplet::coupling
