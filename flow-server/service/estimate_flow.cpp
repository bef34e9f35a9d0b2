#include "flow-server/service/estimate_flow.hpp"

#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {
// Measured on one core of about 3 GHz with 140 stations and 96 faces.
constexpr double seconds_per_station = 2e-8;
constexpr double seconds_per_face = 1e-7, seconds_per_strip = 5e-8;
// Arrays of stations of the three states and their work space, of faces with their share of nodes.
constexpr double bytes_per_station = 40 * sizeof(double);
constexpr double bytes_per_face = 100 * sizeof(double);
// The program and its libraries before any of this.
constexpr double bytes_of_program = 30e6;
}  // namespace

std::vector<participant::NamedNumber> estimate_flow(const participant::OpenRequest& request) {
  if (!request.scene.flow().has_glottis()) throw report::SceneError("flow", "it names no model", "add flow.glottis");
  const v1::Glottis& glottis = request.scene.flow().glottis();
  const double n_stations = glottis.stations();
  std::vector<participant::NamedNumber> numbers{{"stations", n_stations, "1"}};
  if (!request.peer_surface && !glottis.has_channel()) return numbers;  // faces, which cost most, are not known yet

  const double n_faces = request.peer_surface ? static_cast<double>(request.peer_surface->n_faces()) : 0;
  if (request.peer_surface) numbers.push_back({"faces", n_faces, "1"});
  const double seconds_per_face_now = seconds_per_face + seconds_per_strip * glottis.strips_per_element();
  numbers.push_back({"seconds_per_solve", seconds_per_station * n_stations + seconds_per_face_now * n_faces, "s"});
  numbers.push_back(
      {"memory_bytes", bytes_of_program + bytes_per_station * n_stations + bytes_per_face * n_faces, "1"});
  return numbers;
}

}  // namespace couplet::flow
