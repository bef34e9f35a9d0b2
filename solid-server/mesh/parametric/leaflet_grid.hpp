#pragma once
// Where the nodes of a leaflet stand on its mid-surface.

#include <Eigen/Core>
#include <vector>

#include "solid-server/mesh/parametric/leaflet_surface.hpp"

namespace couplet::solid {

/// A leaflet has two corners only, at the commissures, so one patch of quadrilaterals cannot fill it without elements
/// that fold at two places of the attachment. Two patches can: a ring of `n_ring` elements that follows the attachment
/// from commissure to commissure, and a centre inside it that reaches the free edge. Three elements meet at the two
/// lower corners of the centre, four everywhere else.
///
///     commissure _____ free edge ______ commissure
///               \ r |              | r /
///                \ i|    centre    |i /
///                 \n|______________|n/
///                  \ g            g /
///                   \__ attachment_/
///
/// Both are lattices of half elements like StructuredBlock. Ring: i along the attachment from the commissure at u = -1
/// to that at u = 1, j from the attachment inwards. Centre: i along the free edge, j from the ring to the free edge.
/// Attachment and free edge are divided evenly; the inner points, in the projection along the radial direction, are
/// each a weighted mean of their neighbours, which cannot fold [Tutte 1963].
class LeafletGrid {
 public:
  /// n_along: elements along the free edge, n_across: from the attachment's lowest point to the free edge's middle.
  /// Throws SceneError for fewer than 4 and 2.
  LeafletGrid(const LeafletSurface& surface, int n_along, int n_across);

  int n_ring() const { return n_ring_; }                                     // elements of the ring between its sides
  int n_centre_along() const { return n_along_ - 2 * n_ring_; }              // elements of the centre
  int n_centre_across() const { return n_across_ - n_ring_; }                // elements of the centre
  int n_around() const { return n_centre_along() + 2 * n_centre_across(); }  // elements along the attachment

  /// (u, v) of a place of each lattice.
  Eigen::Vector2d ring(int i, int j) const { return parameters_[ring_point(i, j)]; }
  Eigen::Vector2d centre(int i, int j) const { return parameters_[centre_point(i, j)]; }

 private:
  std::size_t ring_point(int i, int j) const;
  std::size_t centre_point(int i, int j) const;

  int n_along_, n_across_, n_ring_;
  std::vector<Eigen::Vector2d> parameters_;  // of every point: the centre's, then the ring's others
};

}  // namespace couplet::solid
