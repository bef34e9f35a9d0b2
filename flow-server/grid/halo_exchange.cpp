#include "flow-server/grid/halo_exchange.hpp"

#include <algorithm>
#include <cstring>

namespace couplet::flow {

namespace {

constexpr int ghost_tag = 100;

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
        const int rank = decomposition.neighbour(offset);
        if (offset == Triple{0, 0, 0} || rank == MPI_PROC_NULL) continue;
        auto known = std::find_if(neighbours_.begin(), neighbours_.end(),
                                  [&](const Neighbour& neighbour) { return neighbour.rank == rank; });
        if (known == neighbours_.end()) known = neighbours_.insert(known, {rank, {}, {}, {}});
        known->offsets.push_back(offset);
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
    std::int64_t n_sent = 0, n_received = 0;
    for (const Field<Number>* field : fields) {
      const Triple layers = depth_in(*field, depth);
      for (const Triple& offset : neighbour.offsets) {
        n_sent += sent_box(offset, field->sizes(), layers).n_cells();
        n_received += received_box(offset, field->sizes(), layers).n_cells();
      }
    }
    neighbour.outgoing.resize(static_cast<std::size_t>(n_sent) * sizeof(Number));
    neighbour.incoming.resize(static_cast<std::size_t>(n_received) * sizeof(Number));
    if (neighbour.rank == rank_ || n_received == 0) continue;
    requests_.emplace_back();
    MPI_Irecv(neighbour.incoming.data(), static_cast<int>(neighbour.incoming.size()), MPI_BYTE, neighbour.rank,
              ghost_tag, communicator_, &requests_.back());
  }
  for (Neighbour& neighbour : neighbours_) {
    std::byte* to = neighbour.outgoing.data();
    for (const Field<Number>* field : fields)
      for (const Triple& offset : neighbour.offsets)
        to = pack(*field, sent_box(offset, field->sizes(), depth_in(*field, depth)), to);
    if (neighbour.rank == rank_ || neighbour.outgoing.empty()) continue;
    requests_.emplace_back();
    MPI_Isend(neighbour.outgoing.data(), static_cast<int>(neighbour.outgoing.size()), MPI_BYTE, neighbour.rank,
              ghost_tag, communicator_, &requests_.back());
    ++traffic_.messages;
    traffic_.bytes += static_cast<std::int64_t>(neighbour.outgoing.size());
  }
}

template <class Number>
void HaloExchange::finish(const std::vector<Field<Number>*>& fields) {
  MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
  for (const Neighbour& neighbour : neighbours_) {
    // A rank beside itself, across a periodic direction: what leaves on one side comes in on the other.
    const std::byte* from = neighbour.rank == rank_ ? neighbour.outgoing.data() : neighbour.incoming.data();
    for (Field<Number>* field : fields)
      for (auto offset = neighbour.offsets.rbegin(); offset != neighbour.offsets.rend(); ++offset)
        from = unpack(*field, received_box(*offset, field->sizes(), depth_in(*field, depth_)), from);
  }
}

template void HaloExchange::start<float>(const std::vector<Field<float>*>&, int);
template void HaloExchange::start<double>(const std::vector<Field<double>*>&, int);
template void HaloExchange::finish<float>(const std::vector<Field<float>*>&);
template void HaloExchange::finish<double>(const std::vector<Field<double>*>&);

}  // namespace couplet::flow
