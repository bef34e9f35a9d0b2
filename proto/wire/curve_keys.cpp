#include "proto/wire/curve_keys.hpp"

#include <zmq.h>

#include <array>
#include <fstream>

#include "proto/report/failure.hpp"

namespace couplet::wire {

namespace {

constexpr std::size_t key_length = 40;
const std::string how_to_make =
    "make keys with `couplet keys DIR`, and give each host the .key of its own program and the .pub of the others";

std::string read_key(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw report::FileError(path.string(), "cannot read this key", how_to_make);
  std::string key, more;
  file >> key;
  std::array<unsigned char, curve_key_bytes> bytes{};
  if (key.size() != key_length || file >> more || zmq_z85_decode(bytes.data(), key.c_str()) == nullptr)
    throw report::FileError(path.string(), "holds no key: one is 40 printable characters", how_to_make);
  return key;
}

}  // namespace

CurveKeys read_curve_keys(const std::filesystem::path& folder, const std::string& program, const std::string& peer) {
  namespace fs = std::filesystem;
  const fs::path secret = folder / (program + ".key");
  CurveKeys keys;
  keys.secret_key = read_key(secret);
  constexpr fs::perms others = fs::perms::group_all | fs::perms::others_all;
  if ((fs::status(secret).permissions() & others) != fs::perms::none)
    throw report::FileError(secret.string(), "other users may use this secret key", "chmod 600 " + secret.string());
  std::array<char, key_length + 1> public_key{};
  if (zmq_curve_public(public_key.data(), keys.secret_key.c_str()) != 0)
    throw report::FileError("libzmq", "this build of ZeroMQ has no CURVE", "install Debian's libzmq5");
  keys.public_key = public_key.data();
  keys.peer_public_key = read_key(folder / (peer + ".pub"));
  return keys;
}

}  // namespace couplet::wire
