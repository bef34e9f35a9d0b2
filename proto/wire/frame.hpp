#pragma once
// A block of bytes that is not filled with zeros before it is written to and is not copied on its way to the other
// program.

#include <cstddef>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

namespace couplet::wire {

/// Move-only, so that no copy happens unseen. The bytes are held by a shared_ptr for two reasons: a transport may still
/// be sending them while the session keeps them for a repeat, and they may live inside another object (an array, a
/// received message) that must then live as long.
class Frame {
 public:
  Frame() = default;
  explicit Frame(std::size_t size)
      : bytes_(size > 0 ? std::shared_ptr<std::byte>(new std::byte[size], std::default_delete<std::byte[]>())
                        : nullptr),
        size_(size) {}
  static Frame copy_of(const void* data, std::size_t size) {
    Frame frame(size);
    if (size > 0) std::memcpy(frame.data(), data, size);
    return frame;
  }
  static Frame copy_of(std::string_view text) { return copy_of(text.data(), text.size()); }
  /// Bytes inside `owner`, which is kept until the last frame that shares them is gone.
  static Frame inside(const std::shared_ptr<void>& owner, void* data, std::size_t size) {
    Frame frame;
    frame.bytes_ = std::shared_ptr<std::byte>(owner, static_cast<std::byte*>(data));
    frame.size_ = size;
    return frame;
  }
  Frame(Frame&& other) noexcept : bytes_(std::move(other.bytes_)), size_(std::exchange(other.size_, 0)) {}
  Frame& operator=(Frame&& other) noexcept {
    bytes_ = std::move(other.bytes_);
    size_ = std::exchange(other.size_, 0);
    return *this;
  }

  Frame copy() const { return copy_of(data(), size()); }
  /// The same bytes once more; nobody may write to them from now on.
  Frame share() const { return inside(bytes_, bytes_.get(), size_); }

  std::byte* data() { return bytes_.get(); }
  const std::byte* data() const { return bytes_.get(); }
  std::size_t size() const { return size_; }
  std::string_view text() const { return {reinterpret_cast<const char*>(bytes_.get()), size_}; }

 private:
  std::shared_ptr<std::byte> bytes_;
  std::size_t size_ = 0;
};

}  // namespace couplet::wire
