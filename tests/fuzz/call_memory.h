// Arguments of random calls: choices made from bytes, and images in heap blocks of exactly their size.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "umbrage/umbrage.h"

namespace umbrage::fuzz {

/// Prints `sentence` and aborts unless `holds`.
void demand(bool holds, const std::string& sentence);

/// Makes choices from bytes. After the last byte, every choice is the first option.
class Choices {
 public:
  explicit Choices(std::string_view bytes) : bytes_(bytes) {}
  bool used_up() const { return at_ >= bytes_.size(); }
  /// Returns a number below `end`, which is above 0.
  unsigned below(unsigned end);
  /// Returns true for one of `count` options.
  bool one_in(unsigned count) { return below(count) == count - 1; }
  template <class T>
  const T& one_of(const std::vector<T>& all) {
    return all[below(unsigned(all.size()))];
  }

 private:
  std::uint8_t next() { return used_up() ? std::uint8_t(0) : std::uint8_t(bytes_[at_++]); }

  std::string_view bytes_;
  std::size_t at_ = 0;
};

/// Heap memory that can start at any address.
class Block {
 public:
  /// Allocates `size` bytes after `offset` unused ones.
  explicit Block(std::size_t size, std::size_t offset = 0);
  std::byte* data() { return bytes_.get() + offset_; }
  std::size_t size() const { return size_; }
  std::size_t offset() const { return offset_; }
  void fill(std::byte value);

 private:
  std::unique_ptr<std::byte[]> bytes_;
  std::size_t size_, offset_;
};
using BlockPtr = std::shared_ptr<Block>;

/// An image and the block with its pixels; null if it has no pixels.
struct Pixels {
  UmbImage image{};
  BlockPtr block;
};
/// Images by the name under which they were passed.
using NamedPixels = std::map<std::string, Pixels>;

std::size_t bytes_of(int type);

/// Returns a valid image of this size: any layout that the header allows, with values of all kinds.
Pixels valid_image(Choices& choose, int type, int width, int height, int channels);
/// Returns a plane of floats, most of which are valid distances.
Pixels depth_image(Choices& choose, int width, int height);

/// Fills the block with bytes that no picture contains: floats and ids made of them are invalid.
void fill_with_canaries(Pixels& pixels, std::byte value);
inline constexpr std::byte kCanary{0xfe}, kOtherCanary{0xfd};

/// Returns the indices of the values of the image with all bytes equal to `canary`.
std::vector<std::size_t> indices_of_canaries(const Pixels& pixels, std::byte canary);
/// Returns whether all bytes of a block that belong to no image equal `canary`.
bool is_untouched_outside(const NamedPixels& images, const BlockPtr& block, std::byte canary);
/// Returns whether all bytes of the block equal `canary`.
bool is_untouched(Block& block, std::byte canary);
/// Returns a hash of all bytes.
std::uint64_t hash_of(Block& block);

}  // namespace umbrage::fuzz
