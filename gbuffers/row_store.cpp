#include "gbuffers/row_store.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "core/check.h"

namespace umbrage {
namespace {

/// Opens a file without a name. Returns a negative number on failure, with the reason in errno.
int open_unnamed(const std::string& folder) {
  const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0 || (errno != EOPNOTSUPP && errno != EISDIR)) return file;
  // The file system has no unnamed files: the name is removed at once.
  std::string name = folder + "/umbrage-XXXXXX";
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

/// Calls pwrite or pread until all bytes are transferred. Returns 0, or the reason of the failure as in errno.
template <class Transfer, class Bytes>
int transfer_all(const Transfer& transfer, int file, Bytes* bytes, std::size_t count, std::int64_t offset) {
  while (count > 0) {
    const ssize_t done = transfer(file, bytes, count, offset);
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return errno;
    if (done == 0) return EIO;  // beyond the end of the file
    bytes += done;
    count -= std::size_t(done);
    offset += done;
  }
  return 0;
}

}  // namespace

/// In the file one row of all planes follows the other, so that neighbouring rows are read at once.
struct RowStore::State {
  int width = 0, height = 0;
  std::vector<std::string> names;
  Image image;    // if in memory
  int file = -1;  // open file; < 0: in memory
  std::string folder;

  ~State() {
    if (file >= 0) ::close(file);
  }
  std::size_t row_floats() const { return std::size_t(width) * names.size(); }
  std::int64_t offset_of(int row) const { return std::int64_t(row) * std::int64_t(row_floats() * sizeof(float)); }
  Error error(std::string_view what, int cause) const {
    return file_error("the scratch file of {:.1f} GB in folder '{}' cannot be {}: {}", double(offset_of(height)) * 1e-9,
                      folder, what, std::strerror(cause));
  }
  /// Rows that are transferred at once.
  int block_rows() const {
    constexpr std::size_t kBlockFloats = 1 << 20;  // larger blocks are not faster
    return int(std::clamp<std::size_t>(kBlockFloats / std::max<std::size_t>(row_floats(), 1), 1, 1 << 16));
  }
};

RowStore::RowStore(std::unique_ptr<State> state) : state_(std::move(state)) {}
RowStore::RowStore(RowStore&&) noexcept = default;
RowStore& RowStore::operator=(RowStore&&) noexcept = default;
RowStore::~RowStore() = default;

Result<RowStore> RowStore::create(int width, int height, std::vector<std::string> names, double memory,
                                  const std::string& folder) {
  auto state = std::make_unique<State>();
  state->width = width;
  state->height = height;
  state->names = std::move(names);
  state->folder = folder;
  if (double(state->offset_of(height)) <= memory) {
    state->image = Image(width, height);
    for (const std::string& name : state->names) state->image.add(name) = Plane(width, height);
    return RowStore(std::move(state));
  }
  state->file = open_unnamed(folder);
  if (state->file < 0) return state->error("created", errno);
  // Reports a full disk before the picture is decoded. File systems that cannot reserve space report it later.
  if (::fallocate(state->file, 0, 0, state->offset_of(height)) != 0 && (errno == ENOSPC || errno == EDQUOT))
    return state->error("created", errno);
  return RowStore(std::move(state));
}

const std::vector<std::string>& RowStore::names() const { return state_->names; }

bool RowStore::is_in_memory() const { return state_->file < 0; }

const Image* RowStore::whole() const { return is_in_memory() ? &state_->image : nullptr; }

Result<void> RowStore::write(const Image& rows, int first) {
  check_equal(rows.planes.size(), state_->names.size(), "planes of a row store");
  check_equal(rows.width, state_->width, "width of a row store");
  check_less(first + rows.height, state_->height + 1, "rows of a row store");
  const std::size_t width = std::size_t(state_->width);
  if (is_in_memory()) {
    for (std::size_t p = 0; p < rows.planes.size(); ++p)
      for (int y = 0; y < rows.height; ++y)
        std::copy_n(rows.planes[p].row(y), width, state_->image.planes[p].row(first + y));
    return {};
  }
  std::vector<float> block(std::size_t(std::min(state_->block_rows(), rows.height)) * state_->row_floats());
  for (int begin = 0; begin < rows.height; begin += state_->block_rows()) {
    const int end = std::min(begin + state_->block_rows(), rows.height);
    float* to = block.data();
    for (int y = begin; y < end; ++y)
      for (const Plane& plane : rows.planes) to = std::copy_n(plane.row(y), width, to);
    if (const int cause =
            transfer_all(::pwrite, state_->file, reinterpret_cast<const char*>(block.data()),
                         std::size_t(to - block.data()) * sizeof(float), state_->offset_of(first + begin)))
      return state_->error("written", cause);
  }
  return {};
}

Result<Image> RowStore::read(const Rows& rows) const {
  check_less(rows.end, state_->height + 1, "rows of a row store");
  const std::size_t width = std::size_t(state_->width);
  Image image(state_->width, rows.count());
  for (const std::string& name : state_->names) image.add(name) = Plane(image.width, image.height);
  if (is_in_memory()) {
    for (std::size_t p = 0; p < image.planes.size(); ++p)
      for (int y = 0; y < image.height; ++y)
        std::copy_n(state_->image.planes[p].row(rows.begin + y), width, image.planes[p].row(y));
    return image;
  }
  std::vector<float> block(std::size_t(std::min(state_->block_rows(), image.height)) * state_->row_floats());
  for (int begin = 0; begin < image.height; begin += state_->block_rows()) {
    const int end = std::min(begin + state_->block_rows(), image.height);
    if (const int cause = transfer_all(::pread, state_->file, reinterpret_cast<char*>(block.data()),
                                       std::size_t(end - begin) * state_->row_floats() * sizeof(float),
                                       state_->offset_of(rows.begin + begin)))
      return state_->error("read", cause);
    const float* from = block.data();
    for (int y = begin; y < end; ++y)
      for (Plane& plane : image.planes) {
        std::copy_n(from, width, plane.row(y));
        from += width;
      }
  }
  return image;
}

}  // namespace umbrage
