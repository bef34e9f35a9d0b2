#include "flow-server/immersed/face_cut.hpp"

#include <algorithm>
#include <optional>

namespace couplet::flow {

/// A crossing of the rim in the order in which it is met, counterclockwise from the corner.
struct FaceCut::RimCrossing {
  const EdgeCrossing* crossing;
  Eigen::Vector2d place;   // in the face, both directions from 0 to 1
  bool leads_out;          // counterclockwise
  int edge, next_segment;  // of that edge, behind it counterclockwise
  int trace = -1;          // that ends here
};

namespace {

using Flat = Eigen::Vector2d;

double cross(const Flat& a, const Flat& b) {
  return a[0] * b[1] - a[1] * b[0];
}

constexpr std::size_t most_on_rim = 4 * (FaceCut::most_segments - 1);

/// A few things of a face, without memory from the heap.
template <class Thing>
struct OfFace {
  std::array<Thing, most_on_rim> things;
  std::size_t n = 0;

  void add(const Thing& thing) { things[n++] = thing; }
  std::size_t size() const { return n; }
  Thing& operator[](std::size_t i) { return things[i]; }
  const Thing& operator[](std::size_t i) const { return things[i]; }
  auto begin() { return things.begin(); }
  auto end() { return things.begin() + n; }
};

/// Pairs neighbouring crossings of opposite sense, from `start` around; crossings that are left over stay unpaired.
OfFace<std::array<int, 2>> paired(const OfFace<int>& around, std::size_t start, const auto& leads_out) {
  OfFace<std::array<int, 2>> pairs;
  OfFace<int> open;
  for (std::size_t i = 0; i < around.size(); ++i) {
    const int now = around[(start + i) % around.size()];
    if (open.n > 0 && leads_out(open[open.n - 1]) != leads_out(now)) {
      pairs.add({open[open.n - 1], now});
      --open.n;
    } else {
      open.add(now);
    }
  }
  return pairs;
}

/// Area and middle of a polygon that is given point by point.
struct Outline {
  Flat first, last, moment = Flat::Zero();
  double twice = 0;
  bool is_empty = true;

  void add(const Flat& point) {
    if (is_empty) {
      first = point, is_empty = false;
    } else {
      const double part = cross(last, point);
      twice += part;
      moment += part / 3 * (last + point);
    }
    last = point;
  }
};

/// Where two chords cross that do not end on each other: the share of the way from one end of the first to the other.
std::optional<double> crossing_share(const Flat& from, const Flat& to, const Flat& other_from, const Flat& other_to) {
  const Flat way = to - from, other = other_to - other_from, between = other_from - from;
  const double turn = cross(way, other);
  if (turn == 0) return std::nullopt;
  const double share = cross(between, other) / turn, other_share = cross(between, way) / turn;
  if (share <= 0 || share >= 1 || other_share <= 0 || other_share >= 1) return std::nullopt;
  return share;
}

/// In which turn the rim passes each edge of a face.
constexpr std::array<std::size_t, 4> turn_of_edge{0, 2, 3, 1};

}  // namespace

/// The trace of a surface from one crossing of the rim to another, through up to two bends in between.
struct FaceCut::Trace {
  static constexpr int most_points = 4;
  std::array<Flat, most_points> place;  // in the face, both directions from 0 to 1
  std::array<const SurfacePoint*, most_points> on{};
  int n_points = 0;

  const Flat& at(int p) const { return place[static_cast<std::size_t>(p)]; }
  void insert(int p, const SurfacePoint& point, const Flat& where) {
    for (int q = n_points++; q > p; --q) {
      place[static_cast<std::size_t>(q)] = at(q - 1);
      on[static_cast<std::size_t>(q)] = on[static_cast<std::size_t>(q - 1)];
    }
    place[static_cast<std::size_t>(p)] = where;
    on[static_cast<std::size_t>(p)] = &point;
  }
  /// By how much the trace becomes longer when it goes through `where` before the point p.
  double detour(const Flat& where, int p) const {
    return (where - at(p - 1)).norm() + (at(p) - where).norm() - (at(p) - at(p - 1)).norm();
  }
  int shortest_way_through(const Flat& where) const {
    int best = 1;
    for (int p = 2; p < n_points; ++p)
      if (detour(where, p) < detour(where, best)) best = p;
    return best;
  }
  /// The outer side lies to the left of the straight way back from the end to the start; not so between that and the
  /// trace, whose outline a ray along the first direction meets an odd number of times from there.
  bool has_on_outer_side(const Flat& where) const {
    bool is_outer = cross(at(0) - at(n_points - 1), where - at(n_points - 1)) > 0;
    for (int p = 0; p < n_points && n_points > 2; ++p) {
      const Flat &a = at(p), &b = at((p + 1) % n_points);
      if ((a[1] > where[1]) == (b[1] > where[1])) continue;
      if (where[0] < a[0] + (where[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) is_outer = !is_outer;
    }
    return is_outer;
  }
  /// Where another trace crosses it: the straight parts of both, counted from 0, and the share of the way along its
  /// own.
  struct Meeting {
    int part, other_part;
    double share;
  };
  std::optional<Meeting> meet(const Trace& other) const {
    for (int p = 0; p + 1 < n_points; ++p)
      for (int q = 0; q + 1 < other.n_points; ++q)
        if (const auto share = crossing_share(at(p), at(p + 1), other.at(q), other.at(q + 1)))
          return Meeting{p, q, *share};
    return std::nullopt;
  }
};

FaceCut::FaceCut(const EdgeCrossings& crossings, int d, const Triple& corner) {
  centroid_.fill(Flat(0.5, 0.5));
  const int e1 = (d + 1) % 3, e2 = (d + 2) % 3;
  Triple high1 = corner, high2 = corner;
  ++high1[e1], ++high2[e2];
  // Counterclockwise: along e1 at the start, along e2 at the end, back along e1, back along e2.
  struct Side {
    int edge, direction;
    Triple corner;
    bool is_backward;
    Flat start, step;
  };
  const std::array<Side, 4> sides{{{0, e1, corner, false, {0, 0}, {1, 0}},
                                   {3, e2, high1, false, {1, 0}, {0, 1}},
                                   {1, e1, high2, true, {0, 1}, {1, 0}},
                                   {2, e2, corner, true, {0, 0}, {0, 1}}}};
  OfFace<RimCrossing> rim;
  for (const Side& side : sides) {
    std::span<const EdgeCrossing> on = crossings.on_edge(side.direction, side.corner);
    if (on.size() >= most_segments) on = on.first(most_segments - 1 - (on.size() - (most_segments - 1)) % 2);
    const int n = static_cast<int>(on.size());
    n_segments_[static_cast<std::size_t>(side.edge)] = n + 1;
    for (int c = 0; c < n; ++c) {
      const int at = side.is_backward ? n - 1 - c : c;
      const EdgeCrossing& crossing = on[static_cast<std::size_t>(at)];
      rim.add({&crossing, side.start + crossing.share * side.step, crossing.leads_out != side.is_backward, side.edge,
               side.is_backward ? at : at + 1});
    }
  }
  if (rim.size() == 0) {
    share_[0] = 1;
    return;
  }

  // Traces, surface by surface. Where there is a choice the shorter ones are meant.
  const auto leads_out = [&](int c) { return rim[static_cast<std::size_t>(c)].leads_out; };
  std::array<Trace, most_traces> traces;
  int n_traces = 0;
  OfFace<int> surfaces;
  for (const RimCrossing& crossing : rim)
    if (std::find(surfaces.begin(), surfaces.end(), crossing.crossing->surface) == surfaces.end())
      surfaces.add(crossing.crossing->surface);
  for (const int surface : surfaces) {
    OfFace<int> around;
    for (std::size_t c = 0; c < rim.size(); ++c)
      if (rim[c].crossing->surface == surface) around.add(static_cast<int>(c));
    OfFace<std::array<int, 2>> best;
    double best_length = 0;
    for (std::size_t start = 0; start < std::min<std::size_t>(around.size(), 2); ++start) {
      OfFace<std::array<int, 2>> pairs = paired(around, start, leads_out);
      double length = 0;
      for (const auto& pair : pairs)
        length += (rim[static_cast<std::size_t>(pair[0])].place - rim[static_cast<std::size_t>(pair[1])].place).norm();
      if (pairs.size() > best.size() || (pairs.size() == best.size() && length < best_length))
        best = pairs, best_length = length;
    }
    has_lone_crossing_ = has_lone_crossing_ || 2 * best.size() < around.size();
    for (const auto& pair : best) {
      if (n_traces == most_traces) break;
      const int out = leads_out(pair[0]) ? pair[0] : pair[1], in = leads_out(pair[0]) ? pair[1] : pair[0];
      Trace& trace = traces[static_cast<std::size_t>(n_traces)];
      for (const int end : {out, in}) {
        RimCrossing& crossing = rim[static_cast<std::size_t>(end)];
        crossing.trace = n_traces;
        trace.insert(trace.n_points, *crossing.crossing, crossing.place);
      }
      ++n_traces;
    }
  }
  // Each bend belongs to the trace of its surface to which it is the least detour.
  for (const FaceBend& bend : crossings.bends_in_face(d, corner)) {
    Trace* nearest = nullptr;
    double least = 0;
    for (int t = 0; t < n_traces; ++t) {
      Trace& trace = traces[static_cast<std::size_t>(t)];
      if (trace.on[0]->surface != bend.point.surface || trace.n_points == Trace::most_points) continue;
      const double detour = trace.detour(bend.place, trace.shortest_way_through(bend.place));
      if (!nearest || detour < least) nearest = &trace, least = detour;
    }
    if (nearest) nearest->insert(nearest->shortest_way_through(bend.place), bend.point, bend.place);
  }

  // Arc a of the rim lies between its crossings a and a + 1: on the outer side of a trace from there to where it leads
  // in again. Arcs that no trace parts make a piece.
  const std::size_t n_arcs = rim.size();
  std::array<unsigned, most_on_rim> signature;
  std::fill_n(signature.begin(), n_arcs, 0u);
  for (int t = 0; t < n_traces; ++t)
    for (std::size_t out = 0; out < n_arcs; ++out) {
      if (rim[out].trace != t || !rim[out].leads_out) continue;
      for (std::size_t arc = out; !(rim[arc].trace == t && !rim[arc].leads_out); arc = (arc + 1) % n_arcs)
        signature[arc] |= 1u << t;
    }
  OfFace<unsigned> pieces;
  std::array<int, most_on_rim> piece_of_arc;
  for (std::size_t arc = 0; arc < n_arcs; ++arc) {
    const auto found = std::find(pieces.begin(), pieces.end(), signature[arc]);
    piece_of_arc[arc] = static_cast<int>(found - pieces.begin());
    if (found == pieces.end()) pieces.add(signature[arc]);
  }
  n_pieces_ = static_cast<int>(std::min<std::size_t>(pieces.size(), share_.size()));
  for (std::size_t arc = 0; arc < n_arcs; ++arc) piece_of_arc[arc] = std::min(piece_of_arc[arc], n_pieces_ - 1);

  // Segments of the edges: the one behind each crossing, and whole edges and first segments in between.
  const auto mark = [&](int edge, int segment, int piece) {
    piece_of_segment_[static_cast<std::size_t>(edge)][static_cast<std::size_t>(segment)] =
        static_cast<std::uint8_t>(piece);
  };
  const std::array<Flat, 4> corner_after{Flat(1, 0), Flat(1, 1), Flat(0, 1), Flat(0, 0)};
  // Areas by the polygon of a piece: its arcs, joined by traces; from one trace to another where they cross.
  struct PieceOutline : Outline {
    const RimCrossing *first_begin = nullptr, *last_end = nullptr;  // of its arcs
  };
  std::array<PieceOutline, most_traces + 1> outline;
  const auto add_way = [&](Outline& points, const RimCrossing& from, const RimCrossing& to) {
    if (from.trace < 0 || to.trace < 0) return;
    const Trace& own = traces[static_cast<std::size_t>(from.trace)];
    const Trace& next = traces[static_cast<std::size_t>(to.trace)];
    const int last = own.n_points - 2;  // bends are 1 to last
    if (from.trace == to.trace) {
      for (int p = 1; p <= last; ++p) points.add(own.at(from.leads_out ? p : last + 1 - p));
      return;
    }
    const auto meeting = own.meet(next);
    if (!meeting) return;
    const auto [part, next_part, share] = *meeting;
    if (from.leads_out)
      for (int p = 1; p <= part; ++p) points.add(own.at(p));
    else
      for (int p = last; p > part; --p) points.add(own.at(p));
    points.add(own.at(part) + share * (own.at(part + 1) - own.at(part)));
    if (to.leads_out)
      for (int p = next_part; p >= 1; --p) points.add(next.at(p));
    else
      for (int p = next_part + 1; p <= next.n_points - 2; ++p) points.add(next.at(p));
  };
  for (std::size_t arc = 0; arc < n_arcs; ++arc) {
    const RimCrossing& begin = rim[arc];
    const RimCrossing& end = rim[(arc + 1) % n_arcs];
    const int piece = piece_of_arc[arc];
    PieceOutline& points = outline[static_cast<std::size_t>(piece)];
    if (points.is_empty)
      points.first_begin = &begin;
    else
      add_way(points, *points.last_end, begin);
    points.last_end = &end;
    points.add(begin.place);
    mark(begin.edge, begin.next_segment, piece);
    std::size_t turn = turn_of_edge[static_cast<std::size_t>(begin.edge)];
    const std::size_t last_turn = turn_of_edge[static_cast<std::size_t>(end.edge)];
    // From a crossing back to itself, or to one before it on the same edge, the arc goes all around.
    bool goes_around = arc + 1 == n_arcs;
    while (turn != last_turn || goes_around) {
      goes_around = false;
      points.add(corner_after[turn]);
      turn = (turn + 1) % 4;
      const Side& side = sides[turn];
      const int n = n_segments(side.edge);
      mark(side.edge, side.is_backward ? n - 1 : 0, piece);
    }
    points.add(end.place);
  }
  double sum = 0;
  for (int piece = 0; piece < n_pieces_; ++piece) {
    PieceOutline& points = outline[static_cast<std::size_t>(piece)];
    if (!points.is_empty) {
      add_way(points, *points.last_end, *points.first_begin);
      points.add(points.first);
    }
    const double twice = points.twice;
    if (twice > 1e-12) centroid_[static_cast<std::size_t>(piece)] = points.moment / twice;
    share_[static_cast<std::size_t>(piece)] = std::max(0.0, 0.5 * twice);
    sum += share_[static_cast<std::size_t>(piece)];
  }
  for (int piece = 0; piece < n_pieces_ && sum > 0; ++piece) share_[static_cast<std::size_t>(piece)] /= sum;

  unsigned centre = 0;
  for (int t = 0; t < n_traces; ++t)
    if (traces[static_cast<std::size_t>(t)].has_on_outer_side({0.5, 0.5})) centre |= 1u << t;
  centre_piece_ = static_cast<int>(std::max_element(share_.begin(), share_.begin() + n_pieces_) - share_.begin());
  for (std::size_t piece = 0; piece < pieces.size() && static_cast<int>(piece) < n_pieces_; ++piece)
    if (pieces[piece] == centre) centre_piece_ = static_cast<int>(piece);

  const auto position_of = [&](const Flat& place) {
    Eigen::Vector3d position;
    position[d] = crossings.position(d, corner[d]);
    for (const int e : {e1, e2}) {
      const double start = crossings.position(e, corner[e]), width = crossings.position(e, corner[e] + 1) - start;
      position[e] = start + width * place[e == e1 ? 0 : 1];
    }
    return position;
  };
  const auto piece_beside = [&](unsigned on_outer_side, int otherwise) {
    const auto end = pieces.begin() + n_pieces_;
    const auto found = std::find(pieces.begin(), end, on_outer_side);
    return found == end ? otherwise : static_cast<int>(found - pieces.begin());
  };
  for (int t = 0; t < n_traces; ++t) {
    int outer_piece = 0, inner_piece = 0;  // as long as no other trace crosses it
    for (std::size_t arc = 0; arc < n_arcs; ++arc)
      if (rim[arc].trace == t) (rim[arc].leads_out ? outer_piece : inner_piece) = piece_of_arc[arc];
    const std::span<const Trace> others = std::span(traces).first(static_cast<std::size_t>(n_traces));
    add_chords(others, t, outer_piece, inner_piece, position_of, piece_beside);
  }
}

/// The straight parts of a trace. Where other traces cross it, it has other pieces beside it.
void FaceCut::add_chords(std::span<const Trace> traces, int t, int outer_piece, int inner_piece,
                         const auto& position_of, const auto& piece_beside) {
  const Trace& trace = traces[static_cast<std::size_t>(t)];
  bool is_crossed = false;
  for (std::size_t other = 0; other < traces.size(); ++other)
    is_crossed = is_crossed || (static_cast<int>(other) != t && trace.meet(traces[other]));
  for (int p = 0; p + 1 < trace.n_points; ++p) {
    const Flat &from = trace.at(p), &to = trace.at(p + 1);
    OfFace<double> share;  // at which it begins, is crossed and ends, in rising order
    share.add(0);
    for (std::size_t other = 0; other < traces.size() && is_crossed; ++other)
      for (int q = 0; q + 1 < traces[other].n_points && static_cast<int>(other) != t; ++q)
        if (const auto at = crossing_share(from, to, traces[other].at(q), traces[other].at(q + 1))) share.add(*at);
    share.add(1);
    std::sort(share.begin(), share.end());
    for (std::size_t n = 0; n + 1 < share.size() && n_chords_ < most_chords; ++n) {
      Chord& chord = chords_[static_cast<std::size_t>(n_chords_++)];
      chord.from = trace.on[static_cast<std::size_t>(p)], chord.to = trace.on[static_cast<std::size_t>(p + 1)];
      chord.from_share = share[n], chord.to_share = share[n + 1];
      chord.from_position = position_of(from + chord.from_share * (to - from));
      chord.to_position = position_of(from + chord.to_share * (to - from));
      chord.has_bend = {p > 0 && n == 0, p + 2 < trace.n_points && n + 2 == share.size()};
      chord.outer_piece = outer_piece, chord.inner_piece = inner_piece;
      if (!is_crossed) continue;
      const Flat middle = from + 0.5 * (chord.from_share + chord.to_share) * (to - from);
      unsigned outer = 1u << t;
      for (std::size_t other = 0; other < traces.size(); ++other)
        if (static_cast<int>(other) != t && traces[other].has_on_outer_side(middle)) outer |= 1u << other;
      chord.outer_piece = piece_beside(outer, outer_piece);
      chord.inner_piece = piece_beside(outer & ~(1u << t), inner_piece);
    }
  }
}

}  // namespace couplet::flow
