// RowStore: the stored channels of a picture, with random access to rows: in memory, or in an unnamed scratch file.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/result.h"
#include "core/strip.h"

namespace umbrage {

/// Rows of named planes. They are written once, in any order, and then read; reads may run on several threads. The
/// scratch file has no name: it disappears with the store, and if the process ends.
class RowStore {
 public:
  /// Creates a store, in memory if the planes need at most `memory` bytes, else in a file in `folder`. The space of the
  /// file is reserved at once. Errors: kFile if the file cannot be created or the disk is too small.
  static Result<RowStore> create(int width, int height, std::vector<std::string> names, double memory,
                                 const std::string& folder);
  RowStore(RowStore&&) noexcept;
  RowStore& operator=(RowStore&&) noexcept;
  ~RowStore();

  const std::vector<std::string>& names() const;
  bool is_in_memory() const;
  /// Stores rows that start at row `first`. `rows` has the planes of names(), in that order. Errors: kFile, for a full
  /// disk.
  Result<void> write(const Image& rows, int first);
  /// Returns these rows of all planes. Rows that were not written are undefined. Errors: kFile.
  Result<Image> read(const Rows& rows) const;
  /// Returns the whole planes if they are in memory, else null.
  const Image* whole() const;

 private:
  struct State;
  explicit RowStore(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace umbrage
