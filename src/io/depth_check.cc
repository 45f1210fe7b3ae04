// SPDX-License-Identifier: Apache-2.0
#include "io/depth_check.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "base/error.h"
#include "base/log.h"
#include "io/camera_plausibility.h"
#include "io/image_io.h"

namespace rds {

void CheckDepthScale(const Dataset& dataset, const PinholeCamera& camera) {
  constexpr std::size_t kStep = 97;  // pixels; shares no factor with usual widths
  std::vector<double> depths_m;
  for (const std::size_t frame : {std::size_t{0}, dataset.size() / 2}) {
    try {
      ImageFile file(dataset.frames().at(frame).depth_path);
      if (file.width() != camera.width || file.height() != camera.height) {
        continue;
      }
      const Image16 depth = file.DecodeDepth(camera.depth_scale);
      for (std::size_t i = 0; i < depth.data.size(); i += kStep) {
        if (depth.data[i] != 0 && depth.data[i] != std::numeric_limits<std::uint16_t>::max()) {
          depths_m.push_back(depth.data[i] / camera.depth_scale);
        }
      }
    } catch (const InputError&) {  // said when the frame is played
    }
  }
  constexpr std::size_t kEnough = 20;
  if (depths_m.size() < kEnough) {
    return;
  }
  std::sort(depths_m.begin(), depths_m.end());
  const double median_m = depths_m[depths_m.size() / 2];
  if (const auto problem = DepthProblem(camera, median_m)) {
    throw InputError(fmt::format("{}: {}; mend the camera file, or add 'unusual: true' to it if that is right",
                                 dataset.folder().string(), *problem));
  }
  // Nearly all depth; stereo cameras in halls see farther, those for small things less, and are only warned.
  constexpr double kFarthest_m = 12;
  constexpr double kNearest_m = 0.8;
  const double far_m = depths_m[depths_m.size() * 95 / 100];
  if (const double likely = LikelyDepthScale(camera, median_m);
      (far_m > kFarthest_m || far_m < kNearest_m) && !camera.unusual && likely != camera.depth_scale) {
    log::warn(
        "{}: all but a twentieth of the depth lies within {:.1f} m; is depth_scale {:g} right? With {:g} it would "
        "be {:.1f} m",
        dataset.folder().string(), far_m, camera.depth_scale, likely, far_m * camera.depth_scale / likely);
  }
}

}  // namespace rds
