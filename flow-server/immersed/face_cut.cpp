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
  int chord = -1;          // that ends here
};

/// Ends of a chord in the face, both directions from 0 to 1.
struct FaceCut::FlatChord {
  Eigen::Vector2d from, to;
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

/// The outer side of a chord lies to the left of the way back from its end to its start.
bool is_on_outer_side(const Flat& from, const Flat& to, const Flat& point) {
  return cross(from - to, point - to) > 0;
}

/// In which turn the rim passes each edge of a face.
constexpr std::array<std::size_t, 4> turn_of_edge{0, 2, 3, 1};

}  // namespace

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

  // Chords, surface by surface. Where there is a choice the shorter ones are meant.
  const auto leads_out = [&](int c) { return rim[static_cast<std::size_t>(c)].leads_out; };
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
      if (n_chords_ == most_chords) break;
      const int out = leads_out(pair[0]) ? pair[0] : pair[1], in = leads_out(pair[0]) ? pair[1] : pair[0];
      Chord& chord = chords_[static_cast<std::size_t>(n_chords_)];
      chord.from = rim[static_cast<std::size_t>(out)].crossing;
      chord.to = rim[static_cast<std::size_t>(in)].crossing;
      for (const bool is_from : {true, false}) {
        RimCrossing& end = rim[static_cast<std::size_t>(is_from ? out : in)];
        end.chord = n_chords_;
        Eigen::Vector3d& position = is_from ? chord.from_position : chord.to_position;
        position[d] = crossings.position(d, corner[d]);
        for (const int e : {e1, e2}) {
          const double start = crossings.position(e, corner[e]), width = crossings.position(e, corner[e] + 1) - start;
          position[e] = start + width * end.place[e == e1 ? 0 : 1];
        }
      }
      ++n_chords_;
    }
  }

  // Arc a of the rim lies between its crossings a and a + 1: on the outer side of a chord from there to where it leads
  // in again. Arcs that no chord parts make a piece.
  const std::size_t n_arcs = rim.size();
  std::array<unsigned, most_on_rim> signature;
  std::fill_n(signature.begin(), n_arcs, 0u);
  for (int c = 0; c < n_chords_; ++c)
    for (std::size_t out = 0; out < n_arcs; ++out) {
      if (rim[out].chord != c || !rim[out].leads_out) continue;
      for (std::size_t arc = out; !(rim[arc].chord == c && !rim[arc].leads_out); arc = (arc + 1) % n_arcs)
        signature[arc] |= 1u << c;
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
  std::array<FlatChord, most_chords> flat;
  for (std::size_t arc = 0; arc < n_arcs; ++arc) {
    if (rim[arc].chord < 0) continue;
    FlatChord& chord = flat[static_cast<std::size_t>(rim[arc].chord)];
    (rim[arc].leads_out ? chord.from : chord.to) = rim[arc].place;
  }
  // Areas by the polygon of a piece: its arcs, joined by straight lines; from one chord to another where they cross.
  std::array<Outline, most_chords + 1> outline;
  std::array<int, most_chords + 1> first_chord, last_chord;
  const auto add_turn = [&](Outline& points, int chord, int next_chord) {
    if (chord < 0 || next_chord < 0 || chord == next_chord) return;
    const FlatChord &a = flat[static_cast<std::size_t>(chord)], &b = flat[static_cast<std::size_t>(next_chord)];
    if (const std::optional<double> share = crossing_share(a.from, a.to, b.from, b.to))
      points.add(a.from + *share * (a.to - a.from));
  };
  for (std::size_t arc = 0; arc < n_arcs; ++arc) {
    const RimCrossing& begin = rim[arc];
    const RimCrossing& end = rim[(arc + 1) % n_arcs];
    const int piece = piece_of_arc[arc];
    Outline& points = outline[static_cast<std::size_t>(piece)];
    if (points.is_empty)
      first_chord[static_cast<std::size_t>(piece)] = begin.chord;
    else
      add_turn(points, last_chord[static_cast<std::size_t>(piece)], begin.chord);
    last_chord[static_cast<std::size_t>(piece)] = end.chord;
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
    Outline& points = outline[static_cast<std::size_t>(piece)];
    if (!points.is_empty) {
      add_turn(points, last_chord[static_cast<std::size_t>(piece)], first_chord[static_cast<std::size_t>(piece)]);
      points.add(points.first);
    }
    const double twice = points.twice;
    if (twice > 1e-12) centroid_[static_cast<std::size_t>(piece)] = points.moment / twice;
    share_[static_cast<std::size_t>(piece)] = std::max(0.0, 0.5 * twice);
    sum += share_[static_cast<std::size_t>(piece)];
  }
  for (int piece = 0; piece < n_pieces_ && sum > 0; ++piece) share_[static_cast<std::size_t>(piece)] /= sum;

  unsigned centre = 0;
  for (int c = 0; c < n_chords_; ++c) {
    Chord& chord = chords_[static_cast<std::size_t>(c)];
    for (std::size_t arc = 0; arc < n_arcs; ++arc)
      if (rim[arc].chord == c) (rim[arc].leads_out ? chord.outer_piece : chord.inner_piece) = piece_of_arc[arc];
    if (is_on_outer_side(flat[static_cast<std::size_t>(c)].from, flat[static_cast<std::size_t>(c)].to, {0.5, 0.5}))
      centre |= 1u << c;
  }
  const int n_whole = n_chords_;
  for (int c = 0; c < n_whole; ++c)
    split(c, std::span(flat).first(static_cast<std::size_t>(n_whole)),
          std::span(pieces.things).first(static_cast<std::size_t>(n_pieces_)));
  centre_piece_ = static_cast<int>(std::max_element(share_.begin(), share_.begin() + n_pieces_) - share_.begin());
  for (std::size_t piece = 0; piece < pieces.size() && static_cast<int>(piece) < n_pieces_; ++piece)
    if (pieces[piece] == centre) centre_piece_ = static_cast<int>(piece);
}

/// Where other chords cross it a chord has other pieces beside it. `pieces`: on the outer side of which chords each
/// lies.
void FaceCut::split(int chord, std::span<const FlatChord> flat, std::span<const unsigned> pieces) {
  const FlatChord& own = flat[static_cast<std::size_t>(chord)];
  std::array<double, most_chords> at{};  // in rising order
  std::size_t n = 0;
  for (std::size_t other = 0; other < flat.size() && n < at.size(); ++other) {
    if (static_cast<int>(other) == chord) continue;
    const std::optional<double> share = crossing_share(own.from, own.to, flat[other].from, flat[other].to);
    if (!share) continue;
    std::size_t place = n++;
    for (; place > 0 && at[place - 1] > *share; --place) at[place] = at[place - 1];
    at[place] = *share;
  }
  if (n == 0 || n_chords_ + static_cast<int>(n) > most_parts) return;
  const Chord whole = chords_[static_cast<std::size_t>(chord)];
  for (std::size_t part = 0; part <= n; ++part) {
    Chord& here = chords_[static_cast<std::size_t>(part == 0 ? chord : n_chords_++)];
    here = whole;
    here.from_share = part == 0 ? 0 : at[part - 1], here.to_share = part == n ? 1 : at[part];
    const Eigen::Vector3d way = whole.to_position - whole.from_position;
    here.from_position = whole.from_position + here.from_share * way;
    here.to_position = part == n ? whole.to_position : whole.from_position + here.to_share * way;
    const Flat middle = own.from + 0.5 * (here.from_share + here.to_share) * (own.to - own.from);
    unsigned outer = 1u << chord;
    for (std::size_t other = 0; other < flat.size(); ++other)
      if (static_cast<int>(other) != chord && is_on_outer_side(flat[other].from, flat[other].to, middle))
        outer |= 1u << other;
    const auto piece_of = [&](unsigned signature, int otherwise) {
      const auto found = std::find(pieces.begin(), pieces.end(), signature);
      return found == pieces.end() ? otherwise : static_cast<int>(found - pieces.begin());
    };
    here.outer_piece = piece_of(outer, whole.outer_piece);
    here.inner_piece = piece_of(outer & ~(1u << chord), whole.inner_piece);
  }
}

}  // namespace couplet::flow
