#pragma once
// Newton's method for equations with a symmetric tangent whose factors are worth keeping.

#include <vector>

#include "solid-server/element/element_packs.hpp"

namespace couplet::solid {

/// r(u) = 0, and A = -dr/du. Vectors are (n_nodes, 4): x, y, z, 0; held components are 0 in every residual and every
/// solution.
class NonlinearSystem {
 public:
  virtual ~NonlinearSystem() = default;

  struct Residual {
    NodeVectors value;            // r [N]
    double scale = 0;             // size of the forces that balance each other in r, in the same norm [N]
    Index inverted_element = -1;  // r is worthless when there is one
  };
  virtual void evaluate(const NodeVectors& u, Residual& residual) = 0;

  /// Factors of A at u, to be used by every solve until the next call. `increment` [m]: u was reached from its start in
  /// one linear step of this size. Returns the first inverted element or -1; there are no factors then.
  virtual Index factorise(const NodeVectors& u, const NodeVectors& increment) = 0;
  virtual bool has_factors() const = 0;
  virtual NodeVectors solve(const NodeVectors& rhs) const = 0;
  virtual int n_negative_pivots() const = 0;

  /// Whether A takes account of `increment` in such a way that the whole step is right although the residual may rise.
  virtual bool takes_full_steps() const { return false; }
  /// What new factors cost, in units of a residual and a solve. A number that depends on sizes only, not on clocks.
  virtual double factorisation_cost() const = 0;
  virtual double length() const = 0;  // of the body [m]: what round-off is measured by
};

/// The defaults are those of the scene language.
struct NewtonControl {
  double tolerance = 1e-6;  // |r| over the scale of the forces
  int n_iterations_most = 25;
};

enum class NewtonOutcome { converged, too_many_iterations, diverged, not_finite, inverted_element };

struct NewtonReport {
  NewtonOutcome outcome = NewtonOutcome::converged;
  int n_iterations = 0;      // solutions of the linear system that moved u
  int n_factorisations = 0;  // among them with new factors
  double residual = 0;       // |r| over the scale of the forces, at the end
  Index inverted_element = -1;

  bool has_converged() const { return outcome == NewtonOutcome::converged; }
  std::string sentence() const;  // why it ended
};

/// Newton's method with kept factors. As long as the contraction |d_k| / |d_(k-1)| of the corrections promises to end
/// with fewer further iterations than new factors cost, the old factors are used, improved by the rank-two updates of
/// Broyden, Fletcher, Goldfarb and Shanno in product form [Matthies, Strang 1979]; what decides depends on numbers,
/// never on clocks. A step of length s along d ends near d . r(u + s d) = 0 (line search), except where the system
/// takes full steps; an inverted element counts as infinite energy and halves s.
///
/// Converged: |r| <= tolerance times the scale; or the correction is round-off: |d| <= 1e-9 of the whole increment, or
/// 1e-13 of the length of the body in every component.
class Newton {
 public:
  explicit Newton(NewtonControl control) : control_(control) {}

  /// What is known of the factors at the start.
  enum class Factors {
    unknown,          // kept ones are tried
    of_this_start,    // they were made here, for the first iteration
    of_the_increment  // they gave the increment: the first correction is compared with it
  };

  /// From u, which was reached by `increment` from a solution (0: u is one). On failure u is left as it was.
  NewtonReport solve(NonlinearSystem& system, NodeVectors& u, const NodeVectors& increment,
                     Factors factors = Factors::unknown);

 private:
  struct Pair {
    NodeVectors step, change;  // s = u_new - u, y = r - r_new
    double product = 0;        // s . y
  };

  NodeVectors improved_solution(const NonlinearSystem& system, const NodeVectors& rhs) const;
  void remember(const NonlinearSystem& system, NodeVectors step, NodeVectors change);

  NewtonControl control_;
  std::vector<Pair> pairs_;  // since the last factorisation, oldest first
};

}  // namespace couplet::solid
