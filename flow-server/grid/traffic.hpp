#pragma once
// What a rank has sent: the measure of cost that does not depend on the machine.

#include <cstdint>

namespace couplet::flow {

struct Traffic {
  std::int64_t messages = 0;    // sent to other ranks
  std::int64_t bytes = 0;       // in them
  std::int64_t reductions = 0;  // sums and maxima over all ranks

  friend Traffic operator-(const Traffic& a, const Traffic& b) {
    return {a.messages - b.messages, a.bytes - b.bytes, a.reductions - b.reductions};
  }
  Traffic& operator+=(const Traffic& other) {
    messages += other.messages, bytes += other.bytes, reductions += other.reductions;
    return *this;
  }
};

}  // namespace couplet::flow
