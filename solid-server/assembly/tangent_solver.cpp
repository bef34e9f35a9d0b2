#include "solid-server/assembly/tangent_solver.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "proto/report/failure.hpp"
#include "solid-server/assembly/machine_memory.hpp"
#include "solid-server/assembly/sparse_cholesky.hpp"

namespace couplet::solid {

namespace {

/// Adds the time until it goes out of scope to a sum [s].
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(Clock::now() - began_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point began_ = Clock::now();
};

}  // namespace

struct TangentSolver::Parts {
  struct Contribution {
    Index a, b;
    Eigen::Matrix3d block;
  };

  FreeComponents free;
  WorkTeam& team;
  TangentMatrix matrix;
  std::unique_ptr<SparseCholesky> factors;
  std::vector<Contribution> outside;           // added, but not in the pattern yet
  std::vector<std::pair<Index, Index>> extra;  // pairs of the pattern that no element has
  mutable TangentCost cost;

  /// 0 where a component is held.
  NodeVectors on_free(NodeVectors vector) const {
    vector.leftCols<3>().array() *= free.cast<double>();
    return vector;
  }
};

namespace {

/// Pairs of nodes that an element adds to a large mesh: its share of nodes times half of those that each one meets.
double pairs_per_element(ElementShape shape) {
  switch (shape) {
    case ElementShape::hexahedron20:
      return 164;
    case ElementShape::hexahedron8:
      return 14;
    case ElementShape::tetrahedron10:
      return 19;
  }
  return 0;
}

/// Stiffness, mass and the matrix that is factorised, without the factors.
void refuse_too_large(const SolidMesh& mesh) {
  constexpr double bytes_per_pair = 9 * (8 + 8 + 24);
  double needed = 0;
  for (const ElementBlock& block : mesh.block)
    needed += bytes_per_pair * pairs_per_element(block.shape) * block.n_elements();
  if (needed < machine_memory()) return;
  throw report::NumericsError("linear system",
                              "there is no memory for a matrix of " + std::to_string(mesh.n_nodes()) +
                                  " nodes and its factors: it alone needs " + report::text(std::round(needed / 1e9)) +
                                  " GB, but this machine has " + report::text(std::round(machine_memory() / 1e9)) +
                                  " GB",
                              "take a coarser mesh, a larger machine, or the explicit central difference method");
}

}  // namespace

TangentSolver::TangentSolver(const SolidMesh& mesh, const std::vector<BlockProperties>& properties,
                             const FreeComponents& free, WorkTeam& team, MassForm mass_form) {
  refuse_too_large(mesh);
  parts_ = std::unique_ptr<Parts>(
      new Parts{free, team, TangentMatrix(mesh, properties, mass_form, team), nullptr, {}, {}, {}});
  if (!free.any()) throw report::SceneError("solid", "no node of any body is free to move", "fix fewer surfaces");
  parts_->factors = std::make_unique<SparseCholesky>(parts_->matrix.pairs(), free);
}

TangentSolver::~TangentSolver() = default;

Index TangentSolver::assemble(const NodeVectors& displacement, TangentWeights weights, const NodeVectors* increment) {
  const Stopwatch stopwatch(parts_->cost.assembly_seconds);
  ++parts_->cost.n_assemblies;
  parts_->outside.clear();
  return parts_->matrix.assemble(displacement, increment, weights.stiffness, weights.mass);
}

void TangentSolver::add(Index node_a, Index node_b, const Eigen::Matrix3d& block) {
  if (!parts_->matrix.add_symmetric_part(node_a, node_b, block) && !block.isZero(0))
    parts_->outside.push_back({node_a, node_b, block});
}

void TangentSolver::factorise() {
  const Stopwatch stopwatch(parts_->cost.factorisation_seconds);
  ++parts_->cost.n_factorisations;
  // The pattern, and with it the order of elimination and the round-off, is that of this matrix whatever came before: a
  // resumed run has the same bits.
  const auto n_unused =
      std::erase_if(parts_->extra, [&](const auto& p) { return parts_->matrix.is_zero(p.first, p.second); });
  if (n_unused > 0 || !parts_->outside.empty()) {
    for (const auto& [a, b, block] : parts_->outside) parts_->extra.emplace_back(std::max(a, b), std::min(a, b));
    std::sort(parts_->extra.begin(), parts_->extra.end());
    parts_->extra.erase(std::unique(parts_->extra.begin(), parts_->extra.end()), parts_->extra.end());
    parts_->matrix.set_extra_pairs(parts_->extra);
    parts_->factors.reset();
    parts_->factors = std::make_unique<SparseCholesky>(parts_->matrix.pairs(), parts_->free);
    for (const auto& [a, b, block] : parts_->outside) parts_->matrix.add_symmetric_part(a, b, block);
    parts_->outside.clear();
  }
  parts_->factors->factorise(parts_->matrix.blocks());
}

int TangentSolver::n_negative_pivots() const {
  return parts_->factors->n_negative_pivots();
}

NodeVectors TangentSolver::solve(const NodeVectors& rhs) const {
  const Stopwatch stopwatch(parts_->cost.solve_seconds);
  ++parts_->cost.n_solves;
  return parts_->factors->solve(rhs);
}

NodeVectors TangentSolver::multiply(const NodeVectors& vector) const {
  NodeVectors product = parts_->matrix.multiply(vector);
  for (const auto& [a, b, block] : parts_->outside) {
    product.row(a).head<3>() += 0.5 * vector.row(b).head<3>() * block.transpose();
    product.row(b).head<3>() += 0.5 * vector.row(a).head<3>() * block;
  }
  return parts_->on_free(std::move(product));
}

NodeVectors TangentSolver::mass_times(const NodeVectors& vector) const {
  return parts_->on_free(parts_->matrix.mass_times(vector));
}

NodeVectors TangentSolver::mass_times_on_all(const NodeVectors& vector) const {
  return parts_->matrix.mass_times(vector);
}

const FreeComponents& TangentSolver::free() const {
  return parts_->free;
}

Index TangentSolver::n_free() const {
  return parts_->factors->n_unknowns();
}

double TangentSolver::n_operations() const {
  return parts_->factors->n_operations();
}

const TangentCost& TangentSolver::cost() const {
  return parts_->cost;
}

std::size_t TangentSolver::memory_bytes() const {
  return parts_->matrix.memory_bytes() + parts_->factors->memory_bytes();
}

}  // namespace couplet::solid
