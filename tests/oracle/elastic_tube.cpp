#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <cmath>
#include <numbers>

#include "tests/oracle/elastic_tube.hpp"

namespace couplet::oracle {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Residual and Jacobian in the unknowns (u_0, p_0, u_1, p_1, ...).
class TubeEquations {
 public:
  TubeEquations(const ElasticTube& tube, const TubeFlowState& old, const VectorXd& area, double end_time,
                double duration)
      : old_(old),
        area_(area),
        n_(tube.n_cells),
        dx_dt_(tube.cell() / duration),
        inlet_(tube.inlet_velocity(end_time)),
        c2_(tube.wave_speed_squared()) {}

  void assemble(const VectorXd& x, VectorXd& residual, Eigen::SparseMatrix<double>& jacobian) {
    entries_.clear();
    residual.resize(2 * (n_ + 1));
    boundary(x, residual);
    for (Index i = 1; i < n_; ++i) interior(i, x, residual);
    jacobian.resize(residual.size(), residual.size());
    jacobian.setFromTriplets(entries_.begin(), entries_.end());
  }

 private:
  static Index u(Index node) { return 2 * node; }
  static Index p(Index node) { return 2 * node + 1; }
  void add(Index row, Index column, double value) {
    entries_.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
  }

  // u_0 given, p_0 = 2 p_1 - p_2; u_N = 2 u_{N-1} - u_{N-2}, p_N = 2 [c^2 - (sqrt(c^2 - p_N^old / 2) - (u_N - u_N^old)
  // / 4)^2].
  void boundary(const VectorXd& x, VectorXd& residual) {
    residual(u(0)) = x(u(0)) - inlet_;
    add(u(0), u(0), 1);
    residual(p(0)) = x(p(0)) - 2 * x(p(1)) + x(p(2));
    add(p(0), p(0), 1), add(p(0), p(1), -2), add(p(0), p(2), 1);
    residual(u(n_)) = x(u(n_)) - 2 * x(u(n_ - 1)) + x(u(n_ - 2));
    add(u(n_), u(n_), 1), add(u(n_), u(n_ - 1), -2), add(u(n_), u(n_ - 2), 1);
    const double root = std::sqrt(c2_ - old_.pressure(n_) / 2) - (x(u(n_)) - old_.velocity(n_)) / 4;
    residual(p(n_)) = x(p(n_)) - 2 * (c2_ - root * root);
    add(p(n_), p(n_), 1), add(p(n_), u(n_), -root);
  }

  void interior(Index i, const VectorXd& x, VectorXd& residual) {
    const double a_right = (area_(i) + area_(i + 1)) / 2, a_left = (area_(i) + area_(i - 1)) / 2;
    const double flux_right = a_right * (x(u(i)) + x(u(i + 1))) / 2, flux_left = a_left * (x(u(i)) + x(u(i - 1))) / 2;

    // (a_i - a_i^old) dx/dt + (a u)_{i+1/2} - (a u)_{i-1/2} = 0
    residual(p(i)) = (area_(i) - old_.area(i)) * dx_dt_ + flux_right - flux_left;
    add(p(i), u(i + 1), a_right / 2), add(p(i), u(i), (a_right - a_left) / 2), add(p(i), u(i - 1), -a_left / 2);

    // (a_i u_i - a_i^old u_i^old) dx/dt + (a u)_{i+1/2} u_i - (a u)_{i-1/2} u_{i-1}
    //   + [a_{i+1/2} (p_{i+1} - p_i) + a_{i-1/2} (p_i - p_{i-1})] / 2 = 0
    residual(u(i)) = (area_(i) * x(u(i)) - old_.area(i) * old_.velocity(i)) * dx_dt_ + flux_right * x(u(i)) -
                     flux_left * x(u(i - 1)) +
                     (a_right * (x(p(i + 1)) - x(p(i))) + a_left * (x(p(i)) - x(p(i - 1)))) / 2;
    add(u(i), u(i), area_(i) * dx_dt_ + flux_right + a_right / 2 * x(u(i)) - a_left / 2 * x(u(i - 1)));
    add(u(i), u(i + 1), a_right / 2 * x(u(i)));
    add(u(i), u(i - 1), -flux_left - a_left / 2 * x(u(i - 1)));
    add(u(i), p(i + 1), a_right / 2), add(u(i), p(i), (a_left - a_right) / 2), add(u(i), p(i - 1), -a_left / 2);
  }

  const TubeFlowState& old_;
  const VectorXd& area_;
  Index n_;
  double dx_dt_, inlet_, c2_;
  std::vector<Eigen::Triplet<double>> entries_;
};

}  // namespace

double ElasticTube::wave_speed_squared() const {
  return young_modulus * std::sqrt(std::numbers::pi) / 2;
}

double ElasticTube::inlet_velocity(double time) const {
  return 10 + 3 * std::sin(10 * std::numbers::pi * time);
}

VectorXd ElasticTube::wall_area(const VectorXd& pressure) const {
  const double twice = 2 * wave_speed_squared();
  return (twice * twice) / (pressure.array() - twice).square();
}

surface::NodeArray TubeFlowState::columns() const {
  surface::NodeArray columns(velocity.size(), 3);
  columns << velocity, pressure, area;
  return columns;
}

TubeFlowState TubeFlowState::from_columns(const surface::NodeArray& columns) {
  return {columns.col(0), columns.col(1), columns.col(2)};
}

TubeFlowState rest_state(const ElasticTube& tube) {
  const Index n_nodes = tube.n_cells + 1;
  return {VectorXd::Constant(n_nodes, 10), VectorXd::Zero(n_nodes), VectorXd::Ones(n_nodes)};
}

TubeFlowState solve_tube_flow(const ElasticTube& tube, const TubeFlowState& old, const VectorXd& area, double end_time,
                              double duration) {
  constexpr int newton_max = 50;
  constexpr double tolerance = 1e-15;
  const Index n_nodes = tube.n_cells + 1;
  TubeEquations equations(tube, old, area, end_time, duration);
  VectorXd x(2 * n_nodes), residual;
  for (Index i = 0; i < n_nodes; ++i) x(2 * i) = old.velocity(i), x(2 * i + 1) = old.pressure(i);

  Eigen::SparseMatrix<double> jacobian;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> solver;
  double norm = INFINITY;
  for (int k = 0; k < newton_max; ++k) {
    equations.assemble(x, residual, jacobian);
    const double last = norm;
    norm = residual.norm() / x.norm();
    const bool is_round_off = norm < 1e-12 && norm > 0.5 * last;  // no progress: this is all that doubles give
    if (norm < tolerance || is_round_off || !std::isfinite(norm)) break;
    if (k == 0) solver.analyzePattern(jacobian);
    solver.factorize(jacobian);
    if (solver.info() != Eigen::Success) break;
    x -= solver.solve(residual);
  }
  TubeFlowState state{VectorXd(n_nodes), VectorXd(n_nodes), area};
  const bool has_failed = !(norm < 1e-8);
  for (Index i = 0; i < n_nodes; ++i) {
    state.velocity(i) = has_failed ? NAN : x(2 * i);
    state.pressure(i) = has_failed ? NAN : x(2 * i + 1);
  }
  return state;
}

}  // namespace couplet::oracle
