#pragma once
// A block of bytes that is not filled with zeros before it is written to.

#include <cstddef>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>

namespace couplet::wire {

class Frame {
 public:
  Frame() = default;
  explicit Frame(std::size_t size) : bytes_(size > 0 ? new std::byte[size] : nullptr), size_(size) {}
  static Frame copy_of(const void* data, std::size_t size) {
    Frame frame(size);
    if (size > 0) std::memcpy(frame.data(), data, size);
    return frame;
  }
  static Frame copy_of(std::string_view text) { return copy_of(text.data(), text.size()); }
  Frame copy() const { return copy_of(data(), size()); }

  std::byte* data() { return bytes_.get(); }
  const std::byte* data() const { return bytes_.get(); }
  std::size_t size() const { return size_; }
  std::string_view text() const { return {reinterpret_cast<const char*>(bytes_.get()), size_}; }

 private:
  std::unique_ptr<std::byte[]> bytes_;
  std::size_t size_ = 0;
};

}  // namespace couplet::wire
