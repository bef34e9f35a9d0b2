#pragma once
// Stress and deformation of tissue at the nodes and in the elements of a mesh: what results show beside the motion.

#include "proto/surface/surface_field.hpp"
#include "solid-server/assembly/block_properties.hpp"
#include "solid-server/element/element_packs.hpp"
#include "solid-server/output/region_nodes.hpp"

namespace couplet::solid {

enum class TissueField {
  cauchy_stress,             // at nodes (n, 9), row by row [Pa]
  largest_principal_stress,  // at nodes [Pa]; of the Cauchy stress there
  von_mises_stress,          // likewise
  volume_ratio,              // J at nodes [1]
  fibre_stretch,             // of the first family, at nodes [1]; not a number where a law has no fibres
  fibre_direction,           // of the first family now, in elements (n, 3) [1]; zero where a law has no fibres
};

struct TissueState {
  surface::FieldSet at_nodes;     // of RegionNodes
  surface::FieldSet of_elements;  // counted through all blocks
};

/// What an element says at a node is extrapolated from its points (points_to_nodes); a node takes the mean of the
/// elements around it in one region. Principal and von Mises stresses are those of the mean.
class TissueFields {
 public:
  /// The references must outlive this. Throws SceneError when fields of fibres are wanted and no law has fibres.
  TissueFields(const SolidMesh& mesh, const std::vector<BlockProperties>& properties, std::vector<TissueField> wanted);

  /// By region when a field is wanted that may jump where regions meet.
  const RegionNodes& nodes() const { return nodes_; }

  /// At displacements (n_nodes, 4) [m]; empty when nothing is wanted.
  TissueState at(const NodeVectors& displacement) const;

 private:
  bool is_wanted(TissueField field) const;
  bool needs_nodes() const;

  const SolidMesh& mesh_;
  const std::vector<BlockProperties>& properties_;
  std::vector<TissueField> wanted_;
  RegionNodes nodes_;
  Eigen::VectorXd n_elements_;  // around each node of nodes_
};

}  // namespace couplet::solid
