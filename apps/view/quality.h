// What is drawn while something moves, and at rest: settings, and the resolution that is drawn in time.
#pragma once
#include <map>
#include <string>
#include <utility>

#include "apps/view/messages.h"
#include "core/result.h"
#include "renderer/plan.h"
#include "renderer/request.h"

namespace umbrage::view {

/// Time of a moving frame that the resolution is chosen for, ms. With the encoding beside it, the network and the
/// browser this gives 20 frames per second and more.
inline constexpr double kMovingFrame_ms = 32.0;
/// Max time of a picture of full resolution that is drawn before the exact one, ms.
inline constexpr double kQuickFrame_ms = 250.0;

/// Returns the request of a view: its options, its size, and what it shows. Options that are not of a picture, such as
/// the device's, are taken as well. Messages name options as on the command line. `is_gbuffer`: its options are those
/// of the command that shades. Errors: kUsage.
Result<Request> request_of(const View& view, int width, int height, bool is_gbuffer);

/// Returns the request that is drawn while something moves: the draft quality, one sample.
Request moving_request(Request request);

/// Returns whether the request draws the ray-traced reference.
bool is_traced(const Request& request);
/// Returns whether the reference is drawn as the mean of pictures of few rays: if the user set neither the rays nor
/// the number of pictures nor the quality.
bool averages_few_rays(const Request& request);
/// Returns the request with few rays per pixel for the reference, and one sample, so that it takes about a second.
Request with_few_rays(Request request);

/// Number of pictures that are averaged first where the look draws one: their sample positions are balanced.
inline constexpr int kFirstAveraged = 4;
/// Returns whether a picture that is drawn once gets averaged at rest: if the user left the number of pictures to the
/// look. This changes edges and noise alone.
bool gets_averaged(const Request& request, bool is_gbuffer);

/// Leaves out of the plan of a moving picture what takes long: soft shadows.
void simplify_moving(Plan& plan);

/// Chooses the resolution of moving frames from the times of those before, separately for each key.
class ResolutionControl {
 public:
  /// Returns the size of the next frame, at most the given one: multiples of 8 unless it is full size.
  std::pair<int, int> size(const std::string& key, int width, int height);
  /// Takes the time of a frame of this size.
  void add(const std::string& key, int width, int height, double ms);
  /// Returns the expected time of a frame of this size, ms; 0: unknown.
  double expected_ms(const std::string& key, int width, int height) const;

 private:
  struct Known {
    double ms_per_pixel = 0.0;  ///< 0: nothing was measured
    double pixels = 0.0;        ///< current number of pixels
  };
  std::map<std::string, Known> known_;
};

}  // namespace umbrage::view
