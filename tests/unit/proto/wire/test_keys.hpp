#pragma once
// Keys for tests: made anew for each.

#include <zmq.h>

#include <stdexcept>
#include <utility>

#include "proto/wire/curve_keys.hpp"

namespace couplet::wire {

struct KeyPair {
  std::string secret_key, public_key;
};

inline KeyPair make_key_pair() {
  char public_key[41], secret_key[41];
  if (zmq_curve_keypair(public_key, secret_key) != 0) throw std::runtime_error("no CURVE in this ZeroMQ");
  return {secret_key, public_key};
}

/// Of a coupler and a server that know each other.
inline std::pair<CurveKeys, CurveKeys> make_keys_of_both() {
  const KeyPair coupler = make_key_pair(), server = make_key_pair();
  return {{coupler.secret_key, coupler.public_key, server.public_key},
          {server.secret_key, server.public_key, coupler.public_key}};
}

}  // namespace couplet::wire
