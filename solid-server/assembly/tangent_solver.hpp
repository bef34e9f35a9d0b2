#pragma once
// The matrix of an implicit step, of a static step and of a modal analysis: assembled, factorised, solved.

#include <memory>
#include <vector>

#include "solid-server/assembly/block_properties.hpp"
#include "solid-server/assembly/tangent_matrix.hpp"
#include "solid-server/support/free_components.hpp"

namespace couplet::solid {

/// A = stiffness * K(u) + mass * M: (1, 0) is the static tangent, (1, -omega^2) the one shifted to a frequency.
struct TangentWeights {
  double stiffness = 1;  // [1]
  double mass = 0;       // [1/s^2]
};

/// What the work of a TangentSolver has cost since it was made.
struct TangentCost {
  int n_assemblies = 0, n_factorisations = 0, n_solves = 0;
  double assembly_seconds = 0, factorisation_seconds = 0, solve_seconds = 0;
};

/// K(u) = d2(strain energy)/du2 is minus the derivative of the internal force, with geometric stiffness; M is the
/// mass. Vectors are (n_nodes, 4), x, y, z, 0. Held components are 0 in every result; `solve` does not read
/// them in its argument, while `multiply` and `mass_times` do: so a prescribed motion acts on the free components.
///
/// The order of calls: assemble, any number of add, factorise, any number of solve. A solve uses the factors of the
/// last factorise, whatever has been assembled since: a Newton iteration may keep old factors, also as a preconditioner
/// for `multiply`, which uses the matrix as it is assembled now.
///
/// Results do not depend on the number of members of the team, to the last bit.
class TangentSolver {
 public:
  /// The pattern of the matrix and the order of elimination are found here, once. Throws SceneError when no component
  /// is free, NumericsError when memory is not enough.
  TangentSolver(const SolidMesh& mesh, const std::vector<BlockProperties>& properties, const FreeComponents& free,
                WorkTeam& team, MassForm mass_form = MassForm::consistent);
  ~TangentSolver();
  TangentSolver(const TangentSolver&) = delete;
  TangentSolver& operator=(const TangentSolver&) = delete;

  /// Forgets the matrix and what was added. Returns the first element turned inside out (J not above 0, or not a
  /// number), or -1.
  /// `increment` d, (n_nodes, 4) [m]: where u was reached by one linear step d, the geometric stiffness takes the
  /// stress that is linear along it, S(u - d) + dS/dE sym(F^T grad d), instead of S(u), and the second derivative of
  /// the volume ratio likewise the pressure U'(J) + U''(J) dJ from J(u - d). These are the displacements of a Newton
  /// iteration in which stresses and pressures are unknowns of their own: the stress of a linear step that rotates, or
  /// that keeps the volume of nearly incompressible tissue, is right to first order, while that of its end is not of
  /// its size. It needs far fewer iterations where slender parts rotate and where the bulk modulus is large [Magisano,
  /// Leonetti, Garcea 2017, for laws that are linear in E]. Null: the tangent itself.
  Index assemble(const NodeVectors& displacement, TangentWeights weights, const NodeVectors* increment = nullptr);

  /// Adds the symmetric part of a contribution C (follower load, contact): call it for every pair of nodes (a, b) whose
  /// block C_ab = - d f_a / d u_b, times the stiffness weight, is not zero, (a, b) and (b, a) separately;
  /// A_ab += C_ab / 2 and A_ba += C_ab^T / 2. The nodes may lie in different elements: the next factorise
  /// then finds a new pattern, without the pairs that have come apart since the last one.
  void add(Index node_a, Index node_b, const Eigen::Matrix3d& block);

  /// L L^T, or L D L^T when the matrix is not positive definite. Throws NumericsError when the matrix has an entry that
  /// is not a number or is singular, or when memory is not enough.
  void factorise();

  /// Of the factorised matrix: 0 when it is positive definite; each limit or bifurcation point that a path of
  /// equilibrium passes changes it by one.
  int n_negative_pivots() const;

  NodeVectors solve(const NodeVectors& rhs) const;

  NodeVectors multiply(const NodeVectors& vector) const;           // A x
  NodeVectors mass_times(const NodeVectors& vector) const;         // M x
  NodeVectors mass_times_on_all(const NodeVectors& vector) const;  // M x with its held components: inertia on supports

  const FreeComponents& free() const;
  double n_operations() const;  // of a factorisation
  Index n_free() const;         // components
  const TangentCost& cost() const;
  std::size_t memory_bytes() const;  // of matrices, factors and plans

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace couplet::solid
