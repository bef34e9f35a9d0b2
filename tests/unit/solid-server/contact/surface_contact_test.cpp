#include "solid-server/contact/surface_contact.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

#include "proto/report/failure.hpp"
#include "solid-server/contact/penalty_stiffness.hpp"
#include "solid-server/element/element_packs.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "solid-server/support/symmetric_eigenvalues.hpp"

namespace couplet::solid {
namespace {

constexpr double d0 = 0.05, k = 1e4;

/// A plate of 3 x 3 x 1 elements over one of 2 x 2 x 1, both 1 wide and 0.3 thick; the gap between them is 0.2.
SolidMesh two_plates() {
  SolidMesh below = make_box_mesh({{1, 1, 0.3}, {2, 2, 1}}), above = make_box_mesh({{1, 1, 0.3}, {3, 3, 1}});
  above.node_position.col(2).array() += 0.5;
  return join_bodies({below, above}, {"below", "above"});
}

ContactPair pair_of_plates() {
  return {"above/z_min", "below/z_max", k, d0, 0.1};
}

bool is_above(const SolidMesh& mesh, Index node) {
  return mesh.node_position(node, 2) > 0.4;
}

/// The upper plate is moved; all nodes are disturbed, so that faces are curved and nothing is symmetric.
NodeVectors moved(const SolidMesh& mesh, const Eigen::RowVector3d& motion, double disturbance) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> move(-disturbance, disturbance);
  NodeVectors u = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n) {
    if (is_above(mesh, n)) u.row(n).head<3>() = motion;
    for (int i = 0; i < 3; ++i) u(n, i) += move(random);
  }
  return u;
}

NodeVectors force_at(SurfaceContact& contact, const NodeVectors& u) {
  NodeVectors force = NodeVectors::Zero(u.rows(), 4);
  contact.add(u.data(), force.data());
  return force;
}

TEST(SurfaceContact, PressesWithStiffnessTimesDepthTimesArea) {
  const SolidMesh mesh = two_plates();
  SurfaceContact contact(mesh, {pair_of_plates()});
  const NodeVectors u = moved(mesh, {0, 0, -0.17}, 0);  // d = 0.03, g = 0.02 all over an area of 1
  const NodeVectors force = force_at(contact, u);
  double on_upper = 0;
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    if (is_above(mesh, n)) on_upper += force(n, 2);
  EXPECT_NEAR(on_upper, k * 0.02, 1e-10);  // round-off
  EXPECT_NEAR(contact.total(u.data()).energy, k / 2 * 0.02 * 0.02, 1e-12);
  EXPECT_NEAR(contact.total(u.data()).force, k * 0.02, 1e-10);
  EXPECT_NEAR(contact.total(u.data()).smallest_distance, 0.03, 1e-14);
}

TEST(SurfaceContact, IsMinusTheDerivativeOfItsEnergy) {
  const SolidMesh mesh = two_plates();
  SurfaceContact contact(mesh, {pair_of_plates()});
  // Over inner edges and corners of faces, and past the border of the lower plate.
  const NodeVectors at = moved(mesh, {0.24, 0.13, -0.175}, 0.012);
  const NodeVectors force = force_at(contact, at);
  ASSERT_GT(contact.total(at.data()).n_touching, 30);
  const double h = 1e-6;
  double largest_error = 0;
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    for (int i = 0; i < 3; ++i) {
      NodeVectors more = at, less = at;
      more(n, i) += h;
      less(n, i) -= h;
      const double slope = (contact.total(more.data()).energy - contact.total(less.data()).energy) / (2 * h);
      largest_error = std::max(largest_error, std::abs(force(n, i) + slope));
    }
  // Round-off 1e-16 J / h, and points that begin to touch within h: k A h^2 / h.
  EXPECT_LT(largest_error, 1e-6 * force.cwiseAbs().maxCoeff());
}

TEST(SurfaceContact, KeepsMomentumAndAngularMomentum) {
  const SolidMesh mesh = two_plates();
  SurfaceContact contact(mesh, {pair_of_plates()});
  const NodeVectors u = moved(mesh, {0.24, 0.13, -0.175}, 0.012);
  const NodeVectors force = force_at(contact, u);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), moment = sum;
  for (Index n = 0; n < mesh.n_nodes(); ++n) {
    const Eigen::Vector3d f = force.row(n).head<3>();
    sum += f;
    moment += Eigen::Vector3d(mesh.node_position.row(n) + u.row(n).head<3>()).cross(f);
  }
  const double size = force.cwiseAbs().sum();
  EXPECT_LT(sum.norm(), 1e-15 * size);
  EXPECT_LT(moment.norm(), 1e-14 * size);  // Newton ends at the round-off of coordinates of order 1
}

TEST(SurfaceContact, EnergyIsContinuousFromFaceToFaceAndPastTheBorder) {
  const SolidMesh mesh = two_plates();
  SurfaceContact contact(mesh, {pair_of_plates()});
  const double step = 2e-4;
  double largest_jump = 0, largest_energy = 0, before = -1, work_before = 0;
  for (double way = -0.2; way < 1.2; way += step) {  // slides across the whole lower plate and off it
    const NodeVectors u = moved(mesh, {way, 0.3 * way, -0.175}, 0.01);
    const NodeVectors force = force_at(contact, u);
    const double energy = contact.total(u.data()).energy;
    double power = 0;
    for (Index n = 0; n < mesh.n_nodes(); ++n)
      if (is_above(mesh, n)) power -= force(n, 0) + 0.3 * force(n, 1);
    if (before >= 0)
      largest_jump = std::max(largest_jump, std::abs(energy - before - step * (power + work_before) / 2));
    before = energy;
    work_before = power;
    largest_energy = std::max(largest_energy, energy);
  }
  // The trapezoidal rule of a force with kinks: k A g step per point that crosses an edge (g of 0.03 and A of 1/36 / 4,
  // a change of direction of 0.1), against energies of k A g^2 / 2.
  EXPECT_LT(largest_jump, 1e-4 * largest_energy);
  EXPECT_EQ(before, 0);  // in the end it is beside the lower plate
}

TEST(SurfaceContact, SameBitsForAnyNumberOfMembers) {
  const SolidMesh mesh = two_plates();
  SurfaceContact reference(mesh, {pair_of_plates()});
  const NodeVectors u = moved(mesh, {0.24, 0.13, -0.175}, 0.012);
  NodeVectors expected = NodeVectors::Zero(reference.n_nodes(), 4);
  reference.search(u.data());
  reference.find_gaps(0, 1);
  reference.write(0, 1, expected.data());
  const NodeVectors summed = force_at(reference, u);
  for (const int n_members : {2, 3, 7}) {
    SurfaceContact contact(mesh, {pair_of_plates()});
    // Another search before, whose list is still good: history must not show either.
    const NodeVectors close = moved(mesh, {0.24, 0.13, -0.17}, 0.012);
    contact.search(close.data());
    NodeVectors force = NodeVectors::Zero(contact.n_nodes(), 4);
    contact.search(u.data());
    for (int member = 0; member < n_members; ++member) contact.find_gaps(member, n_members);
    for (int member = 0; member < n_members; ++member) contact.write(member, n_members, force.data());
    EXPECT_EQ(force, expected);
    for (Index n = 0; n < contact.n_nodes(); ++n) {
      EXPECT_EQ(contact.interface_load_factor(n), reference.interface_load_factor(n));
      EXPECT_LT((force.row(n) - summed.row(contact.node()[static_cast<std::size_t>(n)])).norm(), 1e-12);
    }
  }
}

TEST(SurfaceContact, LeavesNothingBehindWhenBodiesLetGo) {
  const SolidMesh mesh = two_plates();
  SurfaceContact contact(mesh, {pair_of_plates()});
  NodeVectors force = NodeVectors::Zero(contact.n_nodes(), 4);
  const auto write_at = [&](double z) {
    contact.search(moved(mesh, {0, 0, z}, 0).data());
    contact.find_gaps(0, 1);
    contact.write(0, 1, force.data());
  };
  write_at(-0.17);
  EXPECT_GT(force.cwiseAbs().maxCoeff(), 0);
  write_at(5);
  EXPECT_EQ(force.cwiseAbs().maxCoeff(), 0);
  for (Index n = 0; n < contact.n_nodes(); ++n) EXPECT_EQ(contact.interface_load_factor(n), 1);
}

TEST(SurfaceContact, SearchesSeldomWhileBodiesApproach) {
  const SolidMesh mesh = two_plates();
  SurfaceContact contact(mesh, {pair_of_plates()});
  const long at_start = contact.n_searches();
  constexpr int n_steps = 10000;
  for (int n = 0; n <= n_steps; ++n) {  // from 10 above to contact, both carried along by 3
    NodeVectors u = moved(mesh, {0, 0, 10 * (1 - n / double{n_steps}) - 0.17}, 0);
    u.col(0).array() += 3.0 * n / n_steps;
    contact.search(u.data());
  }
  // Once far away (the boxes are apart, so that the whole way may pass), then at every skin of 1/8 near the end.
  EXPECT_LE(contact.n_searches() - at_start, 5);
}

TEST(SurfaceContact, CancelsTheInterfaceLoadSmoothly) {
  const SolidMesh mesh = two_plates();
  SurfaceContact contact(mesh, {pair_of_plates()});
  NodeVectors force = NodeVectors::Zero(contact.n_nodes(), 4);
  double before = 1;
  for (double gap = -1e-3; gap < 2 * cancelling_range * d0; gap += 1e-4) {
    contact.search(moved(mesh, {0, 0, -0.15 - gap}, 0).data());
    contact.find_gaps(0, 1);
    contact.write(0, 1, force.data());
    const double factor = contact.interface_load_factor(0);
    for (Index n = 0; n < contact.n_nodes(); ++n) EXPECT_NEAR(contact.interface_load_factor(n), factor, 1e-12);
    if (gap <= 0) {
      EXPECT_EQ(factor, 1);
    }
    if (gap >= cancelling_range * d0) {
      EXPECT_NEAR(factor, 0, 1e-12);
    }
    EXPECT_LE(before - factor, 1.5 * 1e-4 / (cancelling_range * d0) + 1e-12);  // the steepest place of the smooth step
    before = factor;
  }
}

TEST(SurfaceContact, CancelsTheWholeInterfaceLoadOfASurfaceWithTwoNeighboursWhereOnePresses) {
  SolidMesh below = make_box_mesh({{1, 1, 0.3}, {2, 2, 1}}), above = below, far_away = below;
  above.node_position.col(2).array() += 0.5;
  far_away.node_position.col(2).array() -= 5;
  const SolidMesh mesh = join_bodies({below, above, far_away}, {"below", "above", "far_away"});
  SurfaceContact contact(mesh, {pair_of_plates(), {"above/z_min", "far_away/z_max", k, d0, 0.1}});
  NodeVectors force = NodeVectors::Zero(contact.n_nodes(), 4);
  contact.search(moved(mesh, {0, 0, -0.19}, 0).data());  // 0.04 deep, four fifths of d0
  contact.find_gaps(0, 1);
  contact.write(0, 1, force.data());
  for (Index n = 0; n < contact.n_nodes(); ++n) {
    const bool is_pressed = mesh.node_position(contact.node()[static_cast<std::size_t>(n)], 2) > 0;
    EXPECT_NEAR(contact.interface_load_factor(n), is_pressed ? 0 : 1, 1e-12);
  }
}

TEST(SurfaceContact, LeavesBodiesAloneThatHaveBlownUp) {
  const SolidMesh mesh = two_plates();
  SurfaceContact contact(mesh, {pair_of_plates()});
  NodeVectors u = moved(mesh, {0, 0, -0.18}, 0);
  EXPECT_GT(contact.total(u.data()).n_touching, 0);
  for (const double value : {1e9, std::numeric_limits<double>::infinity(), std::nan("")}) {
    NodeVectors blown_up = u;
    blown_up(contact.node()[0], 1) = value;
    EXPECT_EQ(contact.total(blown_up.data()).n_touching, 0);
    EXPECT_EQ(force_at(contact, blown_up).norm(), 0);
  }
  EXPECT_GT(contact.total(u.data()).n_touching, 0);
}

TEST(SurfaceContact, StiffnessIsTheDerivativeOfTheForceWhereTheGapIsSmall) {
  const SolidMesh mesh = two_plates();
  SurfaceContact contact(mesh, {pair_of_plates()});
  const double gap = 1e-7;  // what is left out is smaller than what is there by gap / face size
  const NodeVectors at = moved(mesh, {0.03, 0.02, -0.15 - gap}, 0);
  const Eigen::Index n = 3 * mesh.n_nodes();
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
  for (const auto& [weights, stiffness] : contact.stiffness(at.data()))
    for (const auto& [a, c_a] : weights)
      for (const auto& [b, c_b] : weights) K.block<3, 3>(3 * a, 3 * b) += stiffness * c_a * c_b.transpose();
  const double scale = K.cwiseAbs().maxCoeff(), h = 1e-9;
  ASSERT_GT(scale, 0);
  double error = 0;
  const NodeVectors force = force_at(contact, at);
  for (Index b = 0; b < mesh.n_nodes(); ++b) {
    NodeVectors more = at;
    more(b, 2) += h;
    const NodeVectors change = (force_at(contact, more) - force) / h;
    for (Index a = 0; a < mesh.n_nodes(); ++a)
      error = std::max(error, std::abs(change(a, 2) + K(3 * a + 2, 3 * b + 2)));
  }
  EXPECT_LT(error, 1e-5 * scale);  // round-off of forces k A gap 1e-16 / h: 1e-8; coordinates 1e-16 / h: 1e-7
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues().minCoeff(), -1e-12 * scale);
}

/// A stiffness that is found by hand: a point in a valley between two faces that are bent by hand.
TEST(SurfaceContact, StiffnessAcrossAValleyIsThatOfTheBall) {
  SolidMesh mesh = join_bodies({make_box_mesh({{2, 1, 0.3}, {2, 1, 1}}), make_box_mesh({{0.1, 0.2, 0.3}, {1, 1, 1}})},
                               {"below", "above"});
  const double bend = 0.04;  // of each half of the lower plate
  NodeVectors u = NodeVectors::Zero(mesh.n_nodes(), 4);
  std::vector<Index> upper;
  for (Index n = 0; n < mesh.n_nodes(); ++n) {
    if (n < make_box_mesh({{2, 1, 0.3}, {2, 1, 1}}).n_nodes()) {
      mesh.node_position(n, 2) += bend * std::abs(mesh.node_position(n, 0) - 1);
    } else {
      upper.push_back(n);
      mesh.node_position.row(n) += Eigen::RowVector3d(0.95, 0.4, 0.4);  // its middle points are over the valley
      u(n, 2) = -0.08;
    }
  }
  SurfaceContact contact(mesh, {{"above/z_min", "below/z_max", k, d0, 0.1}});
  double along_valley = 0, across = 0;
  for (const auto& [weights, stiffness] : contact.stiffness(u.data())) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();  // c of the upper block that moves as a whole
    for (const auto& [node, c] : weights)
      if (node >= upper.front()) sum += c;
    along_valley += stiffness * sum.y() * sum.y();
    across += stiffness * sum.x() * sum.x();
  }
  const double h = 1e-6;
  const auto force_across = [&](double x) {
    NodeVectors at = u;
    for (const Index n : upper) at(n, 0) += x;
    const NodeVectors force = force_at(contact, at);
    double sum = 0;
    for (const Index n : upper) sum += force(n, 0);
    return sum;
  };
  EXPECT_EQ(along_valley, 0);
  // Over flat faces nothing is left out: error of the difference h^2 / rho^2, of round-off 1e-16 k / h.
  EXPECT_NEAR(across, -(force_across(h) - force_across(-h)) / (2 * h), 1e-5 * across);
  EXPECT_GT(across, 0);
}

TEST(SurfaceContact, StiffnessBoundHoldsWherePointsFallOnAnyFace) {
  const SolidMesh mesh = two_plates();
  SurfaceContact contact(mesh, {pair_of_plates()});
  const Eigen::VectorXd bound = contact.stiffness_bound(mesh.n_nodes());
  // K u = lambda diag(bound) u must have lambda <= 1.
  const Eigen::VectorXd scale = bound.unaryExpr([](double b) { return b > 0 ? 1 / std::sqrt(b) : 0; });
  double largest = 0;
  for (const double x : {0., 0.1, 0.2, 0.3, 0.4}) {
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(mesh.n_nodes(), mesh.n_nodes());  // of motion along z
    for (const auto& [weights, stiffness] : contact.stiffness(moved(mesh, {x, 0.7 * x, -0.17}, 0).data()))
      for (const auto& [a, c_a] : weights)
        for (const auto& [b, c_b] : weights) K(a, b) += stiffness * c_a.dot(c_b);  // every direction is that of z
    const Eigen::MatrixXd scaled = scale.asDiagonal() * K * scale.asDiagonal();
    largest = std::max(largest, Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues().maxCoeff());
  }
  EXPECT_LE(largest, 1);
  EXPECT_GT(largest, 0.3);  // and it is not far too careful
}

TEST(SurfaceContact, IsNotFeltAtRest) {
  SolidMesh below = make_box_mesh({{1, 1, 0.3}, {2, 2, 1}}), above = make_box_mesh({{1, 1, 0.3}, {3, 3, 1}});
  above.node_position.col(2).array() += 0.31;  // d0 is larger
  const SolidMesh mesh = join_bodies({below, above}, {"below", "above"});
  SurfaceContact contact(mesh, {pair_of_plates()});
  NodeVectors u = NodeVectors::Zero(mesh.n_nodes(), 4);
  EXPECT_EQ(contact.total(u.data()).n_touching, 0);
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    if (mesh.node_position(n, 2) > 0.305) u(n, 2) = -0.002;
  EXPECT_NEAR(contact.total(u.data()).force, k * 0.002, 1e-10);
}

TEST(SurfaceContact, IgnoresWhatIsDeeperThanTheLargestDepth) {
  const SolidMesh mesh = two_plates();
  SurfaceContact contact(mesh, {pair_of_plates()});
  EXPECT_GT(contact.total(moved(mesh, {0, 0, -0.29}, 0).data()).force, 0);  // 0.09 deep
  EXPECT_EQ(contact.total(moved(mesh, {0, 0, -0.31}, 0).data()).force, 0);  // 0.11
}

/// A strip of length 4 and thickness 0.1, bent into a hairpin whose legs are `distance` apart.
NodeVectors hairpin(const SolidMesh& mesh, double distance) {
  const double radius = distance / 2, arc = std::acos(-1) * radius, leg = (4 - arc) / 2;
  NodeVectors u = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n) {
    const double s = mesh.node_position(n, 0), depth = 0.1 - mesh.node_position(n, 2), r = radius + depth;
    double x = s, z = -r;  // the lower leg, its upper side z_max at -radius
    if (s > leg) {
      const double angle = std::min(1.0, (s - leg) / arc) * std::acos(-1);
      x = leg + r * std::sin(angle) - std::max(0.0, s - leg - arc);
      z = -r * std::cos(angle);
    }
    u(n, 0) = x - s;
    u(n, 2) = z - mesh.node_position(n, 2);
  }
  return u;
}

TEST(SurfaceContact, NoticesAWayThatIsTooLongToFollow) {
  const SolidMesh mesh = two_plates();  // 0.2 apart; pushes over d0 + largest depth = 0.15, an eighth is 0.01875
  SurfaceContact contact(mesh, {pair_of_plates()});
  const auto too_fast = [&](const Eigen::RowVector3d& from, const Eigen::RowVector3d& to) {
    return contact.deepens_too_fast(moved(mesh, from, 0).data(), moved(mesh, to, 0).data());
  };
  EXPECT_FALSE(too_fast({0, 0, 0}, {0, 0, -0.168}));      // 0.018 deep at its end
  EXPECT_TRUE(too_fast({0, 0, 0}, {0, 0, -0.17}));        // 0.02
  EXPECT_TRUE(too_fast({0, 0, 0}, {0, 0, -1.5}));         // right through the lower plate, free at both ends
  EXPECT_FALSE(too_fast({3, 0, 0}, {3, 0, -1.5}));        // beside it
  EXPECT_FALSE(too_fast({0, 0, -0.18}, {0, 0, 1}));       // away from it
  EXPECT_FALSE(too_fast({0, 0, -0.18}, {0, 0, -0.198}));  // from 0.03 deep to 0.048
  EXPECT_TRUE(too_fast({0, 0, -0.18}, {0, 0, -0.2}));
  EXPECT_FALSE(too_fast({0, 0, -0.29}, {0, 0, -0.299}));  // still held, at the end of what contact pushes
  EXPECT_TRUE(too_fast({0, 0, -0.299}, {0, 0, -0.31}));   // let go at the back
  EXPECT_FALSE(too_fast({0, 0, -0.19}, {0, 0, 1}));       // let go at the front
  NodeVectors together = moved(mesh, {0, 0, -0.18}, 0);
  together.col(2).array() += 1e3;  // both plates
  EXPECT_FALSE(contact.deepens_too_fast(moved(mesh, {0, 0, -0.18}, 0).data(), together.data()));
  EXPECT_TRUE(too_fast({0, 0, 0}, {0, 0, -1e6}));  // not even looked at
}

TEST(SurfaceContact, SelfContactFindsTheOtherLegAndNotTheNeighbours) {
  const SolidMesh mesh = make_box_mesh({{4, 0.2, 0.1}, {40, 2, 1}});
  SurfaceContact contact(mesh, {{"z_max", "", k, d0, 0.02}});
  EXPECT_EQ(contact.total(NodeVectors::Zero(mesh.n_nodes(), 4).eval().data()).n_touching, 0);
  NodeVectors shorter = NodeVectors::Zero(mesh.n_nodes(), 4);
  shorter.col(0) = -0.3 * mesh.node_position.col(0);  // neighbours come closer and still do not count
  EXPECT_EQ(contact.total(shorter.data()).n_touching, 0);
  EXPECT_EQ(contact.total(hairpin(mesh, 0.4).data()).n_touching, 0);  // legs apart

  // Now the legs, of an area of 2 (4 - arc)/2 x 0.2 in all, are 0.04 apart: g = 0.01, and each pair counts once.
  const NodeVectors closed = hairpin(mesh, 0.04);
  const auto total = contact.total(closed.data());
  const double leg_area = (4 - std::acos(-1) * 0.02) / 2 * 0.2;
  EXPECT_NEAR(total.force, k * 0.01 * leg_area, 0.1 * k * 0.01 * leg_area);  // one element of 40 is the bend
  const NodeVectors force = force_at(contact, closed);
  EXPECT_LT(force.colwise().sum().norm(), 1e-13 * force.cwiseAbs().sum());
}

TEST(PenaltyStiffness, IsThatOfTheSofterElementBehindTheSurfaces) {
  const SolidMesh mesh = two_plates();
  const NeoHookean stiff{2e4, 1e6}, soft{1e3, 5e4};
  const auto modulus = [](const NeoHookean& law) { return law.bulk_modulus_at_rest() + 4.0 / 3 * law.shear_modulus(); };
  ContactPair pair = pair_of_plates();
  pair.stiffness = pair.largest_depth = 0;
  pair = complete(pair, mesh, {{stiff, 1000}, {soft, 1000}}, 0);
  EXPECT_NEAR(pair.stiffness, modulus(soft) / 0.3, 1e-9 * pair.stiffness);  // one element through the thickness
  EXPECT_NEAR(pair.largest_depth, 0.15, 1e-12);
  const ContactPair given = complete(pair_of_plates(), mesh, {{stiff, 1000}, {soft, 1000}}, 0);
  EXPECT_EQ(given.stiffness, k);
  EXPECT_EQ(given.largest_depth, 0.1);
}

TEST(SurfaceContact, RefusesWhatCannotBe) {
  const SolidMesh mesh = two_plates();
  ContactPair wrong = pair_of_plates();
  wrong.first = "above/top";
  EXPECT_THROW(SurfaceContact(mesh, {wrong}), report::SceneError);
  for (double ContactPair::*field : {&ContactPair::stiffness, &ContactPair::distance, &ContactPair::largest_depth}) {
    wrong = pair_of_plates();
    wrong.*field = -1;
    EXPECT_THROW(SurfaceContact(mesh, {wrong}), report::SceneError);
  }
}

}  // namespace
}  // namespace couplet::solid
