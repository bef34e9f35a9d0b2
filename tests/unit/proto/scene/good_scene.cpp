#include "tests/unit/proto/scene/good_scene.hpp"

#include <stdexcept>

#include "proto/scene/read_scene.hpp"

namespace couplet::scene {

const std::string good_scene = R"(title: "a fold in its own flow"
time { end: 0.5  step: 1e-5 }

flow {
  fluid { density: 1.13  viscosity: 1.8e-5 }
  glottis {
    model: M2
    subglottal_pressure {
      row { time: 0 value: 0 }
      row { time: 0.02 value: 1000 }
    }
    entrance_start { marker: "inferior_middle" }
    exit_line { marker: "C2" }
    midplane: 0.0102
  }
}

solid {
  body {
    name: "fold"
    vocal_fold { medial_thickness: 1.75e-3 }
    material {
      density: 1040
      saint_venant_kirchhoff { young_modulus: 15e3  poisson_ratio: 0.475 }
    }
    fixed: ["lateral", "anterior"]
    wetted: ["inferior", "medial", "superior"]
  }
  kick { time: 0.06  velocity { y: "0.6*(y/0.010)^2" } }
}

coupling {
  iqn_ils { }
  convergence { field: "displacement"  relative: 1e-5 }
}

output {
  probe { name: "exit"  at { marker: "C1" } }
  quantity { name: "frequency"  kind: FREQUENCY  column: "exit.y" }
}
)";

std::string with(const std::string& part, const std::string& replacement, const std::string& scene) {
  const std::size_t place = scene.find(part);
  if (place == std::string::npos || scene.find(part, place + 1) != std::string::npos) {
    throw std::logic_error("the scene does not hold exactly once: " + part);
  }
  std::string text = scene;
  return text.replace(place, part.size(), replacement);
}

std::vector<std::string> complaints_about(const std::string& text, const std::vector<std::string>& settings) {
  std::vector<std::string> lines;
  for (const Complaint& complaint : read_scene_text(text, "scene.txtpb", settings).complaints) {
    lines.push_back(complaint.text());
  }
  return lines;
}

}  // namespace couplet::scene
