#pragma once
// The keys of an encrypted, mutually authenticated link (CURVE), and the files that hold them.

#include <cstddef>
#include <filesystem>
#include <string>

namespace couplet::wire {

inline constexpr std::size_t curve_key_bytes = 32;

/// Each in the 40 characters of Z85. A program knows its own pair and the public key of the one program that it talks
/// to.
struct CurveKeys {
  std::string secret_key, public_key, peer_public_key;
};

/// Reads `program`.key and `peer`.pub of a folder that `couplet keys` has made; the program's own public key follows
/// from its secret one. Throws FileError when one is missing, is no key, or the secret one may be read by other users.
CurveKeys read_curve_keys(const std::filesystem::path& folder, const std::string& program, const std::string& peer);

}  // namespace couplet::wire
