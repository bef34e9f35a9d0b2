#include "proto/surface/surface_field.hpp"

#include "proto/report/failure.hpp"

namespace couplet::surface {

const Field& find_field(const FieldSet& fields, const std::string& name) {
  for (const Field& field : fields) {
    if (field.name == name) return field;
  }
  std::string present;
  for (const Field& field : fields) present += (present.empty() ? "" : ", ") + field.name;
  throw report::PeerError("", "the field '" + name + "' is missing; present: " + (present.empty() ? "none" : present),
                          "check that flow and solid offer what the other needs");
}

}  // namespace couplet::surface
