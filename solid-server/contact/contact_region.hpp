#pragma once
// A named part of the boundary as contact sees it: faces that are touched, points that touch.

#include <vector>

#include "solid-server/contact/curved_face.hpp"
#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// Contact numbers the nodes of all its regions on its own, so that what it reads stands together: a contact node.
using ContactPositions = std::vector<NodeQuad>;  // (n contact nodes) [m]

struct ContactFace {
  Index patch = 0;  // faces that hang together, by shared nodes, are one patch of the region
  FaceShape shape = FaceShape::quadrilateral8;
  std::array<Index, max_face_nodes> node{};  // contact nodes; 0 where the shape has none
  std::array<bool, 4> is_open_edge{};        // the region ends there: no second face of it has this edge
  std::array<bool, 4> is_open_corner{};      // at the end of an open edge

  CurvedFace curved(const ContactPositions& x) const;
  /// Mean of the corners.
  NodeQuad middle(const ContactPositions& x) const;
};

/// A point that is kept from passing through the faces of another region: a quadrature point of a face.
struct ContactPoint {
  Index face = 0;                              // of its own region
  std::array<double, max_face_nodes> shape{};  // N_a there
  double area = 0;                             // that it stands for, at rest [m^2]
};

struct ContactRegion {
  std::vector<Index> node;  // contact nodes, rising
  std::vector<ContactFace> face;
  std::vector<ContactPoint> point;

  NodeQuad position(const ContactPoint& point, const ContactPositions& x) const;
};

/// `contact_node` gives the contact node of each node of the mesh that is in a region; `rest` their positions.
ContactRegion make_contact_region(const std::vector<FaceNodes>& faces, const std::vector<Index>& contact_node,
                                  const ContactPositions& rest);

}  // namespace couplet::solid
