#include "coupler/scheme/diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace couplet::coupling {

namespace {

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", value);
  return text;
}

std::string limits_of(const Criterion& criterion, const std::string& unit) {
  std::string text;
  if (criterion.absolute) text += short_number(*criterion.absolute) + " " + unit;
  if (criterion.relative) text += (text.empty() ? "" : " or ") + short_number(*criterion.relative) + " relative";
  return text;
}

double worst_excess(const ConvergenceHistory& history, const std::vector<FieldChange>& changes) {
  double worst = 0;
  for (std::size_t k = 0; k < changes.size(); ++k) worst = std::max(worst, excess(history.criteria()[k], changes[k]));
  return worst;
}

enum class Trend { unknown, falling, stalled, growing };

// From the first half of the attempt to its second half.
Trend trend_of(const ConvergenceHistory& history) {
  const auto& attempt = history.attempt();
  if (attempt.size() < 4) return Trend::unknown;
  double first = INFINITY, second = INFINITY;
  for (std::size_t k = 0; k < attempt.size(); ++k) {
    double& half = k < attempt.size() / 2 ? first : second;
    half = std::min(half, worst_excess(history, attempt[k]));
  }
  if (second < 0.3 * first) return Trend::falling;
  return second < 3 * first ? Trend::stalled : Trend::growing;
}

}  // namespace

std::string describe_attempt(const ConvergenceHistory& history, double added_mass_number) {
  std::string text;
  if (!history.attempt().empty()) {
    const std::vector<FieldChange>& last = history.attempt().back();
    for (std::size_t k = 0; k < last.size(); ++k) {
      const Criterion& criterion = history.criteria()[k];
      const std::string& unit = history.units()[k];
      text += (k > 0 ? ", " : "") + criterion.field + " still changes by " + short_number(last[k].absolute) + " " +
              unit + " (" + short_number(last[k].relative) + " relative; allowed " + limits_of(criterion, unit) + ")";
    }
  }
  if (added_mass_number > 0) {
    text += (text.empty() ? "" : "; ") + std::string("the estimated added-mass number is ") +
            short_number(added_mass_number);
  }
  return text;
}

std::string advise(const ConvergenceHistory& history, double added_mass_number, int iterations_max) {
  switch (trend_of(history)) {
    case Trend::falling:
      return "the change was still falling: raise coupling.iterations_max above " + std::to_string(iterations_max);
    case Trend::stalled:
      return "the change stopped falling above the limit: widen coupling.convergence, or tighten the solvers' own "
             "tolerances";
    case Trend::growing:
    case Trend::unknown:
      break;
  }
  if (added_mass_number > 1) {
    return "the fluid answers the motion more strongly than the solid resists: use coupling.iqn_ils with its default "
           "settings, or a smaller time.step";
  }
  return "use a smaller time.step, and check the loads and materials of the scene";
}

}  // namespace couplet::coupling
