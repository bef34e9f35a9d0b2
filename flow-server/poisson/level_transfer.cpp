#include "flow-server/poisson/level_transfer.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace couplet::flow {

namespace {

// Through coarse faces less open than that nothing is interpolated: across a sheet that leaks a little the pressure
// jumps.
constexpr float smallest_slope_share = 0.1f;

/// coarse[I] += factor * sum of share[i] fine[i] over the cells of I.
void add_restricted_row(float* __restrict coarse, const float* __restrict fine, const BlockMerging& merging,
                        float factor) {
  const float* __restrict share = merging.share.data();
  for (const BlockMerging::Run& run : merging.runs) {
    float* __restrict c = coarse + run.first_coarse;
    const float* __restrict r = fine + run.first_fine;
    const float* __restrict s = share + run.first_fine;
    if (run.group_size == 1) {
      for (int I = 0; I < run.n_coarse; ++I) c[I] += factor * (s[I] * r[I]);
    } else if (run.group_size == 2) {
      for (int I = 0; I < run.n_coarse; ++I) c[I] += factor * (s[2 * I] * r[2 * I] + s[2 * I + 1] * r[2 * I + 1]);
    } else {
      for (int I = 0; I < run.n_coarse; ++I)
        c[I] += factor * (s[3 * I] * r[3 * I] + s[3 * I + 1] * r[3 * I + 1] + s[3 * I + 2] * r[3 * I + 2]);
    }
  }
}

/// fine[i] = base[I] + weight[i] (slope towards the neighbour of i), slope[I] being that from I to I + 1.
void interpolate_row(float* __restrict fine, const float* __restrict base, const float* __restrict slope,
                     const BlockMerging& merging) {
  for (const BlockMerging::Run& run : merging.runs) {
    float* __restrict f = fine + run.first_fine;
    const float* __restrict b = base + run.first_coarse;
    const float* __restrict s = slope + run.first_coarse;
    const float* __restrict w = merging.weight.data() + run.first_fine;
    if (run.group_size == 1) {
      for (int I = 0; I < run.n_coarse; ++I) f[I] = b[I];
    } else if (run.group_size == 2) {
      for (int I = 0; I < run.n_coarse; ++I) {
        f[2 * I] = b[I] - w[2 * I] * s[I - 1];
        f[2 * I + 1] = b[I] + w[2 * I + 1] * s[I];
      }
    } else {
      for (int I = 0; I < run.n_coarse; ++I) {
        f[3 * I] = b[I] - w[3 * I] * s[I - 1];
        f[3 * I + 1] = b[I];
        f[3 * I + 2] = b[I] + w[3 * I + 2] * s[I];
      }
    }
  }
}

}  // namespace

LevelTransfer::LevelTransfer(const FineLevel& fine) : fine_(fine), sizes_(fine.decomposition.mine().sizes()) {
  if (fine.share) aggregates_ = std::make_unique<ConnectedAggregates>(fine);
  if (!fine_.decomposition.has_cells()) return;
  const Box& mine = fine_.decomposition.mine();
  for (int d = 0; d < 3; ++d) {
    BlockMerging& block = merging_[d];
    coarse_box_.begin[d] = fine_.merging[d].coarse_of(mine.begin[d]);
    coarse_box_.end[d] = fine_.merging[d].coarse_of(mine.end[d] - 1) + 1;
    block.n_coarse = coarse_box_.size(d);
    for (int C = coarse_box_.begin[d]; C < coarse_box_.end[d]; ++C) {
      const LevelAxis& coarse = fine_.coarse_axes[d];
      const int first = fine_.merging[d].first[C], size = fine_.merging[d].first[C + 1] - first;
      if (block.runs.empty() || block.runs.back().group_size != size)
        block.runs.push_back({first - mine.begin[d], C - coarse_box_.begin[d], 0, size});
      ++block.runs.back().n_coarse;
      double centre = -0.5 * coarse.width[C];  // of the fine cell, from that of the coarse one
      for (int i = first; i < first + size; ++i) {
        const double width = fine_.axes[d].width[i];
        centre += 0.5 * width;
        // Towards the neighbour across the nearer coarse face; at that face the value beyond a border is 0 for an open
        // one and the same as inside for a closed one.
        const int side = size == 1 || (size == 3 && i == first + 1) ? 0 : (i == first ? -1 : 1);
        double per_distance = 0;
        if (side < 0) per_distance = coarse.lower(C) * coarse.width[C];
        if (side > 0) per_distance = coarse.upper(C) * coarse.width[C];
        block.coarse.push_back(C - coarse_box_.begin[d]);
        block.neighbour.push_back(C - coarse_box_.begin[d] + side);
        block.share.push_back(static_cast<float>(width / coarse.width[C]));
        block.weight.push_back(static_cast<float>(std::abs(centre) * per_distance));
        centre += 0.5 * width;
      }
    }
  }
  correction_row_.resize(static_cast<std::size_t>(sizes_[0]));
  base_row_.resize(static_cast<std::size_t>(merging_[0].n_coarse) + 2);
  slope_row_.resize(static_cast<std::size_t>(merging_[0].n_coarse) + 2);
}

void LevelTransfer::update(LevelPieces* pieces, const CellMask& changed, HaloExchange& halo) {
  fine_.pieces = pieces;
  aggregates_->update(fine_, changed, halo);
  kept_.assign(aggregates_->n_cells(), 0.0f);
  coarse_pieces_rhs.assign(aggregates_->coarse_pieces().size(), 0.0f);
  coarse_pieces_phi.assign(aggregates_->coarse_pieces().size(), 0.0f);
}

void LevelTransfer::restrict_row(int j, int k, float* residual, Field<float>& coarse_rhs) {
  const auto at_j = static_cast<std::size_t>(j), at_k = static_cast<std::size_t>(k);
  const int J = merging_[1].coarse[at_j], K = merging_[2].coarse[at_k];
  float* coarse = coarse_rhs.row(J, K);
  if ((k == 0 || merging_[2].coarse[at_k - 1] != K) && (j == 0 || merging_[1].coarse[at_j - 1] != J))
    std::fill(coarse, coarse + merging_[0].n_coarse, 0.0f);
  if (!residual) return;
  if (aggregates_) {
    const auto members = aggregates_->cells(j, k);
    for (const ConnectedAggregates::Member& member : members) {
      float& value = residual[member.unknown.cell[0]];
      kept_[static_cast<std::size_t>(&member - aggregates_->members().data())] = value;
      value = 0;
    }
  }
  add_restricted_row(coarse, residual, merging_[0], merging_[1].share[at_j] * merging_[2].share[at_k]);
}

void LevelTransfer::finish_restriction(const std::vector<float>& piece_residual, Field<float>& coarse_rhs) {
  if (!aggregates_) return;
  std::fill(coarse_pieces_rhs.begin(), coarse_pieces_rhs.end(), 0.0f);
  const auto members = aggregates_->members();
  for (std::size_t m = 0; m < members.size(); ++m) {
    const ConnectedAggregates::Member& member = members[m];
    const float residual = member.unknown.piece < 0 ? kept_[m] : piece_residual[member.unknown.piece];
    float& coarse = member.piece < 0 ? coarse_rhs(member.coarse[0], member.coarse[1], member.coarse[2])
                                     : coarse_pieces_rhs[member.piece];
    coarse += member.volume_share * residual;
  }
}

float LevelTransfer::correction_of(const ConnectedAggregates::Member& member, const Field<float>& coarse_phi) const {
  if (member.piece >= 0) return coarse_pieces_phi[member.piece];
  return coarse_phi(member.coarse[0], member.coarse[1], member.coarse[2]);
}

void LevelTransfer::add_correction(const Field<float>& coarse_phi, const FaceFractions* coarse_share,
                                   const ActiveCells& active, Field<float>& phi) {
  if (!fine_.decomposition.has_cells()) return;
  const int n_coarse = merging_[0].n_coarse;
  float* __restrict base = base_row_.data() + 1;
  float* __restrict slope = slope_row_.data() + 1;
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j) {
      const auto intervals = active.row(j, k);
      if (intervals.empty()) continue;
      const auto at_j = static_cast<std::size_t>(j), at_k = static_cast<std::size_t>(k);
      const int J = merging_[1].coarse[at_j], K = merging_[2].coarse[at_k];
      const int to_J = merging_[1].neighbour[at_j], to_K = merging_[2].neighbour[at_k];
      const float y = merging_[1].weight[at_j], z = merging_[2].weight[at_k];
      const float* __restrict own = coarse_phi.row(J, K);
      const float* __restrict in_y = coarse_phi.row(to_J, K);
      const float* __restrict in_z = coarse_phi.row(J, to_K);
      if (coarse_share) {
        // Constant plus one slope a direction, each only where the coarse face is open.
        const float* __restrict y_face = (*coarse_share)[1].row(std::min(J, to_J), K);
        const float* __restrict z_face = (*coarse_share)[2].row(J, std::min(K, to_K));
        const float* __restrict x_face = (*coarse_share)[0].row(J, K);
        for (int I = 0; I < n_coarse; ++I)
          base[I] = own[I] + (y_face[I] >= smallest_slope_share ? y : 0.0f) * (in_y[I] - own[I]) +
                    (z_face[I] >= smallest_slope_share ? z : 0.0f) * (in_z[I] - own[I]);
        for (int I = -1; I < n_coarse; ++I) slope[I] = x_face[I] >= smallest_slope_share ? own[I + 1] - own[I] : 0.0f;
      } else {
        const float* __restrict in_yz = coarse_phi.row(to_J, to_K);
        for (int I = -1; I <= n_coarse; ++I)
          base[I] = (1 - z) * ((1 - y) * own[I] + y * in_y[I]) + z * ((1 - y) * in_z[I] + y * in_yz[I]);
        for (int I = -1; I < n_coarse; ++I) slope[I] = base[I + 1] - base[I];
      }
      interpolate_row(correction_row_.data(), base, slope, merging_[0]);
      if (aggregates_)
        for (const ConnectedAggregates::Member& member : aggregates_->cells(j, k))
          correction_row_[member.unknown.cell[0]] = correction_of(member, coarse_phi);
      float* __restrict fine = phi.row(j, k);
      const float* __restrict correction = correction_row_.data();
      for (const Interval& interval : intervals)
        for (int i = std::max(interval.begin, 0); i < std::min(interval.end, sizes_[0]); ++i) fine[i] += correction[i];
    }
  if (!aggregates_) return;
  for (const ConnectedAggregates::Member& member : aggregates_->members().subspan(aggregates_->n_cells()))
    fine_.pieces->phi[member.unknown.piece] += correction_of(member, coarse_phi);
}

int LevelTransfer::inject(const Field<float>& coarse_phi, const ActiveCells& active, Field<float>& phi) const {
  std::map<std::pair<Triple, int>, int> alone;
  const auto number_of = [&](const Triple& coarse, int piece) {
    return static_cast<float>(-2 -
                              alone.emplace(std::pair(coarse, piece), static_cast<int>(alone.size())).first->second);
  };
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j) {
      const int J = merging_[1].coarse[static_cast<std::size_t>(j)],
                K = merging_[2].coarse[static_cast<std::size_t>(k)];
      for (const Interval& interval : active.row(j, k))
        for (int i = std::max(interval.begin, 0); i < std::min(interval.end, sizes_[0]); ++i) {
          if (!aggregates_->is_regular(i, j, k)) continue;
          const int I = merging_[0].coarse[static_cast<std::size_t>(i)];
          const float value = coarse_phi(I, J, K);
          phi(i, j, k) = value != 0 ? value : number_of({I, J, K}, -1);
        }
    }
  for (const ConnectedAggregates::Member& member : aggregates_->members()) {
    const PressureUnknown& u = member.unknown;
    const float coarse = correction_of(member, coarse_phi);
    const float value = coarse != 0 ? coarse : number_of(member.coarse, member.piece);
    (u.piece < 0 ? phi(u.cell[0], u.cell[1], u.cell[2]) : fine_.pieces->phi[u.piece]) = value;
  }
  return static_cast<int>(alone.size());
}

Box LevelTransfer::cells_of(const Triple& C) const {
  Box cells;
  for (int d = 0; d < 3; ++d) {
    const int begin = fine_.decomposition.mine().begin[d];
    cells.begin[d] = fine_.merging[d].first[coarse_box_.begin[d] + C[d]] - begin;
    cells.end[d] = fine_.merging[d].first[coarse_box_.begin[d] + C[d] + 1] - begin;
  }
  return cells;
}

/// From the fine faces between cells that belong to the coarse ones themselves; of the upper face of C, or of the first
/// face, the lower one, beyond which there are no cells.
float LevelTransfer::coarse_share(int d, const Triple& C, bool is_first) const {
  Box cells = cells_of(C);
  (is_first ? cells.end[d] : cells.begin[d]) = is_first ? cells.begin[d] + 1 : cells.end[d] - 1;
  float sum = 0;
  for (int k = cells.begin[2]; k < cells.end[2]; ++k)
    for (int j = cells.begin[1]; j < cells.end[1]; ++j)
      for (int i = cells.begin[0]; i < cells.end[0]; ++i) {
        Triple face{i, j, k}, other{i, j, k};
        is_first ? --face[d] : ++other[d];
        const float share = (*fine_.share)[d](face[0], face[1], face[2]);
        if (share == 0 || !aggregates_->is_regular(i, j, k)) continue;
        if (!is_first && !aggregates_->is_regular(other[0], other[1], other[2])) continue;
        const Triple cell{i, j, k};
        float area = 1;  // of the fine face over that of the coarse one
        for (int e = 0; e < 3; ++e)
          if (e != d) area *= merging_[e].share[static_cast<std::size_t>(cell[e])];
        sum += area * share;
      }
  return sum;
}

}  // namespace couplet::flow
