#include "solid-server/service/mesh_size.hpp"

#include <cmath>
#include <limits>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

namespace {

// What a mesh and the time loop keep of a 20-node hexahedron with eight points at least: 4 nodes [m] with three arrays
// of motion, 20 node numbers twice, 10 numbers at each point.
constexpr double bytes_per_element = 1600;
// The nodes of all elements are counted with an Index.
constexpr double n_elements_most = std::numeric_limits<Index>::max() / 20.0;

double product(double a, double b, double c) {
  return a * b * c;
}

/// The cube of edge 2 n in the middle, and shells of n layers on its six faces; halves and quarters keep their share.
double n_elements_of(const v1::BallMesh& ball) {
  const double n = ball.elements(), whole = 8 * n * n * n + 6 * 4 * n * n * n;
  return whole * (ball.part() == v1::BallMesh::WHOLE ? 1 : 0.5) * (ball.quarter() ? 0.25 : 1);
}

std::string name_of_mesh(const v1::Body& body) {
  const auto* const field =
      body.GetReflection()->GetOneofFieldDescriptor(body, body.GetDescriptor()->FindOneofByName("mesh"));
  return field ? field->name() : "mesh";
}

}  // namespace

double n_elements_wanted(const v1::Body& body) {
  switch (body.mesh_case()) {
    case v1::Body::kVocalFold: {
      const v1::VocalFoldMesh& fold = body.vocal_fold();
      return product(fold.elements_x(), fold.elements_y(), fold.elements_z()) * (fold.half_length() ? 0.5 : 1);
    }
    case v1::Body::kBox:
      return product(body.box().elements_x(), body.box().elements_y(), body.box().elements_z());
    case v1::Body::kValve:  // at most: a grid thins out towards the commissures
      return 3 * product(body.valve().elements_u(), body.valve().elements_v(), body.valve().elements_t());
    case v1::Body::kCylinderBeam:
      return product(body.cylinder_beam().elements_x(), body.cylinder_beam().elements_y(), 1);
    case v1::Body::kAnnulus:
      return product(body.annulus().elements_radial(), body.annulus().elements_around(),
                     body.annulus().elements_along());
    case v1::Body::kHollowSphere:
      return product(3, std::pow(body.hollow_sphere().elements_around(), 2), body.hollow_sphere().elements_radial());
    case v1::Body::kBall:
      return n_elements_of(body.ball());
    case v1::Body::kArch:
      return product(body.arch().elements_x(), body.arch().elements_y(), body.arch().elements_z());
    case v1::Body::kMeshFile:
    case v1::Body::MESH_NOT_SET:
      break;
  }
  return 0;
}

void refuse_too_many_elements(const v1::Solid& solid, double memory) {
  double n_elements = 0, largest = 0;
  int body = 0;
  for (int b = 0; b < solid.body_size(); ++b) {
    const double wanted = n_elements_wanted(solid.body(b));
    n_elements += wanted;
    if (wanted > largest) largest = wanted, body = b;
  }
  const double needed = n_elements * bytes_per_element;
  const bool can_be_numbered = n_elements < n_elements_most;
  if (can_be_numbered && needed < memory) return;
  using report::text;
  throw report::SceneError(
      "solid.body[" + std::to_string(body) + "]." + name_of_mesh(solid.body(body)),
      text(n_elements) + " elements " +
          (can_be_numbered
               ? "need at least " + text(std::ceil(needed / 1e9)) + " GB of memory, but this machine has " +
                     text(std::floor(memory / 1e9)) + " GB"
               : "are more than the " + text(std::floor(n_elements_most / 1e6)) + " million that can be numbered"),
      "give fewer elements");
}

}  // namespace couplet::solid
