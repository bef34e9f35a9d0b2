#pragma once
// One-dimensional incompressible flow through a channel whose area changes in space and time.

#include <Eigen/Core>
#include <cstdint>

#include "flow-server/one_dimensional/backward_difference.hpp"
#include "flow-server/one_dimensional/glottal_law.hpp"
#include "flow-server/one_dimensional/section_profile.hpp"
#include "flow-server/one_dimensional/station_axis.hpp"

namespace couplet::flow {

/// Pressures that drive the flow at the end of a step [Pa].
struct EndPressures {
  double inlet = 0;  // P_sub
  double exit = 0;   // P_e
};

/// The flow at one time. Arrays (n_stations).
struct GlottalSolution {
  Eigen::ArrayXd position;        // x_k [m]
  Eigen::ArrayXd effective_area;  // A = alpha A0 [m^2]
  Eigen::ArrayXd volume;          // of the effective area, from the inlet to each station [m^3]
  Eigen::ArrayXd velocity;        // u [m/s]
  Eigen::ArrayXd pressure;        // p [Pa]
  double exit = 0;                // x_b [m]
  double inlet_rate = 0;          // Q, flow through the first station [m^3/s]
  double exit_rate = 0;           // flow through the (moving) last station [m^3/s]
  int throat = 0;                 // station of the smallest effective area
  bool clipped = false;           // no flow fits both pressures exactly; the nearest one was taken
};

/// The last accepted times, as far as a time derivative needs them.
struct GlottalHistory {
  GlottalSolution accepted;
  GlottalSolution earlier;
  double previous_step = 0;  // between the two [s]
  bool has_earlier = false;
};

/// Solves continuity and momentum on stations that move with the exit line [README.md, "Method"].
///
/// Continuity is taken in its volume form, A (u - dx/dt) = Q - d/dt Vol(inlet .. x): what flows in is, to round-off,
/// what flows out plus the growth of the volume. So u is linear in the inlet flow Q, the exit pressure is a quadratic
/// in Q, and Q is its root in closed form. Second order in the step and in the spacing of the stations.
class GlottalFlow {
 public:
  /// `axis` must outlive this.
  GlottalFlow(const StationAxis& axis, const GlottalLaw& law);

  const GlottalLaw& law() const { return law_; }

  /// The steady flow through a channel at rest becomes the accepted state. Throws NumericsError like solve().
  void start(const SectionProfile& profile, const EndPressures& pressures);

  /// From the accepted state over `duration` [s]: a new trial state, which is returned. Throws NumericsError when the
  /// exit line is not downstream of inlet and contraction or when no flow rate solves the equations.
  const GlottalSolution& solve(const SectionProfile& profile, const EndPressures& pressures, double duration);

  /// The trial state of the last solve becomes the accepted one.
  void accept();

  const GlottalHistory& history() const { return history_; }
  void restore(GlottalHistory history);

 private:
  /// Pressure drop over an interval: lower u_k + upper u_{k+1} + rest + recovery rho/2 (u_{k+1}^2 - u_k^2) [Pa].
  struct Drops {
    Eigen::ArrayXd lower, upper;  // (n_stations - 1) [Pa s/m]
    Eigen::ArrayXd rest;          // [Pa]
    Eigen::ArrayXd recovery;      // chi [1]
  };
  void solve_trial(const SectionProfile& profile, const EndPressures& pressures, const BackwardDifference& rate);
  void place_stations(const SectionProfile& profile, const BackwardDifference& rate);
  void find_effective_area(const SectionProfile& profile);
  void find_velocity_line(const BackwardDifference& rate);
  void find_drops(const SectionProfile& profile, const BackwardDifference& rate);
  double inlet_rate_that_fits(const EndPressures& pressures);
  void find_pressure(const EndPressures& pressures);

  const StationAxis* axis_;
  GlottalLaw law_;
  GlottalHistory history_;
  GlottalSolution trial_;
  double trial_step_ = 0;  // [s]

  Eigen::ArrayXd station_velocity_;       // dx_k/dt [m/s]
  Eigen::ArrayXd velocity_without_flow_;  // a in u = a + b Q [m/s]
  Eigen::ArrayXd velocity_per_flow_;      // b in u = a + b Q [1/m^2]
  Eigen::ArrayXd friction_;               // C0 mu (s/A)^2 [Pa s/m^2]
  Drops drops_;
};

}  // namespace couplet::flow
