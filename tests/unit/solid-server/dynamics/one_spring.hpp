#pragma once
// One unknown between a load and a spring, for the tests of iterations.

#include <functional>

#include "solid-server/dynamics/arc_length.hpp"

namespace couplet::solid {

/// factor * load - spring(u) = 0 in the x component of one node.
class OneSpring : public LoadedSystem {
 public:
  std::function<double(double)> spring, stiffness;
  double load = 0, factor = 1;
  double inverted_above = std::numeric_limits<double>::max();  // displacement
  double cost_of_factors = 1;
  int n_factorisations = 0, n_evaluations = 0;

  void evaluate(const NodeVectors& u, Residual& residual) override {
    ++n_evaluations;
    residual.value = on_x(factor * load - spring(u(0, 0)));
    residual.scale = std::abs(factor * load);
    residual.inverted_element = u(0, 0) > inverted_above ? 7 : -1;
  }
  Index factorise(const NodeVectors& u, const NodeVectors&) override {
    ++n_factorisations;
    kept_stiffness_ = stiffness(u(0, 0));
    return -1;
  }
  bool has_factors() const override { return kept_stiffness_ != 0; }
  NodeVectors solve(const NodeVectors& rhs) const override { return rhs / kept_stiffness_; }
  int n_negative_pivots() const override { return kept_stiffness_ < 0; }
  double factorisation_cost() const override { return cost_of_factors; }
  double length() const override { return 1; }
  void set_load(double wanted, NodeVectors&) override { factor = wanted; }
  NodeVectors load_rate(const NodeVectors&) override { return on_x(load); }

  static NodeVectors on_x(double value) {
    NodeVectors vector = NodeVectors::Zero(1, 4);
    vector(0, 0) = value;
    return vector;
  }

 private:
  double kept_stiffness_ = 0;
};

}  // namespace couplet::solid
