// Saving a picture from the viewer: the program runs itself as a child process, `umbrage render` or `umbrage shade`, so
// that the file has the same bytes as one that the user makes on a command line.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/view/messages.h"
#include "apps/view/server.h"

namespace umbrage::view {

/// What is drawn: the words of the command line that name it.
struct SaveSubject {
  std::vector<std::string> words;  ///< models, or a G-buffer with its files
  bool is_gbuffer = false;         ///< then its size is that of the G-buffer
  std::string stem = "picture";    ///< name of the file to download, without extension
};

/// Returns the words of the command, without the program and `-o FILE`. Errors: kUsage for options that `render` (for a
/// G-buffer `shade`) does not have, or that do not describe a picture, such as --output.
Result<std::vector<std::string>> save_words(const SaveSubject& subject, const Save& save);

/// Draws the picture into a new file in `folder`, and returns the answer that sends and removes it. `program`: by
/// default this program. Ends the child process soon after `is_wanted` returns false. Errors, as an answer with status
/// 400: the child's own message.
HttpAnswer save_picture(const SaveSubject& subject, const Save& save, const std::filesystem::path& folder,
                        const std::function<bool()>& is_wanted,
                        const std::filesystem::path& program = "/proc/self/exe");

}  // namespace umbrage::view
