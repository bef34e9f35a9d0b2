#pragma once
// A scene without fault, and what is complained about when a part of it is replaced.

#include <string>
#include <vector>

namespace couplet::scene {

// In the header, so that it is there before what other files make of it at their start.
inline const std::string good_scene = R"(title: "a fold in its own flow"
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

/// The good scene with a part, that stands there exactly once, replaced.
std::string with(const std::string& part, const std::string& replacement, const std::string& scene = good_scene);

/// Every complaint about a scene that is called scene.txtpb.
std::vector<std::string> complaints_about(const std::string& text, const std::vector<std::string>& settings = {});

}  // namespace couplet::scene
