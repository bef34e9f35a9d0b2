#include "flow-server/grid/halo_exchange.hpp"

#include <cstring>

namespace couplet::flow {

namespace {

constexpr int first_tag = 100;  // 27 tags, one a direction

int tag_of(const Triple& offset) {
  return first_tag + (offset[0] + 1) + 3 * (offset[1] + 1) + 9 * (offset[2] + 1);
}

/// Ghost layers exist only in directions where the field has them: not across a two-dimensional grid.
template <class Number>
Triple depth_in(const Field<Number>& field, int depth) {
  Triple layers;
  for (int d = 0; d < 3; ++d) layers[d] = field.ghosts()[d] > 0 ? depth : 0;
  return layers;
}

template <class Number>
std::byte* pack(const Field<Number>& field, const Box& box, std::byte* to) {
  const std::size_t n_bytes = static_cast<std::size_t>(box.size(0)) * sizeof(Number);
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j, to += n_bytes)
      std::memcpy(to, field.row(j, k) + box.begin[0], n_bytes);
  return to;
}

template <class Number>
const std::byte* unpack(Field<Number>& field, const Box& box, const std::byte* from) {
  const std::size_t n_bytes = static_cast<std::size_t>(box.size(0)) * sizeof(Number);
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j, from += n_bytes)
      std::memcpy(field.row(j, k) + box.begin[0], from, n_bytes);
  return from;
}

}  // namespace

HaloExchange::HaloExchange(const BlockDecomposition& decomposition)
    : communicator_(decomposition.communicator()), rank_(decomposition.rank()) {
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) is_at_border_[d][side] = decomposition.is_at_border(d, side);
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        const Triple offset{x, y, z};
        if (offset == Triple{0, 0, 0}) continue;
        const int neighbour = decomposition.neighbour(offset);
        if (neighbour != MPI_PROC_NULL) neighbours_.push_back({offset, neighbour, {}, {}});
      }
}

/// Along a direction in which the neighbour does not lie, ghosts beyond a border of the whole travel too.
Box HaloExchange::sent_box(const Triple& offset, const Triple& sizes, const Triple& depth) const {
  Box box = box_of(sizes);
  for (int d = 0; d < 3; ++d) {
    if (offset[d] < 0) box.end[d] = depth[d];
    if (offset[d] > 0) box.begin[d] = sizes[d] - depth[d];
    if (offset[d] == 0 && is_at_border_[d][0]) box.begin[d] -= depth[d];
    if (offset[d] == 0 && is_at_border_[d][1]) box.end[d] += depth[d];
  }
  return box;
}

Box HaloExchange::received_box(const Triple& offset, const Triple& sizes, const Triple& depth) const {
  Box box = sent_box({0, 0, 0}, sizes, depth);
  for (int d = 0; d < 3; ++d) {
    if (offset[d] < 0) box.begin[d] = -depth[d], box.end[d] = 0;
    if (offset[d] > 0) box.begin[d] = sizes[d], box.end[d] = sizes[d] + depth[d];
  }
  return box;
}

template <class Number>
void HaloExchange::start(const std::vector<Field<Number>*>& fields, int depth) {
  depth_ = depth;
  requests_.clear();
  for (Neighbour& neighbour : neighbours_) {
    const Triple opposite{-neighbour.offset[0], -neighbour.offset[1], -neighbour.offset[2]};
    std::size_t n_bytes = 0, n_expected = 0;
    for (const Field<Number>* field : fields) {
      const Triple layers = depth_in(*field, depth);
      n_bytes +=
          static_cast<std::size_t>(sent_box(neighbour.offset, field->sizes(), layers).n_cells()) * sizeof(Number);
      n_expected +=
          static_cast<std::size_t>(received_box(neighbour.offset, field->sizes(), layers).n_cells()) * sizeof(Number);
    }
    neighbour.outgoing.resize(n_bytes);
    neighbour.incoming.resize(n_expected);
    if (neighbour.rank != rank_ && n_expected > 0) {
      requests_.emplace_back();
      MPI_Irecv(neighbour.incoming.data(), static_cast<int>(n_expected), MPI_BYTE, neighbour.rank, tag_of(opposite),
                communicator_, &requests_.back());
    }
  }
  for (Neighbour& neighbour : neighbours_) {
    std::byte* to = neighbour.outgoing.data();
    for (const Field<Number>* field : fields)
      to = pack(*field, sent_box(neighbour.offset, field->sizes(), depth_in(*field, depth)), to);
    if (neighbour.rank == rank_ || neighbour.outgoing.empty()) continue;
    requests_.emplace_back();
    MPI_Isend(neighbour.outgoing.data(), static_cast<int>(neighbour.outgoing.size()), MPI_BYTE, neighbour.rank,
              tag_of(neighbour.offset), communicator_, &requests_.back());
    ++traffic_.messages;
    traffic_.bytes += static_cast<std::int64_t>(neighbour.outgoing.size());
  }
}

template <class Number>
void HaloExchange::finish(const std::vector<Field<Number>*>& fields) {
  MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
  for (Neighbour& neighbour : neighbours_) {
    const std::byte* from = neighbour.incoming.data();
    if (neighbour.rank == rank_) {
      // A periodic direction with one block: what leaves on the other side comes in here.
      for (const Neighbour& other : neighbours_) {
        if (other.offset[0] == -neighbour.offset[0] && other.offset[1] == -neighbour.offset[1] &&
            other.offset[2] == -neighbour.offset[2])
          from = other.outgoing.data();
      }
    }
    for (Field<Number>* field : fields)
      from = unpack(*field, received_box(neighbour.offset, field->sizes(), depth_in(*field, depth_)), from);
  }
}

template void HaloExchange::start<float>(const std::vector<Field<float>*>&, int);
template void HaloExchange::start<double>(const std::vector<Field<double>*>&, int);
template void HaloExchange::finish<float>(const std::vector<Field<float>*>&);
template void HaloExchange::finish<double>(const std::vector<Field<double>*>&);

}  // namespace couplet::flow
