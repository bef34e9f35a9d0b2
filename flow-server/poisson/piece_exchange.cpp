#include "flow-server/poisson/piece_exchange.hpp"

#include <algorithm>
#include <cstring>

namespace couplet::flow {

namespace {

constexpr int name_tag = 300, value_tag = 301;

int owner_of(std::int64_t cell, const std::array<Partition, 3>& partitions) {
  const std::int64_t nx = partitions[0].n_cells(), ny = partitions[1].n_cells();
  const int x = partitions[0].part_of(static_cast<int>(cell % nx));
  const int y = partitions[1].part_of(static_cast<int>(cell / nx % ny));
  const int z = partitions[2].part_of(static_cast<int>(cell / nx / ny));
  return x + partitions[0].n_parts() * (y + partitions[1].n_parts() * z);
}

}  // namespace

UnknownName name_of(Triple cell, int number, const Triple& n_cells) {
  for (int d = 0; d < 3; ++d) cell[d] = (cell[d] % n_cells[d] + n_cells[d]) % n_cells[d];
  return {cell[0] + n_cells[0] * (cell[1] + static_cast<std::int64_t>(n_cells[1]) * cell[2]), number};
}

PieceExchange::PieceExchange(MPI_Comm communicator, const std::array<Partition, 3>& owners,
                             std::vector<NamedPlace> held, const std::vector<NamedPlace>& wanted)
    : communicator_(communicator) {
  int n = 1;
  MPI_Comm_rank(communicator_, &rank_);
  MPI_Comm_size(communicator_, &n);
  const auto n_ranks = static_cast<std::size_t>(n);
  std::sort(held.begin(), held.end(), [](const NamedPlace& a, const NamedPlace& b) { return a.name < b.name; });
  std::vector<std::vector<UnknownName>> asked(n_ranks);
  std::vector<std::vector<int>> places(n_ranks);
  for (const NamedPlace& one : wanted) {
    const auto owner = static_cast<std::size_t>(owner_of(one.name.cell, owners));
    asked[owner].push_back(one.name);
    places[owner].push_back(one.place);
  }
  std::vector<int> n_asked(n_ranks), n_given(n_ranks);
  for (std::size_t rank = 0; rank < n_ranks; ++rank) n_asked[rank] = static_cast<int>(asked[rank].size());
  MPI_Alltoall(n_asked.data(), 1, MPI_INT, n_given.data(), 1, MPI_INT, communicator_);
  std::vector<std::vector<UnknownName>> given(n_ranks);
  for (std::size_t rank = 0; rank < n_ranks; ++rank) {
    if (n_given[rank] == 0) continue;
    given[rank].resize(static_cast<std::size_t>(n_given[rank]));
    if (static_cast<int>(rank) == rank_) {
      given[rank] = asked[rank];
      continue;
    }
    requests_.emplace_back();
    MPI_Irecv(given[rank].data(), static_cast<int>(given[rank].size() * sizeof(UnknownName)), MPI_BYTE,
              static_cast<int>(rank), name_tag, communicator_, &requests_.back());
  }
  for (std::size_t rank = 0; rank < n_ranks; ++rank) {
    if (asked[rank].empty()) continue;
    incoming_.push_back({static_cast<int>(rank), std::move(places[rank]), {}});
    if (static_cast<int>(rank) == rank_) continue;
    requests_.emplace_back();
    MPI_Isend(asked[rank].data(), static_cast<int>(asked[rank].size() * sizeof(UnknownName)), MPI_BYTE,
              static_cast<int>(rank), name_tag, communicator_, &requests_.back());
  }
  MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
  for (std::size_t rank = 0; rank < n_ranks; ++rank) {
    if (given[rank].empty()) continue;
    Message message{static_cast<int>(rank), {}, {}};
    for (const UnknownName& name : given[rank]) {
      const auto found = std::lower_bound(held.begin(), held.end(), name,
                                          [](const NamedPlace& a, const UnknownName& b) { return a.name < b; });
      message.places.push_back(found != held.end() && found->name == name ? found->place : -1);
    }
    outgoing_.push_back(std::move(message));
  }
}

template <class Number>
void PieceExchange::move(const Number* from, Number* to) {
  requests_.clear();
  for (Message& message : incoming_) {
    message.values.resize(message.places.size() * sizeof(Number));
    if (message.rank == rank_) continue;
    requests_.emplace_back();
    MPI_Irecv(message.values.data(), static_cast<int>(message.values.size()), MPI_BYTE, message.rank, value_tag,
              communicator_, &requests_.back());
  }
  const Message* own = nullptr;
  for (Message& message : outgoing_) {
    message.values.resize(message.places.size() * sizeof(Number));
    for (std::size_t v = 0; v < message.places.size(); ++v) {
      const Number value = message.places[v] < 0 ? Number(0) : from[message.places[v]];
      std::memcpy(message.values.data() + v * sizeof(Number), &value, sizeof(Number));
    }
    if (message.rank == rank_) {
      own = &message;
      continue;
    }
    requests_.emplace_back();
    MPI_Isend(message.values.data(), static_cast<int>(message.values.size()), MPI_BYTE, message.rank, value_tag,
              communicator_, &requests_.back());
    ++traffic_.messages;
    traffic_.bytes += static_cast<std::int64_t>(message.values.size());
  }
  MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
  for (const Message& message : incoming_) {
    const std::byte* values = message.rank == rank_ ? own->values.data() : message.values.data();
    for (std::size_t v = 0; v < message.places.size(); ++v)
      std::memcpy(to + message.places[v], values + v * sizeof(Number), sizeof(Number));
  }
}

template void PieceExchange::move<float>(const float*, float*);
template void PieceExchange::move<double>(const double*, double*);

}  // namespace couplet::flow
