#pragma once
// What distinguishes one reduced-order glottal model from another: a few numbers in one momentum equation.

namespace couplet::flow {

enum class GlottalModel {
  b1,  // Bernoulli, separation at the smallest area
  b2,  // Bernoulli, separation at the glottal exit
  m1,  // friction and partial pressure recovery
  m2,  // the same with the entrance effect
};

enum class TimeDerivative {
  backward_euler,  // first order; damps what one step cannot resolve
  bdf2,            // second order
};

/// The numbers of the momentum equation [Diss, eqs. 5.1-5.6, 6.1-6.4], see README.md. Bernoulli is the case C0 = 0,
/// chi = 1.
struct GlottalLaw {
  GlottalModel model = GlottalModel::m2;
  double density = 0;                           // rho [kg/m^3]
  double viscosity = 0;                         // mu [Pa s]
  double friction_coefficient = 0;              // C0 [1]
  bool friction_only_where_converging = false;  // no friction after the smallest section
  double smallest_recovery = 1;                 // chi_min, after the smallest section [1]
  double entrance_contraction = 0;              // C1 [1]
  bool unsteady = true;                         // keep dA/dt, du/dt and the motion of the stations
  TimeDerivative time_derivative = TimeDerivative::backward_euler;
};

inline bool separates_at_throat(const GlottalLaw& law) {
  return law.model == GlottalModel::b1;
}

}  // namespace couplet::flow
