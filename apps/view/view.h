// The viewer: serves the page and draws what it asks for. See messages.h for the messages.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "apps/view/messages.h"
#include "renderer/request.h"

namespace umbrage::view {

/// A file that the page can show.
struct ViewedFile {
  std::string file;  ///< path, or scene:NAME
  bool is_gbuffer = false;
};

struct Settings {
  std::vector<ViewedFile> models = {};  ///< at least one; each is shown alone
  Request request;                      ///< from `given`
  ViewOptions given;                    ///< options of the command line: the first state of a page
  std::string command;                  ///< the command line, as the page shows it
  std::string host = "127.0.0.1";
  int port = 0;                              ///< 0: a free one
  std::vector<std::string> host_names = {};  ///< as in ServerSettings
  bool watch = false;
};

class Viewer {
 public:
  struct Parts;

  /// Starts to serve. Errors: kUsage for options that no picture can have, a host or a port that cannot be used; kFile
  /// for a model that does not exist.
  static Result<std::unique_ptr<Viewer>> start(Settings settings);
  /// Ends all work and closes all pages.
  ~Viewer();
  /// Returns the address of the page. Who knows it can use the viewer.
  std::string address() const;
  /// Writes a file that only the user may read and that leads a browser to the page. Returns its name. Errors: kFile.
  Result<std::string> launcher() const;
  /// Returns what the user should know before the page opens.
  std::vector<std::string> warnings() const;
  /// Returns whether pages were open and all have been closed for a while, longer than a reload takes.
  bool was_left() const;

 private:
  explicit Viewer(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace umbrage::view
