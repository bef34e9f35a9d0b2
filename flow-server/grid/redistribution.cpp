#include "flow-server/grid/redistribution.hpp"

#include <cstring>

namespace couplet::flow {

namespace {

/// Counts of numbers fit where counts of bytes would not: a block may be larger than 2 GiB.
template <class Number>
MPI_Datatype type_of() {
  return sizeof(Number) == sizeof(double) ? MPI_DOUBLE : MPI_FLOAT;
}

constexpr int redistribution_tag = 200;

Box shifted(const Box& box, const Triple& by) {
  return box.relative_to({-by[0], -by[1], -by[2]});
}

}  // namespace

std::size_t Redistribution::Message::n_values() const {
  std::size_t n = 0;
  for (const Box& box : boxes) n += static_cast<std::size_t>(box.n_cells());
  return n;
}

Redistribution::Redistribution(MPI_Comm communicator, const RankBoxes& from, const RankBoxes& to, const Triple& n_cells,
                               const std::array<bool, 3>& is_periodic)
    : communicator_(communicator) {
  MPI_Comm_rank(communicator_, &rank_);
  // Index + shift of the side that wants is the same cell as the index of the side that has. Both sides list the
  // shifts in the same order.
  std::vector<Triple> shifts;
  const auto reach = [&](int d) { return is_periodic[d] ? 1 : 0; };
  for (int z = -reach(2); z <= reach(2); ++z)
    for (int y = -reach(1); y <= reach(1); ++y)
      for (int x = -reach(0); x <= reach(0); ++x) shifts.push_back({x * n_cells[0], y * n_cells[1], z * n_cells[2]});
  for (int other = 0; other < static_cast<int>(from.size()); ++other) {
    Message sent{other, {}, {}}, received{other, {}, {}};
    for (const Triple& shift : shifts) {
      const Triple back{-shift[0], -shift[1], -shift[2]};
      const Box given =
          intersection(from[static_cast<std::size_t>(rank_)], shifted(to[static_cast<std::size_t>(other)], shift));
      const Box taken =
          intersection(shifted(from[static_cast<std::size_t>(other)], back), to[static_cast<std::size_t>(rank_)]);
      if (!given.is_empty()) sent.boxes.push_back(given);
      if (!taken.is_empty()) received.boxes.push_back(taken);
    }
    if (!sent.boxes.empty()) outgoing_.push_back(std::move(sent));
    if (!received.boxes.empty()) incoming_.push_back(std::move(received));
  }
}

template <class Number>
void Redistribution::move(const Field<Number>& from, const Triple& from_origin, Field<Number>& to,
                          const Triple& to_origin) {
  requests_.clear();
  for (Message& message : incoming_) {
    if (message.rank == rank_) continue;
    message.values.resize(message.n_values() * sizeof(Number));
    requests_.emplace_back();
    MPI_Irecv(message.values.data(), static_cast<int>(message.n_values()), type_of<Number>(), message.rank,
              redistribution_tag, communicator_, &requests_.back());
  }
  const Message* own = nullptr;
  for (Message& message : outgoing_) {
    message.values.resize(message.n_values() * sizeof(Number));
    std::byte* at = message.values.data();
    for (const Box& global : message.boxes) {
      const Box box = global.relative_to(from_origin);
      const std::size_t n_bytes = static_cast<std::size_t>(box.size(0)) * sizeof(Number);
      for (int k = box.begin[2]; k < box.end[2]; ++k)
        for (int j = box.begin[1]; j < box.end[1]; ++j, at += n_bytes)
          std::memcpy(at, from.row(j, k) + box.begin[0], n_bytes);
    }
    if (message.rank == rank_) {
      own = &message;
      continue;
    }
    requests_.emplace_back();
    MPI_Isend(message.values.data(), static_cast<int>(message.n_values()), type_of<Number>(), message.rank,
              redistribution_tag, communicator_, &requests_.back());
    ++traffic_.messages;
    traffic_.bytes += static_cast<std::int64_t>(message.values.size());
  }
  MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
  for (const Message& message : incoming_) {
    const std::byte* at = message.rank == rank_ ? own->values.data() : message.values.data();
    for (const Box& global : message.boxes) {
      const Box box = global.relative_to(to_origin);
      const std::size_t n_bytes = static_cast<std::size_t>(box.size(0)) * sizeof(Number);
      for (int k = box.begin[2]; k < box.end[2]; ++k)
        for (int j = box.begin[1]; j < box.end[1]; ++j, at += n_bytes)
          std::memcpy(to.row(j, k) + box.begin[0], at, n_bytes);
    }
  }
}

template void Redistribution::move<float>(const Field<float>&, const Triple&, Field<float>&, const Triple&);
template void Redistribution::move<double>(const Field<double>&, const Triple&, Field<double>&, const Triple&);

}  // namespace couplet::flow
