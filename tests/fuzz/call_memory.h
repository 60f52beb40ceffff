// What calls.cpp hands over: choices made by bytes, and images in blocks of memory that end where they end.
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

/// Prints the sentence and aborts unless it holds.
void demand(bool holds, const std::string& sentence);

/// Choices that bytes make. Once they are used up all are the first one.
class Choices {
 public:
  explicit Choices(std::string_view bytes) : bytes_(bytes) {}
  bool used_up() const { return at_ >= bytes_.size(); }
  /// Below `end`, which is above 0.
  unsigned below(unsigned end);
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

/// Bytes of the heap, which begin at any address.
class Block {
 public:
  /// `skewed`: so many bytes are left free before the first one.
  explicit Block(std::size_t size, std::size_t skewed = 0);
  std::byte* data() { return bytes_.get() + skewed_; }
  std::size_t size() const { return size_; }
  std::size_t skewed() const { return skewed_; }
  void fill(std::byte with);

 private:
  std::unique_ptr<std::byte[]> bytes_;
  std::size_t size_, skewed_;
};
using BlockPtr = std::shared_ptr<Block>;

/// An image and where its pixels are; without a block it has none.
struct Pixels {
  UmbImage image{};
  BlockPtr block;
};
/// By the name under which they were handed over.
using NamedPixels = std::map<std::string, Pixels>;

std::size_t bytes_of(int type);

/// An image of that size that is sound: of any layout that the header allows, with values of all kinds.
Pixels sound_image(Choices& choose, int type, int width, int height, int channels);
/// A plane of floats that are distances, most of them.
Pixels depth_image(Choices& choose, int width, int height);

/// Fills the block with bytes that no picture is made of: floats and ids of them are none.
void put_canaries(Pixels& pixels, std::byte with);
inline constexpr std::byte kCanary{0xfe}, kOtherCanary{0xfd};

/// Numbers of the image of which all bytes are that one.
std::vector<std::size_t> numbers_of(const Pixels& pixels, std::byte canary);
/// Whether those bytes of a block that belong to none of the images are all that one.
bool is_whole_beside(const NamedPixels& images, const BlockPtr& block, std::byte canary);
/// Whether all of the block's bytes are that one.
bool is_untouched(Block& block, std::byte canary);
/// A number that changes with each byte.
std::uint64_t hash_of(Block& block);

}  // namespace umbrage::fuzz
