#include "solid-server/contact/surface_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "proto/report/failure.hpp"
#include "solid-server/contact/closest_point.hpp"
#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/element/element_packs.hpp"
#include "solid-server/element/shape_functions.hpp"
#include "solid-server/support/symmetric_eigenvalues.hpp"

namespace couplet::solid {

namespace {

constexpr Index width = NodeVectors::ColsAtCompileTime;

// The search lists faces a quarter of a face further than they count: few searches, short lists.
constexpr double skin_per_face_size = 0.25;

// Distances that differ by less than this share of the reach are those of one point on an edge between two faces.
constexpr double same_distance = 1e-10;

// The smallest ball that rounds valleys, of the size of the smallest face: large enough that the rounded surface is
// never stiffer across a valley than straight into it, since gaps are smaller, small enough not to fill what a mesh
// resolves.
constexpr double ball_per_face_size = 0.1;

// Of the largest bend between the faces of a valley: what is less is flat, and the shares there a matter of choice.
constexpr double flat_bend = 1e-6;

// A body that has grown more than this has come apart in too long substeps: its elements will say so, and all its
// points would be near all faces until then.
constexpr double most_growth = 100;

std::size_t at(Eigen::Index n) {
  return static_cast<std::size_t>(n);
}

Eigen::Vector3d vector(const NodeQuad& a) {
  return {a[0], a[1], a[2]};
}

/// The nodes of the surfaces, rising.
std::vector<Index> nodes_of_pairs(const SolidMesh& mesh, const std::vector<ContactPair>& pairs) {
  std::vector<ElementFace> faces;
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    const std::string where = "solid.contact[" + std::to_string(n) + "].";
    for (const auto& [name, field] : {std::pair(&pairs[n].first, "first"), std::pair(&pairs[n].other(), "second")}) {
      const auto& surface = mesh.find_surface(*name, where + field);
      if (surface.empty())
        throw report::SceneError(where + field, "the surface \"" + *name + "\" has no faces", "name another surface");
      faces.insert(faces.end(), surface.begin(), surface.end());
    }
  }
  return nodes_of_faces(mesh, faces);
}

void check(const ContactPair& pair, const std::string& where) {
  const auto refuse_unless = [&](bool is_good, const char* field, double value, const char* rule) {
    if (!is_good)
      throw report::SceneError(where + field, "the value " + report::text(value) + " is not possible", rule);
  };
  refuse_unless(pair.stiffness > 0 && std::isfinite(pair.stiffness), "stiffness", pair.stiffness,
                "choose a stiffness above 0 Pa/m");
  refuse_unless(pair.distance >= 0 && std::isfinite(pair.distance), "distance", pair.distance,
                "choose a distance of 0 m or more");
  refuse_unless(pair.largest_depth > 0 && std::isfinite(pair.largest_depth), "largest_depth", pair.largest_depth,
                "choose a depth above 0 m and below the thickness of the body");
}

/// A smooth step: 0 for x <= 0, 1 for x >= 1.
double smooth_step(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

void put_shape(const ContactFace& face, const FaceCoordinates& where, std::array<double, max_face_nodes>& shape) {
  const auto values = shape_values(face.shape, where);
  std::copy(values.begin(), values.end(), shape.begin());
}

double shape_sum(const std::array<double, max_face_nodes>& shape) {
  double sum = 0;
  for (const double N : shape) sum += std::abs(N);
  return sum;
}

}  // namespace

SurfaceContact::SurfaceContact(const SolidMesh& mesh, std::vector<ContactPair> pairs)
    : pairs_(std::move(pairs)), node_(nodes_of_pairs(mesh, pairs_)), contact_node_(at(mesh.n_nodes()), -1) {
  rest_.resize(node_.size());
  for (std::size_t n = 0; n < node_.size(); ++n) {
    contact_node_[at(node_[n])] = static_cast<Index>(n);
    const auto row = mesh.node_position.row(node_[n]);
    rest_[n] = NodeQuad{row[0], row[1], row[2], 0};
  }
  x_ = rest_;
  for (std::size_t n = 0; n < pairs_.size(); ++n) {
    const ContactPair& pair = pairs_[n];
    const std::string where = "solid.contact[" + std::to_string(n) + "].";
    check(pair, where);
    const std::size_t first = region_of(mesh, pair.first, where + "first");
    const std::size_t second = region_of(mesh, pair.other(), where + "second");
    add_side(first, second, pair);
    if (first != second) add_side(second, first, pair);
  }
  factor_.assign(node_.size(), 1);
  cancelled_area_.assign(node_.size(), 0);
  area_.assign(node_.size(), 0);
  holds_force_.assign(node_.size(), 0);
  for (const ContactRegion& region : region_)  // once each, however many pairs name it
    for (const ContactPoint& point : region.point)
      for (std::size_t a = 0; a < max_face_nodes; ++a)
        area_[at(region.face[at(point.face)].node[a])] += std::abs(point.shape[a]) * point.area;
}

std::size_t SurfaceContact::region_of(const SolidMesh& mesh, const std::string& surface, const std::string& where) {
  const auto known = std::find(region_name_.begin(), region_name_.end(), surface);
  if (known != region_name_.end()) return static_cast<std::size_t>(known - region_name_.begin());
  std::vector<FaceNodes> faces;
  for (const ElementFace& face : mesh.find_surface(surface, where)) faces.push_back(mesh.nodes_of(face));
  region_.push_back(make_contact_region(faces, contact_node_, rest_));
  region_name_.push_back(surface);
  box_.emplace_back(faces.size());
  find_boxes(region_.size() - 1);
  return region_.size() - 1;
}

void SurfaceContact::add_side(std::size_t points, std::size_t faces, const ContactPair& pair) {
  const ContactRegion &own = region_[points], &other = region_[faces];
  std::vector<double> face_area(other.face.size(), 0);
  for (const ContactPoint& point : other.point) face_area[at(point.face)] += point.area;
  const double area = std::accumulate(face_area.begin(), face_area.end(), 0.0);
  const double ball_radius =
      std::max(pair.distance, ball_per_face_size * std::sqrt(*std::min_element(face_area.begin(), face_area.end())));
  SearchReach reach;
  reach.reach = std::max(pair.distance, pair.largest_depth);
  reach.skin = skin_per_face_size * std::sqrt(area / static_cast<double>(other.face.size()));
  if (points == faces) reach.neighbour_distance = 2 * pair.distance;
  Side side{points,
            faces,
            pair.stiffness / 2,  // each surface is points and faces in turn
            pair.distance,
            pair.largest_depth,
            ball_radius,
            pair.cancels_interface_load,
            ContactSearch(other, rest_, reach),
            {},
            {}};
  side.threshold.assign(own.point.size(), pair.distance);
  side.search.update(own, other, rest_);
  const auto& active = side.search.active_point();
  Valley valley;
  Touch at_rest;
  for (std::size_t n = 0; n < active.size(); ++n) {
    find_touch(side, own.position(own.point[at(active[n])], rest_), side.search.faces_near(n), valley, at_rest);
    if (at_rest.foot.face >= 0) side.threshold[at(active[n])] = std::min(pair.distance, at_rest.distance);
  }
  sides_.push_back(std::move(side));
}

/// The closest of some faces; its gap is left open. face = -1: none within reach.
void SurfaceContact::find_touch(const Side& side, const NodeQuad& x, std::span<const Index> faces, Valley& valley,
                                Touch& touch) const {
  const ContactRegion& region = region_[side.faces];
  const double reach = side.search.reach().reach, tolerance = same_distance * reach;
  touch.foot.face = -1;
  touch.further_feet.clear();
  double closest = reach, alignment = 0;
  FaceCoordinates where{0, 0};
  const auto try_face = [&](Index f) {
    const ContactFace& face = region.face[at(f)];
    const CurvedFace curved = face.curved(x_);
    const ClosestPoint found = closest_point(curved, x, closest + tolerance);
    if (found.distance > closest + tolerance || found.distance > reach) return;

    const NodeQuad normal = curved.normal(found.at), r = x - found.position;
    const double height = dot(r, normal);
    // Of two faces with the same closest point on their edge, the one that looks more towards x knows the side.
    const bool is_tie = touch.foot.face >= 0 && found.distance > closest - tolerance;
    if (is_tie && std::abs(height) <= alignment) return;
    closest = found.distance;
    alignment = std::abs(height);
    touch.foot.face = f;
    where = found.at;
    if (found.edge < 0) {
      touch.distance = height;
      touch.direction = normal;
      return;
    }
    const bool is_open = found.corner >= 0 ? face.is_open_corner[at(found.corner)] : face.is_open_edge[at(found.edge)];
    const double sign = is_open || height >= 0 ? 1 : -1;
    touch.distance = sign * found.distance;
    touch.direction = found.distance > tolerance ? r * (sign / found.distance) : normal;
  };

  // The face with the nearest box first: then most others are seen to be further away without a look at them.
  const std::vector<Box>& box = box_[side.faces];
  Index nearest = -1;
  double to_nearest = reach * reach;
  for (const Index f : faces)
    if (const double to_this = squared_distance(x, box[at(f)]); to_this < to_nearest) {
      nearest = f;
      to_nearest = to_this;
    }
  if (nearest < 0) return;
  try_face(nearest);
  for (const Index f : faces) {
    const double furthest = closest + tolerance;
    if (f != nearest && squared_distance(x, box[at(f)]) <= furthest * furthest) try_face(f);
  }
  if (touch.foot.face < 0) return;
  touch.foot.push = touch.direction;
  put_shape(region.face[at(touch.foot.face)], where, touch.foot.shape);
  if (touch.distance < side.distance + side.ball_radius && touch.distance > -side.largest_depth)
    round_valley(side, x, faces, valley, touch);
}

void SurfaceContact::round_valley(const Side& side, const NodeQuad& x, std::span<const Index> faces, Valley& valley,
                                  Touch& touch) const {
  const ContactRegion& region = region_[side.faces];
  const ContactFace& closest = region.face[at(touch.foot.face)];
  const auto hangs_together = [&](const ContactFace& face) {
    const auto nodes = [](const ContactFace& f) {
      return std::span(f.node).first(static_cast<std::size_t>(n_corners_of(f.shape)));
    };
    return std::ranges::any_of(
        nodes(face), [&](Index node) { return std::ranges::find(nodes(closest), node) != nodes(closest).end(); });
  };
  // Most often no box of another face reaches into the ball, and hardly ever those of more than one or two.
  const std::vector<Box>& box = box_[side.faces];
  auto& [number, curved, rounded] = valley;
  number.assign(1, touch.foot.face);
  curved.assign(1, closest.curved(x_));
  const auto find_within = [&](const NodeQuad& middle, double radius) {
    const std::size_t n_before = number.size();
    for (const Index f : faces)
      if (squared_distance(middle, box[at(f)]) < radius * radius && std::ranges::find(number, f) == number.end() &&
          hangs_together(region.face[at(f)])) {
        number.push_back(f);
        curved.push_back(region.face[at(f)].curved(x_));
      }
    return number.size() > n_before;
  };
  const double view = view_distance(touch.distance, side.ball_radius), near = 1 - same_distance;
  if (!find_within(x + view * touch.direction, near * (touch.distance + view))) return;
  do {
    rounded = rounded_distance(curved, x, touch.distance, touch.direction, side.ball_radius, std::move(rounded.touch));
  } while (find_within(x + view * rounded.direction, near * rounded.to_faces));
  touch.distance = rounded.distance;
  touch.direction = rounded.direction;
  for (const BallTouch& part : rounded.touch) {
    Foot foot{number[part.face], {}, part.share * part.direction};
    put_shape(region.face[at(foot.face)], part.at, foot.shape);
    if (&part == &rounded.touch.front())
      touch.foot = foot;
    else
      touch.further_feet.push_back(foot);
  }
}

void SurfaceContact::find_boxes(std::size_t region) {
  for (std::size_t f = 0; f < box_[region].size(); ++f) box_[region][f] = region_[region].face[f].curved(x_).box();
}

ContactPositions SurfaceContact::positions_at(const double* displacement) const {
  ContactPositions x(node_.size());
  for (std::size_t n = 0; n < node_.size(); ++n) x[n] = rest_[n] + load_quad(displacement + width * node_[n]);
  return x;
}

bool SurfaceContact::has_blown_up() const {
  const auto extent = [](const ContactPositions& x) {
    NodeQuad low = x.front(), high = x.front();
    bool is_finite = true;
    for (const NodeQuad& node : x) {
      low = low < node ? low : node;
      high = high > node ? high : node;
      is_finite &= std::isfinite(node[0] + node[1] + node[2]);
    }
    return is_finite ? length(high - low) : std::numeric_limits<double>::infinity();
  };
  return !(extent(x_) < most_growth * extent(rest_));
}

void SurfaceContact::search(const double* displacement) {
  x_ = positions_at(displacement);
  search_here();
}

void SurfaceContact::search_here() {
  is_active_ = false;
  if (!is_empty() && has_blown_up()) {
    for (Side& side : sides_) side.touch.clear();
    return;
  }
  std::vector<char> is_near(region_.size(), 0);
  for (Side& side : sides_) {
    side.search.update(region_[side.points], region_[side.faces], x_);
    side.touch.resize(side.search.active_point().size());
    is_active_ |= !side.touch.empty();
    if (!side.touch.empty()) is_near[side.faces] = 1;
  }
  for (std::size_t r = 0; r < region_.size(); ++r)
    if (is_near[r]) find_boxes(r);
}

void SurfaceContact::find_gaps(int member, int n_members) {
  Valley valley;
  for (Side& side : sides_) {
    const ContactRegion& own = region_[side.points];
    const auto [first, last] = share_of(static_cast<int>(side.touch.size()), member, n_members);
    for (auto n = at(first); n < at(last); ++n) {
      const Index p = side.search.active_point()[n];
      Touch& touch = side.touch[n];
      find_touch(side, own.position(own.point[at(p)], x_), side.search.faces_near(n), valley, touch);
      const bool is_near = touch.foot.face >= 0 && touch.distance >= -side.largest_depth;
      touch.gap = is_near ? std::max(0.0, side.threshold[at(p)] - touch.distance) : 0;
    }
  }
}

/// Calls visit(side, point, touch) for all points that touch, in a fixed order.
template <class Visit>
void SurfaceContact::for_each_touch(const Visit& visit) const {
  for (const Side& side : sides_)
    for (std::size_t n = 0; n < side.touch.size(); ++n)
      if (side.touch[n].gap > 0)
        visit(side, region_[side.points].point[at(side.search.active_point()[n])], side.touch[n]);
}

/// Calls visit(contact node, weight, direction, whether it is on the point's own face): N_a, n, then - N_b, lambda n_f.
template <class Visit>
void SurfaceContact::scatter(const Side& side, const ContactPoint& point, const Touch& touch,
                             const Visit& visit) const {
  const ContactFace& own = region_[side.points].face[at(point.face)];
  for (std::size_t a = 0; a < at(n_nodes_of(own.shape)); ++a) visit(own.node[a], point.shape[a], touch.direction, true);
  const auto push = [&](const Foot& foot) {
    const ContactFace& other = region_[side.faces].face[at(foot.face)];
    for (std::size_t a = 0; a < at(n_nodes_of(other.shape)); ++a)
      visit(other.node[a], -foot.shape[a], foot.push, false);
  };
  push(touch.foot);
  for (const Foot& foot : touch.further_feet) push(foot);
}

void SurfaceContact::write(int member, int n_members, double* force) {
  const auto [first, last] = share_of(n_nodes(), member, n_members);
  if (first == last) return;
  if (!is_active_ && !holds_force_[at(first)]) return;
  holds_force_[at(first)] = is_active_;
  std::fill(force + width * first, force + width * last, 0.0);
  std::fill(cancelled_area_.begin() + first, cancelled_area_.begin() + last, 0.0);

  for_each_touch([&, first = first, last = last](const Side& side, const ContactPoint& point, const Touch& touch) {
    const double pressed = side.stiffness * point.area * touch.gap;
    const double cancelled = side.cancels_interface_load && side.distance > 0
                                 ? smooth_step(touch.gap / (cancelling_range * side.distance)) * point.area
                                 : 0;
    scatter(side, point, touch,
            [&, first = first, last = last](Index node, double weight, const NodeQuad& direction, bool is_own) {
              if (node < first || node >= last) return;
              const NodeQuad sum = load_quad(force + width * node) + (weight * pressed) * direction;
              std::memcpy(force + width * node, &sum, sizeof sum);
              if (is_own) cancelled_area_[at(node)] += cancelled * std::abs(weight);
            });
  });
  for (auto n = at(first); n < at(last); ++n)
    factor_[n] = area_[n] > 0 ? 1 - std::min(1.0, cancelled_area_[n] / area_[n]) : 1;
}

void SurfaceContact::find_all(const double* displacement) {
  search(displacement);
  find_gaps(0, 1);
}

bool SurfaceContact::is_touching() const {
  const auto touches = [](const Touch& touch) { return touch.gap > 0; };
  return std::any_of(sides_.begin(), sides_.end(),
                     [&](const Side& side) { return std::any_of(side.touch.begin(), side.touch.end(), touches); });
}

SurfaceContact::Total SurfaceContact::total(const double* displacement) {
  find_all(displacement);
  Total total;
  for (const Side& side : sides_) total.smallest_distance = std::max(total.smallest_distance, side.distance);
  for_each_touch([&](const Side& side, const ContactPoint& point, const Touch& touch) {
    const double stiffness = side.stiffness * point.area;
    total.energy += stiffness / 2 * touch.gap * touch.gap;
    total.force += stiffness * touch.gap;
    total.smallest_distance = std::min(total.smallest_distance, touch.distance);
    ++total.n_touching;
  });
  return total;
}

double SurfaceContact::add(const double* displacement, double* force) {
  const double energy = total(displacement).energy;
  for_each_touch([&](const Side& side, const ContactPoint& point, const Touch& touch) {
    const double pressed = side.stiffness * point.area * touch.gap;
    scatter(side, point, touch, [&](Index node, double weight, const NodeQuad& direction, bool) {
      for (int i = 0; i < 3; ++i) force[width * node_[at(node)] + i] += weight * pressed * direction[i];
    });
  });
  return energy;
}

/// Across a valley D'' = - sum of v v^T / (rho sigma) over the eigenpairs (sigma, v) of P G P, with G_fg = n_f.n_g of
/// the touched faces and P = I - 1 1^T / m what leaves the sum of the shares 1: how the shares of the minimum in
/// rounded_distance follow the heights. Its term is k A g / (rho sigma) c c^T with c = sum of v_f dh_f/du.
void SurfaceContact::add_valley(const Side& side, const ContactPoint& point, const Touch& touch,
                                std::vector<StiffnessTerm>& terms) const {
  std::vector<const Foot*> feet{&touch.foot};
  for (const Foot& foot : touch.further_feet) feet.push_back(&foot);
  const auto m = static_cast<Eigen::Index>(feet.size());
  Eigen::Matrix3Xd normal(3, m);
  for (Eigen::Index f = 0; f < m; ++f) normal.col(f) = vector(feet[at(f)]->push).normalized();
  const Eigen::Matrix3Xd turned = normal.colwise() - normal.rowwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> bend(turned.transpose() * turned);
  for (Eigen::Index k = 0; k < m; ++k) {
    const double sigma = bend.eigenvalues()[k];
    if (!(sigma > flat_bend * bend.eigenvalues()[m - 1])) continue;
    const Eigen::VectorXd v = bend.eigenvectors().col(k);
    StiffnessTerm term{{}, side.stiffness * point.area * touch.gap / (side.ball_radius * sigma)};
    const ContactFace& own = region_[side.points].face[at(point.face)];
    const Eigen::Vector3d sum = normal * v;
    for (std::size_t a = 0; a < at(n_nodes_of(own.shape)); ++a)
      term.weight.push_back({node_[at(own.node[a])], point.shape[a] * sum});
    for (Eigen::Index f = 0; f < m; ++f) {
      const Foot& foot = *feet[at(f)];
      const ContactFace& face = region_[side.faces].face[at(foot.face)];
      for (std::size_t b = 0; b < at(n_nodes_of(face.shape)); ++b)
        term.weight.push_back({node_[at(face.node[b])], -foot.shape[b] * v[f] * normal.col(f)});
    }
    terms.push_back(std::move(term));
  }
}

std::vector<SurfaceContact::StiffnessTerm> SurfaceContact::stiffness(const double* displacement) {
  find_all(displacement);
  std::vector<StiffnessTerm> terms;
  for_each_touch([&](const Side& side, const ContactPoint& point, const Touch& touch) {
    StiffnessTerm term{{}, side.stiffness * point.area};
    scatter(side, point, touch, [&](Index node, double weight, const NodeQuad& direction, bool) {
      term.weight.push_back({node_[at(node)], weight * vector(direction)});
    });
    terms.push_back(std::move(term));
    if (!touch.further_feet.empty()) add_valley(side, point, touch, terms);
  });
  return terms;
}

/// With u the motion of points and w that of faces, (N.u - N.w)^2 <= 2 (N.u)^2 + 2 (N.w)^2: each surface counts alone,
/// twice, with sum over b of |d f_a / d x_b| = k A |N_a| sum |N_b|. On the faces the points of the other surface may
/// lie anywhere: as dense as the faces' own points, but no face has less than the area of one of them.
Eigen::VectorXd SurfaceContact::stiffness_bound(Index n_nodes_of_mesh) const {
  Eigen::VectorXd bound = Eigen::VectorXd::Zero(n_nodes_of_mesh);
  for (const Side& side : sides_) {
    const auto add = [&](const ContactRegion& region, const ContactPoint& point, double area) {
      const double factor = 2 * side.stiffness * area * shape_sum(point.shape);
      const ContactFace& face = region.face[at(point.face)];
      for (std::size_t a = 0; a < max_face_nodes; ++a)
        bound[node_[at(face.node[a])]] += factor * std::abs(point.shape[a]);
    };
    double largest_area = 0;
    for (const ContactPoint& point : region_[side.points].point) {
      add(region_[side.points], point, point.area);
      largest_area = std::max(largest_area, point.area);
    }
    const ContactRegion& faces = region_[side.faces];
    std::vector<double> face_area(faces.face.size(), 0);
    for (const ContactPoint& point : faces.point) face_area[at(point.face)] += point.area;
    for (const ContactPoint& point : faces.point) {
      const double own = face_area[at(point.face)];
      add(faces, point, point.area * std::max(1.0, largest_area / own));
    }
  }
  return bound;
}

long SurfaceContact::n_searches() const {
  long n = 0;
  for (const Side& side : sides_) n += side.search.n_searches();
  return n;
}

std::size_t SurfaceContact::memory_bytes() const {
  std::size_t bytes = (rest_.size() + x_.size()) * sizeof(NodeQuad);
  for (const Side& side : sides_) bytes += side.touch.capacity() * sizeof(Touch) + 2 * rest_.size() * sizeof(NodeQuad);
  for (const ContactRegion& region : region_)
    bytes += region.face.size() * sizeof(ContactFace) + region.point.size() * sizeof(ContactPoint);
  return bytes;
}

}  // namespace couplet::solid
