#include "flow-server/immersed/wall_layer.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "tests/unit/flow-server/immersed/placed_bodies.hpp"
#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

constexpr int n = 12;
constexpr double h = 1.0 / n;
const Eigen::Vector3d normal = Eigen::Vector3d(1, 0.4, 0.3).normalized();
constexpr double offset = 0.713;  // of the plane normal . x = offset

/// A sheet right across the box, with its outer side where normal . x is larger.
BodySurface plane(const Point& velocity, double at = offset) {
  const Eigen::Vector3d a = normal.cross(Eigen::Vector3d::UnitX()).normalized(), b = normal.cross(a);
  const Eigen::Vector3d corner = at * normal - 4 * a - 4 * b;
  BodySurface sheet =
      flat_sheet({corner[0], corner[1], corner[2]}, {8 * a[0], 8 * a[1], 8 * a[2]}, {8 * b[0], 8 * b[1], 8 * b[2]}, 5);
  std::fill(sheet.velocity.begin(), sheet.velocity.end(), velocity);
  return sheet;
}

double height(const Point& p) {
  return normal.dot(Eigen::Vector3d(p[0], p[1], p[2])) - offset;
}

double sum_of(const WallImage& image) {
  return std::accumulate(image.weight.begin(), image.weight.end(), 0.0);
}

double sum_of(const WallValue& value) {
  return sum_of(value.image[0]);
}

/// All faces around the images that count are seen.
bool is_whole(const WallValue& value) {
  return std::all_of(value.image.begin(), value.image.end(),
                     [](const WallImage& image) { return image.ratio == 0 || sum_of(image) > 1 - 1e-14; });
}

class BesideAPlane : public testing::TestWithParam<Point> {};  // the velocity of the wall

TEST_P(BesideAPlane, ValuesOfALinearVelocityAreExact) {
  const Point wall = GetParam();
  PlacedBodies placed(uniform_box({n, n, n}, h), {plane(wall)});
  const auto linear = [&](const Point& p, int c) { return wall[static_cast<std::size_t>(c)] + (c + 1.5) * height(p); };
  placed.set_velocity(linear);
  const WallLayer& layer = placed.bodies->layer();
  ASSERT_FALSE(layer.forced().empty());
  ASSERT_FALSE(layer.ghosts().empty());
  EXPECT_TRUE(layer.solid().empty());
  int n_inner = 0;
  for (const ForcedFace& forced : layer.forced()) {
    const WallValue& value = forced.value;
    const Point at = centre_of_face(placed.block, value.component, value.face);
    const double away = height(at);
    if (is_whole(value)) {  // trilinear weights reproduce linear velocities: round-off of nine terms
      EXPECT_NEAR(WallLayer::value_of(value, placed.velocity[value.component]), linear(at, value.component), 1e-13);
    }
    EXPECT_EQ(forced.is_outer, away > 0);
    EXPECT_EQ(forced.closed, 1);
    EXPECT_LE(sum_of(value), 1 + 1e-14);
    bool is_inner = true;  // the image does not lie beyond the known faces
    for (std::size_t d = 0; d < 3; ++d) is_inner = is_inner && at[d] > 2.6 * h && at[d] < 1 - 2.6 * h;
    if (!is_inner) continue;
    ++n_inner;
    EXPECT_NEAR(sum_of(value), 1, 1e-14);
    EXPECT_EQ(forced.value.room, 1);
    // Falls linearly over one cell, measured along the normal; cells are cubes.
    EXPECT_NEAR(forced.share, 1 - std::abs(away) / h, 1e-12);
  }
  EXPECT_GT(n_inner, 50);
  std::size_t n_whole_ghosts = 0;
  for (const WallValue& ghost : layer.ghosts()) {
    const Point at = centre_of_face(placed.block, ghost.component, ghost.face);
    if (!is_whole(ghost)) continue;
    ++n_whole_ghosts;
    // A ghost goes on with the velocity of the side from which it is seen, through the wall's at the wall.
    EXPECT_NEAR(WallLayer::value_of(ghost, placed.velocity[ghost.component]), linear(at, ghost.component), 1e-13);
    if (std::abs(height(at)) > 1e-3 * h) {
      const double s = -std::abs(height(at)) / (1.5 * h);  // a parabola through the wall and two images
      if (ghost.image[1].ratio != 0) {
        EXPECT_NEAR(ghost.image[0].ratio + 5.0 / 3 * ghost.image[1].ratio, s, 1e-12);
      }
    }
  }
  EXPECT_GT(n_whole_ghosts, layer.ghosts().size() / 2);  // beside the border of the box some see too little
}

TEST_P(BesideAPlane, MeanVelocitiesOfPiecesAreExactForALinearVelocity) {
  const Point wall = GetParam();
  PlacedBodies placed(uniform_box({n, n, n}, h), {plane(wall)});
  const auto linear = [&](const Point& p, int c) { return wall[static_cast<std::size_t>(c)] + (c + 1.5) * height(p); };
  placed.set_velocity(linear);
  const WallLayer& layer = placed.bodies->layer();
  const CutCells& cut = placed.bodies->cut();
  std::vector<double> shift(cut.pieces().size(), 0.0);
  for (const PieceShift& given : layer.shifts()) {
    const Field<double>& u = placed.velocity[given.component];
    const double own = given.ghost >= 0 ? WallLayer::value_of(layer.ghosts()[static_cast<std::size_t>(given.ghost)], u)
                                        : u(given.face[0], given.face[1], given.face[2]);
    for (std::size_t m = 0; m < static_cast<std::size_t>(given.n_neighbours); ++m) {
      const auto& [i, j, k] = given.neighbour[m];
      shift[static_cast<std::size_t>(given.piece)] += given.weight[m] * (u(i, j, k) - own);
    }
  }
  int n_pieces = 0, n_behind = 0;
  for (const CutFace& face : cut.faces()) {
    const int d = face.direction;
    const Point middle = centre_of_face(placed.block, d, face.face);
    bool is_inner = true;  // ghosts see all faces around their images
    for (const double x : middle) is_inner = is_inner && x > 3.1 * h && x < 1 - 3.1 * h;
    for (int p = face.first_piece; p < face.first_piece + face.n_pieces && is_inner; ++p) {
      const FacePiece& piece = cut.pieces()[static_cast<std::size_t>(p)];
      const int ghost = layer.ghost_of_piece(p);
      double mean = placed.velocity[d](face.face[0], face.face[1], face.face[2]);
      if (ghost >= 0)
        mean = WallLayer::value_of(layer.ghosts()[static_cast<std::size_t>(ghost)], placed.velocity[d]), ++n_behind;
      Point at = middle;
      for (std::size_t t = 0; t < 2; ++t) at[(static_cast<std::size_t>(d) + 1 + t) % 3] += piece.offset[t];
      EXPECT_NEAR(mean + shift[static_cast<std::size_t>(p)], linear(at, d), 1e-12) << d << " " << piece.share;
      ++n_pieces;
    }
  }
  EXPECT_GT(n_pieces, 200);
  EXPECT_GT(n_behind, 50);
}

TEST_P(BesideAPlane, ValuesOfAParabolaAreExactButForTheInterpolation) {
  const Point wall = GetParam();
  PlacedBodies placed(uniform_box({n, n, n}, h), {plane(wall)});
  const auto parabola = [&](const Point& p, int c) {
    return wall[static_cast<std::size_t>(c)] + (c + 1.5) * height(p) * height(p);
  };
  placed.set_velocity(parabola);
  std::vector<WallValue> values = placed.bodies->layer().ghosts();
  for (const ForcedFace& forced : placed.bodies->layer().forced()) values.push_back(forced.value);
  std::size_t n_parabolas = 0;
  for (const WallValue& value : values) {
    if (!is_whole(value) || value.image[1].ratio == 0 || sum_of(value.image[1]) < 1 - 1e-14) continue;
    ++n_parabolas;
    // Trilinear interpolation is off by at most h^2 / 8 times the sum of the second derivatives, 2 (c + 1.5).
    const double largest =
        h * h / 8 * 2 * (value.component + 1.5) * (std::abs(value.image[0].ratio) + std::abs(value.image[1].ratio));
    const Point at = centre_of_face(placed.block, value.component, value.face);
    const double side = WallLayer::value_of(value, placed.velocity[value.component]) - parabola(at, value.component);
    EXPECT_LE(std::abs(side), largest + 1e-13);
  }
  EXPECT_GT(n_parabolas, values.size() / 3);
}

INSTANTIATE_TEST_SUITE_P(Walls, BesideAPlane, testing::Values(Point{0, 0, 0}, Point{0.7, -0.3, 1.1}));

TEST(WallLayer, AGapOfOneCellGivesNoImageAcross) {
  // Two parallel sheets, a cell apart; beyond them the velocity is far from any that there is in the gap.
  PlacedBodies placed(uniform_box({n, n, n}, h), {plane({0, 0, 0}), plane({0, 0, 0}, offset + h)});
  placed.set_velocity([](const Point& p, int) { return height(p) < 0 || height(p) > h ? 1e6 : 1; });
  int n_in_gap = 0;
  for (const ForcedFace& forced : placed.bodies->layer().forced()) {
    const WallValue& value = forced.value;
    const Point at = centre_of_face(placed.block, value.component, value.face);
    const double away = height(at);
    if (away < 1e-6 || away > h - 1e-6) continue;
    bool is_inner = true;  // away from the border of the box
    for (std::size_t d = 0; d < 3; ++d) is_inner = is_inner && at[d] > 2.6 * h && at[d] < 1 - 2.6 * h;
    if (!is_inner) continue;
    ++n_in_gap;
    EXPECT_LE(std::abs(WallLayer::value_of(value, placed.velocity[value.component])), 1 + 1e-12);
    EXPECT_LT(forced.value.room, 1);
    EXPECT_LE(forced.share, 1 - std::min(away, h - away) / h + 1e-12);
  }
  EXPECT_GT(n_in_gap, 50);
}

TEST(WallLayer, FacesInsideABodyHaveItsVelocity) {
  BodySurface ball = sphere_surface({0.511, 0.493, 0.504}, 0.3, 4);
  for (std::size_t c = 0; c < ball.position.size(); ++c)
    ball.velocity[c] = {-ball.position[c][1], ball.position[c][0], 0.5};  // it turns, and moves along its axis
  const PlacedBodies placed(uniform_box({n, n, n}, h), {ball});
  const WallLayer& layer = placed.bodies->layer();
  ASSERT_GT(layer.solid().size(), 100u);
  for (const WallValue& solid : layer.solid()) {
    EXPECT_TRUE(placed.bodies->cut().is_face_solid(solid.component, solid.face));
    EXPECT_LT(layer.find_forced(solid.component, solid.face), 0);
    if (solid.component == 2) {
      EXPECT_NEAR(solid.wall_velocity, 0.5, 1e-14);
    }
  }
  for (const ForcedFace& forced : layer.forced()) {
    EXPECT_FALSE(layer.is_inside_body(forced.value.component, forced.value.face));
    EXPECT_TRUE(forced.is_outer);
  }
}

TEST(WallLayer, AFaceJustInsideABodyLooksOutOfIt) {
  // A ball rises above a plane of faces around the middle of one face, between the edges that tell what is cut.
  const Triple top{7, 5, 5};
  const double radius = 3 * h, radius_of_cap = 0.25 * h;
  const double above = radius - std::sqrt(radius * radius - radius_of_cap * radius_of_cap);
  const PlacedBodies flat(uniform_box({n, n, n}, h), {plane({0, 0, 0})});
  Point centre = centre_of_face(flat.block, 0, top);
  centre[0] += above - radius;
  const PlacedBodies placed(uniform_box({n, n, n}, h), {sphere_surface(centre, radius, 5)});
  const WallLayer& layer = placed.bodies->layer();
  const int index = layer.find_forced(0, top);
  ASSERT_GE(index, 0);  // a face of the fluid, for all that is known of its edges
  const ForcedFace& forced = layer.forced()[static_cast<std::size_t>(index)];
  EXPECT_TRUE(forced.is_outer);
  EXPECT_EQ(forced.share, 1);
  EXPECT_EQ(forced.value.room, 1);
  EXPECT_TRUE(is_whole(forced.value));
  for (const WallImage& image : forced.value.image) {
    EXPECT_GE(image.base[0], top[0]);
  }
  EXPECT_LT(forced.value.image[0].ratio, 0);
}

TEST(WallLayer, FacesInThePlaneOfASideBeyondItsEdgeLookAwayFromTheBody) {
  // A prism of four sides whose edges lie in the planes of faces: what stands straight before one side beside an edge
  // lies in the plane of the other one, on either side of it by round-off.
  for (const Point& centre : {Point{0.5, 0.5, 0.5}, Point{0.5, 0.5 + h / 2, 0.5}, Point{0.5 + h / 2, 0.5, 0.5}}) {
    BodySurface prism = cylinder_surface(centre, 3 * h, 4, 2);
    prism.blend_width = 1;
    const PlacedBodies placed(uniform_box({n, n, n}, h), {prism});
    int n_before_edges = 0;
    for (const ForcedFace& forced : placed.bodies->layer().forced()) {
      const Point at = centre_of_face(placed.block, forced.value.component, forced.value.face);
      const double x = std::abs(at[0] - centre[0]), y = std::abs(at[1] - centre[1]);
      if (at[2] < 3 * h || at[2] > 1 - 3 * h) continue;
      const double above = (x + y - 3 * h) / std::sqrt(2);  // before the nearest side
      if (std::abs(std::abs(x - y) - 3 * h) > 1e-9 || above < 1e-9) continue;
      ++n_before_edges;
      EXPECT_NEAR(forced.share, 1 - above / h, 1e-9);  // cells are cubes; round-off
      EXPECT_GE(forced.value.image[0].ratio, 0);
    }
    EXPECT_GT(n_before_edges, 0);
  }
}

/// What is written in place of an older position, to the last bit.
void expect_same(const WallLayer& layer, const WallLayer& other) {
  const auto expect_same_values = [](const WallValue& a, const WallValue& b) {
    EXPECT_EQ(a.component, b.component);
    EXPECT_EQ(a.face, b.face);
    EXPECT_EQ(a.wall_velocity, b.wall_velocity);
    for (std::size_t n_image = 0; n_image < a.image.size(); ++n_image) {
      EXPECT_EQ(a.image[n_image].ratio, b.image[n_image].ratio);
      EXPECT_EQ(a.image[n_image].base, b.image[n_image].base);
      EXPECT_EQ(a.image[n_image].weight, b.image[n_image].weight);
    }
  };
  ASSERT_EQ(layer.forced().size(), other.forced().size());
  for (std::size_t f = 0; f < layer.forced().size(); ++f) {
    expect_same_values(layer.forced()[f].value, other.forced()[f].value);
    EXPECT_EQ(layer.forced()[f].share, other.forced()[f].share);
    EXPECT_EQ(layer.forced()[f].surface, other.forced()[f].surface);
  }
  ASSERT_EQ(layer.ghosts().size(), other.ghosts().size());
  for (std::size_t g = 0; g < layer.ghosts().size(); ++g) expect_same_values(layer.ghosts()[g], other.ghosts()[g]);
  ASSERT_EQ(layer.solid().size(), other.solid().size());
  for (std::size_t w = 0; w < layer.solid().size(); ++w) expect_same_values(layer.solid()[w], other.solid()[w]);
  ASSERT_EQ(layer.rows().size(), other.rows().size());
  for (std::size_t r = 0; r < layer.rows().size(); ++r) {
    EXPECT_EQ(layer.rows()[r].face, other.rows()[r].face);
    for (std::size_t e = 0; e < CutRow::n_entries; ++e) {
      EXPECT_EQ(layer.rows()[r].seen[e].ghost, other.rows()[r].seen[e].ghost);
      EXPECT_EQ(layer.rows()[r].seen[e].blocked, other.rows()[r].seen[e].blocked);
    }
  }
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(layer.near_faces(c), other.near_faces(c));
    EXPECT_EQ(layer.image_faces(c), other.image_faces(c));
  }
}

TEST(WallLayer, APositionIsTheSameWhateverWasThereBefore) {
  const auto surfaces_at = [](double shift) {
    std::vector<BodySurface> surfaces{sphere_surface({0.51, 0.49, 0.5}, 0.27, 4), plane({0.2, 0, 0.1}, offset + shift)};
    surfaces[0].velocity.assign(surfaces[0].velocity.size(), Point{shift, 0, 0});
    return surfaces;
  };
  PlacedBodies moved(uniform_box({n, n, n}, h), surfaces_at(0));
  for (const double shift : {0.3 * h, 1.7 * h, -0.6 * h}) moved.bodies->place(surfaces_at(shift));
  const PlacedBodies anew(uniform_box({n, n, n}, h), surfaces_at(-0.6 * h));
  expect_same(moved.bodies->layer(), anew.bodies->layer());
}

TEST(WallLayer, ImagesComeFromFacesThatItKnows) {
  const PlacedBodies placed(uniform_box({n, n, n}, h), {plane({0, 0, 0})});
  const WallLayer& layer = placed.bodies->layer();
  std::array<std::vector<Triple>, 3> faces;
  for (int c = 0; c < 3; ++c) {
    faces[c] = layer.image_faces(c);
    std::sort(faces[c].begin(), faces[c].end());
    EXPECT_EQ(std::adjacent_find(faces[c].begin(), faces[c].end()), faces[c].end());
  }
  const auto expect_known = [&](const WallValue& value) {
    for (std::size_t corner = 0; corner < 8; ++corner) {
      if (value.image[0].weight[corner] == 0) continue;
      Triple face = value.image[0].base;
      for (std::size_t d = 0; d < 3; ++d) face[d] += static_cast<int>(corner >> d & 1u);
      const std::vector<Triple>& beyond = faces[static_cast<std::size_t>(value.component)];
      EXPECT_NE(layer.is_near(value.component, face), std::binary_search(beyond.begin(), beyond.end(), face));
    }
  };
  for (const ForcedFace& forced : layer.forced()) expect_known(forced.value);
  for (const WallValue& ghost : layer.ghosts()) expect_known(ghost);
}

}  // namespace
}  // namespace couplet::flow
