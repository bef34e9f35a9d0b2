#pragma once
// A report::Failure on its way to the other program.

#include <exception>
#include <string>

#include "couplet/v1/exchange.pb.h"

namespace couplet::wire {

/// What any exception says to the coupler: a Failure as it is, lack of memory as NUMERICS, anything else as BUG.
v1::Failure describe_failure(const std::exception_ptr& fault);

/// Throws the SceneError, NumericsError, PeerError, FileError or (a bug) Failure that the message describes; `whose`
/// stands for a place that is not given.
[[noreturn]] void throw_failure(const v1::Failure& failure, const std::string& whose);

}  // namespace couplet::wire
