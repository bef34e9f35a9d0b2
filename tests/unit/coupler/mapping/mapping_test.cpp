#include "coupler/mapping/mapping.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <random>

#include "proto/report/failure.hpp"
#include "tests/unit/coupler/mapping/surfaces.hpp"

namespace couplet::coupling {
namespace {

using surface::NodeArray;
using surface::SurfaceMesh;

// Sums over some hundred nodes lose a few digits of the last place each.
constexpr double round_off = 1e-14;

NodeArray random_field(Eigen::Index n_nodes, unsigned seed, double size) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  NodeArray field(n_nodes, 3);
  for (Eigen::Index i = 0; i < field.size(); ++i) field.data()[i] = uniform(generator);
  return field;
}

NodeArray linear_field(const NodeArray& position) {
  Eigen::Matrix3d gradient;
  gradient << 0.3, -1.2, 0.4, 2.0, 0.1, -0.7, 0.5, 0.6, 0.9;
  return (position * gradient.transpose()).rowwise() + Eigen::RowVector3d(0.1, -0.2, 0.3);
}

/// Displacement that turns the surface by a finite angle about an axis that does not pass through it, and shifts it.
NodeArray rigid_motion(const NodeArray& position) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const NodeArray turned = (position * turn.transpose()).rowwise() + Eigen::RowVector3d(0.01, 0.02, -0.005);
  return turned - position;
}

SurfaceMesh shuffled(const SurfaceMesh& mesh, unsigned seed) {
  std::vector<std::int64_t> new_place(static_cast<std::size_t>(mesh.n_nodes()));
  std::iota(new_place.begin(), new_place.end(), 0);
  std::shuffle(new_place.begin(), new_place.end(), std::mt19937(seed));
  SurfaceMesh result = mesh;
  for (std::int64_t node = 0; node < mesh.n_nodes(); ++node)
    result.node_position.row(new_place[node]) = mesh.node_position.row(node);
  for (auto& node : result.face_node) node = new_place[node];
  return result;
}

struct Case {
  std::string name;
  MappingKind kind;
  SurfaceMesh flow, solid;
  bool keeps_moment;  // see mapping.hpp
};

std::vector<Case> all_cases() {
  const Shape off_plane = [](double a, double b) -> Eigen::Vector3d {
    return plane(a, b) + Eigen::Vector3d(1e-4, 3e-4 * std::sin(5 * a), 0);
  };
  std::vector<Case> cases{
      {"identity", MappingKind::automatic, make_surface(8, 5, 4, cylinder), make_surface(8, 5, 4, cylinder), true},
      {"permuted", MappingKind::matching, shuffled(make_surface(4, 6, 5, cylinder), 1), make_surface(4, 6, 5, cylinder),
       true},
      {"nearest", MappingKind::nearest_point, make_surface(4, 7, 9, cylinder), make_surface(8, 5, 4, cylinder), false},
  };
  for (const int nodes : {3, 4, 6, 8}) {
    const std::string on = " on faces of " + std::to_string(nodes) + " nodes";
    cases.push_back({"plane" + on, MappingKind::closest_face, make_surface(4, 7, 9, plane),
                     make_surface(nodes, 4, 3, plane), true});
    cases.push_back({"cylinder" + on, MappingKind::closest_face, make_surface(3, 11, 6, cylinder),
                     make_surface(nodes, 4, 3, cylinder), true});
    cases.push_back({"off the plane" + on, MappingKind::closest_face, make_surface(8, 7, 9, off_plane),
                     make_surface(nodes, 4, 3, plane), true});
  }
  return cases;
}

TEST(Mapping, KeepsTotalForceMomentAndVirtualWorkOfAnyExchange) {
  for (const Case& c : all_cases()) {
    SCOPED_TRACE(c.name);
    const Mapping mapping(c.flow, c.solid, c.kind);
    // Displacements of a tenth of a face and more: the deformed surface is far from the reference.
    const NodeArray displacement = rigid_motion(c.solid.node_position) + random_field(c.solid.n_nodes(), 3, 3e-4);
    const NodeArray velocity = random_field(c.solid.n_nodes(), 4, 1.0);
    const NodeArray force = random_field(c.flow.n_nodes(), 5, 1e-3);
    const NodeArray solid_force = mapping.force_to_solid(force, displacement);
    const ConservationError error = mapping.conservation_error(force, solid_force, displacement, velocity);
    EXPECT_LT(error.force, round_off);
    EXPECT_LT(error.work, round_off);
    if (c.keeps_moment) {
      EXPECT_LT(error.moment, 10 * round_off);
    }
  }
}

TEST(Mapping, CarriesRigidMotionExactly) {
  for (const Case& c : all_cases()) {
    if (!c.keeps_moment) continue;
    SCOPED_TRACE(c.name);
    const Mapping mapping(c.flow, c.solid, c.kind);
    const NodeArray moved = mapping.displacement_to_flow(rigid_motion(c.solid.node_position));
    const double difference = (moved - rigid_motion(c.flow.node_position)).cwiseAbs().maxCoeff();
    EXPECT_LT(difference, 1e-15);  // positions of 0.1 m have a last place of 1e-17 m; arms divide by faces of some mm
  }
}

TEST(Mapping, CarriesConstantsExactlyForEveryKind) {
  for (const Case& c : all_cases()) {
    SCOPED_TRACE(c.name);
    const Mapping mapping(c.flow, c.solid, c.kind);
    const NodeArray shift = NodeArray::Ones(c.solid.n_nodes(), 1) * Eigen::RowVector3d(1, -2, 3);
    const NodeArray expected = NodeArray::Ones(c.flow.n_nodes(), 1) * Eigen::RowVector3d(1, -2, 3);
    EXPECT_LT((mapping.displacement_to_flow(shift) - expected).cwiseAbs().maxCoeff(), round_off);
    EXPECT_LT((mapping.velocity_to_flow(shift, 0 * shift) - expected).cwiseAbs().maxCoeff(), round_off);
    const NodeArray scalar = NodeArray::Constant(c.solid.n_nodes(), 1, 7.0);
    EXPECT_LT((mapping.displacement_to_flow(scalar).array() - 7.0).abs().maxCoeff(), 7 * round_off);
  }
}

TEST(Mapping, CarriesLinearFieldsExactlyOnAPlane) {
  for (const int nodes : {3, 4, 6, 8}) {
    const SurfaceMesh solid = make_surface(nodes, 4, 3, plane), flow = make_surface(4, 7, 9, plane);
    const Mapping mapping(flow, solid, MappingKind::closest_face);
    const NodeArray velocity = mapping.velocity_to_flow(linear_field(solid.node_position), 0 * solid.node_position);
    EXPECT_LT((velocity - linear_field(flow.node_position)).cwiseAbs().maxCoeff(), round_off) << nodes;
  }
}

TEST(Mapping, CarriesQuadraticFieldsExactlyOnAPlaneOfQuadraticFaces) {
  const auto square = [](const NodeArray& position) {
    NodeArray field = position;
    field.col(0) = position.col(0).cwiseProduct(position.col(2));
    field.col(1) = position.col(0).cwiseAbs2();
    field.col(2) = position.col(2).cwiseAbs2();
    return field;
  };
  for (const int nodes : {6, 8}) {
    const SurfaceMesh solid = make_surface(nodes, 4, 3, plane), flow = make_surface(4, 7, 9, plane);
    const Mapping mapping(flow, solid, MappingKind::closest_face);
    const NodeArray velocity = mapping.velocity_to_flow(square(solid.node_position), 0 * solid.node_position);
    // Values are about 4e-4; the projection finds its place to 1e-12 of a face.
    EXPECT_LT((velocity - square(flow.node_position)).cwiseAbs().maxCoeff(), 1e-15) << nodes;
  }
}

TEST(Mapping, ForceIsTransposedMotion) {
  for (const Case& c : all_cases()) {
    SCOPED_TRACE(c.name);
    const Mapping mapping(c.flow, c.solid, c.kind);
    const NodeArray displacement = rigid_motion(c.solid.node_position);
    // One unit force and one unit velocity at a time: the (i, j) entry must be the same number seen from both sides.
    for (const auto& [i, j] : {std::pair<int, int>{0, 0}, {10, 4}, {25, 11}, {30, 17}}) {
      NodeArray force = NodeArray::Zero(c.flow.n_nodes(), 3), velocity = NodeArray::Zero(c.solid.n_nodes(), 3);
      force(i % c.flow.n_nodes(), i % 3) = 1;
      velocity(j % c.solid.n_nodes(), j % 3) = 1;
      const double from_force = mapping.force_to_solid(force, displacement).cwiseProduct(velocity).sum();
      const double from_motion = mapping.velocity_to_flow(velocity, displacement).cwiseProduct(force).sum();
      EXPECT_NEAR(from_force, from_motion, round_off);
    }
  }
}

TEST(Mapping, VelocityIsTheDerivativeOfDisplacement) {
  for (const Case& c : all_cases()) {
    SCOPED_TRACE(c.name);
    const Mapping mapping(c.flow, c.solid, c.kind);
    const NodeArray u = rigid_motion(c.solid.node_position), v = random_field(c.solid.n_nodes(), 4, 1.0);
    const double h =
        1e-7;  // [s] second-order error (h v / face)^2 = 1e-9, round-off 1e-17 / h = 1e-10 of velocities of 1
    const NodeArray difference =
        (mapping.displacement_to_flow(u + h * v) - mapping.displacement_to_flow(u - h * v)) / (2 * h);
    EXPECT_LT((mapping.velocity_to_flow(v, u) - difference).cwiseAbs().maxCoeff(), 1e-7);
  }
}

TEST(Mapping, NoMotionOfTheSolidIsNoMotionOfTheFlow) {
  for (const Case& c : all_cases()) {
    const Mapping mapping(c.flow, c.solid, c.kind);
    const NodeArray still = NodeArray::Zero(c.solid.n_nodes(), 3);
    EXPECT_LT(mapping.displacement_to_flow(still).cwiseAbs().maxCoeff(), 1e-18) << c.name;
  }
}

TEST(Mapping, ChoosesMatchingWhereNodesCoincideAndClosestFaceElsewhere) {
  const SurfaceMesh solid = make_surface(8, 5, 4, cylinder);
  const Mapping same(solid, solid, MappingKind::automatic);
  EXPECT_EQ(same.kind(), MappingKind::matching);
  EXPECT_TRUE(same.is_identity());
  const Mapping permuted(shuffled(solid, 2), solid, MappingKind::automatic);
  EXPECT_EQ(permuted.kind(), MappingKind::matching);
  EXPECT_FALSE(permuted.is_identity());
  EXPECT_EQ(Mapping(make_surface(4, 6, 4, cylinder), solid, MappingKind::automatic).kind(), MappingKind::closest_face);
  SurfaceMesh points;
  points.node_position = solid.node_position;
  EXPECT_EQ(Mapping(make_surface(4, 6, 4, cylinder), points, MappingKind::automatic).kind(),
            MappingKind::nearest_point);
}

TEST(Mapping, ClosestFaceOnCoincidingNodesIsTheIdentity) {
  const SurfaceMesh solid = make_surface(8, 5, 4, cylinder);
  const Mapping mapping(solid, solid, MappingKind::closest_face);
  const NodeArray field = random_field(solid.n_nodes(), 6, 1.0);
  EXPECT_LT((mapping.displacement_to_flow(field) - field).cwiseAbs().maxCoeff(), 1e-11);  // projection: 1e-12 of a face
}

TEST(Mapping, FollowsAnOverhangStraightOnForAtMostOneFace) {
  const SurfaceMesh solid = make_surface(4, 4, 3, plane);  // faces of a quarter of the plane's length
  const auto longer = [](double share) { return [share](double a, double b) { return plane((1 + share) * a, b); }; };
  const NodeArray displacement = rigid_motion(solid.node_position);
  const SurfaceMesh near = make_surface(4, 8, 3, longer(0.2)), far = make_surface(4, 8, 3, longer(0.5));
  const auto error = [&](const SurfaceMesh& flow) {
    const NodeArray moved = Mapping(flow, solid, MappingKind::closest_face).displacement_to_flow(displacement);
    return (moved - rigid_motion(flow.node_position)).cwiseAbs().maxCoeff();
  };
  EXPECT_LT(error(near), 1e-15);
  EXPECT_GT(error(far), 1e-4);
}

TEST(Mapping, ReportsTheLargestDistance) {
  const Shape lifted = [](double a, double b) -> Eigen::Vector3d {
    return plane(a, b) + 2e-3 * (plane(1, 0) - plane(0, 0)).cross(plane(0, 1) - plane(0, 0)).normalized();
  };
  const Mapping mapping(make_surface(4, 7, 9, lifted), make_surface(8, 4, 3, plane), MappingKind::closest_face);
  EXPECT_NEAR(mapping.largest_distance(), 2e-3, 1e-15);
}

TEST(Mapping, NamesTheFirstNodeWithoutPartner) {
  const SurfaceMesh solid = make_surface(4, 6, 5, plane);
  SurfaceMesh flow = shuffled(solid, 3);
  flow.node_position(7, 1) += 1e-3;
  try {
    Mapping(flow, solid, MappingKind::matching);
    FAIL() << "was accepted";
  } catch (const report::SceneError& error) {
    EXPECT_EQ(error.where(), "coupling.mapping");
    EXPECT_THAT(error.sentence(), testing::StartsWith("MATCHING: flow node 7 at ("));
    EXPECT_THAT(error.sentence(), testing::HasSubstr("has no partner on the solid's surface"));
    EXPECT_EQ(error.advice(), "use CLOSEST_FACE or AUTOMATIC");
  }
}

TEST(Mapping, RefusesMatchingWhenTheSolidHasMoreNodes) {
  const SurfaceMesh solid = make_surface(4, 6, 5, plane);
  SurfaceMesh flow;
  flow.node_position = solid.node_position.topRows(10);
  EXPECT_THROW(Mapping(flow, solid, MappingKind::matching), report::SceneError);
}

TEST(Mapping, RefusesSurfacesThatHaveNothingToFollow) {
  const SurfaceMesh solid = make_surface(4, 2, 2, plane);
  SurfaceMesh points;
  points.node_position = solid.node_position;
  EXPECT_THROW(Mapping(solid, points, MappingKind::closest_face), report::SceneError);
  EXPECT_THROW(Mapping(solid, SurfaceMesh{}, MappingKind::automatic), report::SceneError);
  EXPECT_THROW(Mapping(SurfaceMesh{}, solid, MappingKind::automatic), report::SceneError);
}

}  // namespace
}  // namespace couplet::coupling
