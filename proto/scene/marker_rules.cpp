#include "proto/scene/marker_rules.hpp"

#include <algorithm>

#include "proto/scene/mesh_names.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

void check_marker(const v1::MaterialPoint& point, const std::string& path, const v1::Solid& solid, Review& review) {
  if (!point.has_marker()) return;
  std::vector<std::string> known;
  bool has_mesh = false;
  for (const v1::Body& body : solid.body()) {
    if (has_own_names(body)) return;
    has_mesh = true;
    for (const std::string& name : marker_names(body))
      known.push_back(solid.body_size() == 1 ? name : body.name() + "/" + name);
  }
  if (!has_mesh || std::find(known.begin(), known.end(), point.marker()) != known.end()) return;
  review.complain(path + ".marker", "the mesh has no marker \"" + point.marker() + "\"; " +
                                        (known.empty() ? "give position { x: ... y: ... z: ... } instead"
                                                       : suggestion(point.marker(), known, "it has")));
}

}  // namespace couplet::scene
