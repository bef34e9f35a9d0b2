#pragma once
// Stiffness and mass of a body, from elements to one sparse matrix.

#include <atomic>
#include <vector>

#include "solid-server/assembly/block_properties.hpp"
#include "solid-server/assembly/node_pairs.hpp"
#include "solid-server/element/element_packs.hpp"

namespace couplet::solid {

class WorkTeam;

/// Consistent: from the shape functions. Lumped: diagonal (mass.hpp), as explicit time integration has it.
enum class MassForm { consistent, lumped };

/// A = stiffness * K(u) + mass * M on all components, held ones too, as 3 x 3 blocks of the lower triangle. M is
/// m_ab I for a pair of nodes. Elements are computed in small groups by all members of the team; then
/// each member adds the group to the pairs that are its own, elements rising: sums do not depend on the number of
/// members.
class TangentMatrix {
 public:
  TangentMatrix(const SolidMesh& mesh, const std::vector<BlockProperties>& properties, MassForm mass_form,
                WorkTeam& team);

  const NodePairs& pairs() const { return pairs_; }
  const std::vector<double>& blocks() const { return blocks_; }  // (n_pairs, 3, 3)
  const std::vector<double>& mass() const { return mass_; }      // m_ab, (n_pairs) [kg]

  /// Returns the first element turned inside out (J not above 0, or not a number), or -1. `increment`: see
  /// TangentSolver::assemble.
  Index assemble(const NodeVectors& displacement, const NodeVectors* increment, double stiffness, double mass);

  /// A_ab += C / 2 and A_ba += C^T / 2. False, and nothing is done, when the pair is not in the pattern.
  bool add_symmetric_part(Index a, Index b, const Eigen::Matrix3d& C);

  /// Whether a pair has no entry now; it may be in the pattern all the same.
  bool is_zero(Index a, Index b) const;

  /// The pattern becomes that of the mesh and the extra pairs; the entries stay as they are.
  void set_extra_pairs(const std::vector<std::pair<Index, Index>>& extra);

  NodeVectors multiply(const NodeVectors& vector) const;    // A x
  NodeVectors mass_times(const NodeVectors& vector) const;  // M x

  std::size_t memory_bytes() const;

 private:
  struct Block {
    Material material;
    ElementPacks elements;
    std::vector<Index> place;  // of each pair of local nodes among pairs, (n_packs, local pairs, lanes)
  };
  void find_places();
  void add_consistent_mass(const SolidMesh& mesh, const ElementBlock& elements, double density);
  void set_lumped_mass(const SolidMesh& mesh, const std::vector<BlockProperties>& properties);
  void add_packs(const Block& block, Index first, Index last, const StoredPack* values, Index first_pair,
                 Index last_pair, double factor);

  WorkTeam& team_;
  NodePairs mesh_pairs_, pairs_;
  std::vector<Block> blocks_of_elements_;
  std::vector<double> blocks_, mass_;
  std::vector<StoredPack> buffer_;  // tangents of one group of packs
};

}  // namespace couplet::solid
