#pragma once
// A channel between two threads of one process.

#include <memory>
#include <utility>

#include "proto/wire/channel.hpp"

namespace couplet::wire {

/// Two connected ends, each for one thread. An end that is destroyed is a lost peer for the other one.
std::pair<std::unique_ptr<Channel>, std::unique_ptr<Channel>> make_memory_channel();

}  // namespace couplet::wire
