#pragma once
// Named quantities on the nodes of an interface surface.

#include <string>
#include <vector>

#include "proto/surface/surface_mesh.hpp"

namespace couplet::surface {

/// The fields that flow and solid exchange: force [N] (3), displacement [m] (3), velocity [m/s] (3). Others are
/// allowed.
struct Field {
  std::string name;
  std::string unit;
  NodeArray values;  // (n_nodes, n_components)
};

using FieldSet = std::vector<Field>;

/// The field of that name; throws PeerError when it is missing.
const Field& find_field(const FieldSet& fields, const std::string& name);

}  // namespace couplet::surface
