#pragma once
// What every channel must do, whatever it is made of. A kind of channel joins by an INSTANTIATE_TEST_SUITE_P line of
// its own.

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>

#include "proto/wire/channel.hpp"

namespace couplet::wire {

/// Makes two connected ends and plays both parts, in two threads or in two processes. A part may destroy its end early.
class TwoEnds {
 public:
  using Part = std::function<void(std::unique_ptr<Channel>)>;
  virtual ~TwoEnds() = default;
  virtual void play(const Part& coupler, const Part& server) = 0;
};

struct ChannelKind {
  std::string name;
  std::function<std::unique_ptr<TwoEnds>()> make;
};

class ChannelConformance : public testing::TestWithParam<ChannelKind> {
 protected:
  void play(const TwoEnds::Part& coupler, const TwoEnds::Part& server) { GetParam().make()->play(coupler, server); }
};

}  // namespace couplet::wire
