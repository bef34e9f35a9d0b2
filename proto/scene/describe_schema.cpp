#include "proto/scene/describe_schema.hpp"

#include "couplet/v1/scene.pb.h"

namespace couplet::scene {

std::string describe_schema(const std::string& message) {
  return message;
}

}  // namespace couplet::scene
