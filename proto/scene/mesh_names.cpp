#include "proto/scene/mesh_names.hpp"

namespace couplet::scene {

namespace {

/// Each name for all leaflets together and for each of them.
std::vector<std::string> with_leaflets(const std::vector<std::string>& names) {
  std::vector<std::string> out = names;
  for (const std::string& name : names)
    for (const char* const leaflet : {"_1", "_2", "_3"}) out.push_back(name + leaflet);
  return out;
}

}  // namespace

std::vector<std::string> surface_names(const v1::Body& body) {
  switch (body.mesh_case()) {
    case v1::Body::kVocalFold:
      return {"lateral", "inferior", "medial", "superior", "anterior", "posterior"};
    case v1::Body::kBox:
      return {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};
    case v1::Body::kValve:
      return with_leaflets({"ventricular", "aortic", "free_edge", "base", "contact"});
    case v1::Body::kAnnulus:
      return {"inner", "outer", "start", "end", "z_min", "z_max"};
    case v1::Body::kHollowSphere:
      return {"inner", "outer", "x_min", "y_min", "z_min"};
    case v1::Body::kBall:
      return {"surface", "cut", "x_min", "z_min"};
    case v1::Body::kCylinderBeam:
      return {"root", "top", "bottom", "tip", "front", "back"};
    case v1::Body::kArch:
      return {"left", "right", "top", "bottom", "front", "back"};
    case v1::Body::kMeshFile:
    case v1::Body::MESH_NOT_SET:
      break;
  }
  return {};
}

std::vector<std::string> marker_names(const v1::Body& body) {
  switch (body.mesh_case()) {
    case v1::Body::kVocalFold:
      return {"inferior_middle", "B1", "B2", "medial_middle", "C1", "superior_fillet_middle", "C2"};
    case v1::Body::kValve: {
      std::vector<std::string> names;
      for (const char* const marker : {"free_edge_middle", "lower_belly", "upper_belly"})
        for (const char* const leaflet : {"_1", "_2", "_3"}) names.push_back(std::string(marker) + leaflet);
      return names;
    }
    case v1::Body::kCylinderBeam:
      return {"A"};
    case v1::Body::kArch:
      return {"crown"};
    default:
      return {};
  }
}

std::vector<std::string> node_set_names(const v1::Body& body) {
  if (body.has_valve()) return with_leaflets({"commissure"});
  if (body.has_arch()) return {"left_hinge", "right_hinge"};
  return {};
}

std::vector<std::string> region_names(const v1::Body& body) {
  return body.has_valve() ? std::vector<std::string>{"leaflet_1", "leaflet_2", "leaflet_3"}
                          : std::vector<std::string>{};
}

bool has_own_names(const v1::Body& body) {
  return body.has_mesh_file() || body.mesh_case() == v1::Body::MESH_NOT_SET;
}

}  // namespace couplet::scene
