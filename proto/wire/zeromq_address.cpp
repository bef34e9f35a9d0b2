#include "proto/wire/zeromq_address.hpp"

#include <algorithm>
#include <string_view>

#include "proto/report/failure.hpp"

namespace couplet::wire {

namespace {

constexpr std::string_view tcp = "tcp://", ipc = "ipc://";

bool starts_with(const std::string& text, std::string_view start) {
  return text.compare(0, start.size(), start) == 0;
}

bool is_port(const std::string& text) {
  if (text == "*") return true;
  const bool digits = !text.empty() && text.size() <= 5 &&
                      std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
  return digits && std::stoi(text) <= 65535;
}

std::string host_of(const std::string& address) {
  return address.substr(tcp.size(), address.rfind(':') - tcp.size());
}

}  // namespace

void check_zeromq_address(const std::string& address) {
  constexpr std::size_t longest_path = 107;  // [bytes] of a Unix socket's name
  if (starts_with(address, ipc) && address.size() > ipc.size() && address.size() - ipc.size() <= longest_path) return;
  if (starts_with(address, tcp)) {
    const auto colon = address.rfind(':');
    if (colon > tcp.size() && is_port(address.substr(colon + 1))) return;
  }
  throw report::SceneError("'" + address + "'", "is not an address",
                           "write tcp://HOST:PORT (tcp://127.0.0.1:* for any free port), ipc://PATH or ipc://@NAME");
}

bool is_local_address(const std::string& address) {
  if (starts_with(address, ipc)) return true;
  const std::string host = host_of(address);
  if (host == "localhost" || host == "[::1]" || host == "lo") return true;
  // 127.0.0.0/8, written as four numbers; a name that merely starts with 127. is not one.
  return starts_with(host, "127.") &&
         std::all_of(host.begin(), host.end(), [](char c) { return c == '.' || (c >= '0' && c <= '9'); }) &&
         std::count(host.begin(), host.end(), '.') == 3;
}

}  // namespace couplet::wire
