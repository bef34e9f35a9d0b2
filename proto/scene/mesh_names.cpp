#include "proto/scene/mesh_names.hpp"

namespace couplet::scene {

std::vector<std::string> surface_names(const v1::Body& body) {
  switch (body.mesh_case()) {
    case v1::Body::kVocalFold:
      return {"lateral", "inferior", "medial", "superior", "anterior", "posterior"};
    case v1::Body::kBox:
      return {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};
    case v1::Body::MESH_NOT_SET:
      break;
  }
  return {};
}

std::vector<std::string> marker_names(const v1::Body& body) {
  if (!body.has_vocal_fold()) return {};
  return {"inferior_middle", "B1", "B2", "medial_middle", "C1", "superior_fillet_middle", "C2"};
}

}  // namespace couplet::scene
