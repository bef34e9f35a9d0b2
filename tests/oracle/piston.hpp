#pragma once
// Pistons on springs that move a column of incompressible fluid: the added-mass effect in closed form.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tests/oracle/oracle_participant.hpp"

namespace couplet::oracle {

/// Each node is a piston of its own that moves along y: m_s x'' + k x = f, and the fluid column in front of it answers
/// its acceleration at once, f = -m_a x''. Together (m_s + m_a) x'' + k x = 0; from x = 0 with velocity v_0:
///   x(t) = v_0 / w sin(w t),  w = sqrt(k / (m_s + m_a)).
struct PistonRow {
  Eigen::VectorXd solid_mass;  // m_s (n) [kg]
  Eigen::VectorXd added_mass;  // m_a (n) [kg]
  Eigen::VectorXd stiffness;   // k (n) [N/m]
  Eigen::VectorXd velocity;    // v_0 (n) [m/s]

  Eigen::Index n_nodes() const { return solid_mass.size(); }
  Eigen::VectorXd exact_displacement(double time) const;
};

/// One piston with m_s = 1, k = 1, v_0 = 1 and that added mass.
PistonRow one_piston(double added_mass);

/// How velocity and acceleration follow from the displacement at the end of a step, in flow and solid alike.
enum class TimeRule {
  backward,     // v = (x - x_old) / dt, a = (v - v_old) / dt: first order
  trapezoidal,  // Newmark with beta = 1/4, gamma = 1/2: second order
};

struct Kinematics {
  Eigen::VectorXd displacement, velocity, acceleration;

  surface::NodeArray columns() const;
  static Kinematics from_columns(const surface::NodeArray& columns);
};

/// The state at the end of a step that ends at that displacement.
Kinematics move_to(const Kinematics& old, const Eigen::VectorXd& displacement, double duration, TimeRule rule);

/// Its state is that of the pistons that it follows. Takes displacement and velocity, gives force, all (n, 3).
class PistonFlow : public OracleParticipant<Kinematics> {
 public:
  PistonFlow(PistonRow row, TimeRule rule);

 private:
  surface::SurfaceMesh nodes() const override;
  std::vector<std::string> needs() const override { return {"displacement", "velocity"}; }
  surface::FieldSet offered(const Kinematics& state) const override;
  Kinematics solve(const Kinematics& accepted, const participant::StepInterval& interval,
                   const surface::FieldSet& fields) const override;
  participant::NamedNumber quantity(const Kinematics& accepted) const override;

  PistonRow row_;
  TimeRule rule_;
};

/// Takes force, gives displacement and velocity.
class PistonSolid : public OracleParticipant<Kinematics> {
 public:
  PistonSolid(PistonRow row, TimeRule rule);

 private:
  surface::SurfaceMesh nodes() const override;
  std::vector<std::string> needs() const override { return {"force"}; }
  surface::FieldSet offered(const Kinematics& state) const override;
  Kinematics solve(const Kinematics& accepted, const participant::StepInterval& interval,
                   const surface::FieldSet& fields) const override;
  participant::NamedNumber quantity(const Kinematics& accepted) const override;

  PistonRow row_;
  TimeRule rule_;
};

}  // namespace couplet::oracle
