#pragma once
// A small vocal fold as a scene, for tests of the solid's service.

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "proto/participant/participant.hpp"

namespace couplet::solid {

constexpr double coupling_step = 2e-5;  // [s]

inline const std::string solid_text = R"scene(
  title: "a fold"
  time { end: 1 step: 2e-5 }
  solid {
    body {
      name: "fold"
      vocal_fold { medial_thickness: 1.75e-3 elements_x: 3 elements_y: 4 elements_z: 4 half_length: true }
      material { density: 1040 mooney_rivlin { a10: 2290 a01: 250 bulk_modulus: 1e5 } }
      fixed: "lateral" fixed: "anterior"
      symmetry { surface: "posterior" normal: Z }
      wetted: "inferior" wetted: "medial" wetted: "superior"
      mass_damping: 0.05
    }
    rigid_plane { y: 0.0101 }
    settling { until: 1e-4 mass_damping: 400 }
    kick { time: 1e-4 velocity { y: "0.6*(y/0.01)^2*sin(pi*z/0.02)"
}
}
time_integration {
estimate_every:
  3
}
}
)scene";
inline const std::string flow_text = R"scene(
  flow {
    fluid { density: 1.1 viscosity: 1e-5 }
    glottis { model: B1 subglottal_pressure { row { time: 0 value: 100 } } midplane: 0.0102 }
  }
)scene";

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

inline participant::OpenRequest request(const std::string& text) {
  participant::OpenRequest out;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &out.scene));
  return out;
}

inline const participant::NamedNumber& find(const std::vector<participant::NamedNumber>& numbers,
                                            const std::string& name) {
  const auto found = std::find_if(numbers.begin(), numbers.end(), [&](const auto& n) { return n.name == name; });
  if (found == numbers.end()) throw std::out_of_range(name);
  return *found;
}
inline double value_of(const std::vector<participant::NamedNumber>& numbers, const std::string& name) {
  return find(numbers, name).value;
}
inline std::string text_of(const std::vector<participant::NamedNumber>& numbers, const std::string& name) {
  return find(numbers, name).text;
}

inline std::vector<std::string> names(const std::vector<participant::NamedNumber>& numbers) {
  std::vector<std::string> out;
  for (const auto& number : numbers) out.push_back(number.name);
  return out;
}

}  // namespace couplet::solid
