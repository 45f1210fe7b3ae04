// SPDX-License-Identifier: Apache-2.0
#include "feature/orb.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/error.h"
#include "feature/depth_lookup.h"
#include "feature/keypoint_depth.h"
#include "feature/orb_descriptor.h"
#include "feature/orb_fast.h"
#include "feature/orb_image.h"
#include "feature/orb_select.h"
#include "feature/rolling_shutter.h"
#include "feature/undistortion.h"

namespace rds {
namespace {

// Distance of keypoints from the edges of their level: patch and radius of the blur, and a pixel of rounding.
constexpr int kBorder = kPatchRadius + 3 + 1;

// Dynamic surfaces get few keypoints, and only at coarse levels. No pose is computed from them, but they are needed
// when something comes to rest, or when a network has taken a part of the room for a person.
constexpr std::size_t kFirstMovingLevel = 3;

// Keypoints wanted of each level: falls with the scale, as the perimeter of the image does.
std::vector<std::size_t> FeaturesPerLevel(const OrbOptions& options) {
  double sum = 0;
  for (int i = 0; i < options.levels; ++i) {
    sum += std::pow(options.scale_factor, -i);
  }
  std::vector<std::size_t> wanted;
  double cumulative = 0;
  std::size_t before = 0;
  for (int i = 0; i < options.levels; ++i) {
    cumulative += std::pow(options.scale_factor, -i) / sum;
    const auto end = static_cast<std::size_t>(std::lround(options.features * cumulative));
    wanted.push_back(end - before);
    before = end;
  }
  return wanted;
}

void Undistort(const PinholeCamera& camera, std::vector<Keypoint>& keypoints) {
  if (!camera.HasDistortion() || keypoints.empty()) {
    return;
  }
  std::vector<Eigen::Vector2f> pixels;
  pixels.reserve(keypoints.size());
  for (const Keypoint& keypoint : keypoints) {
    pixels.emplace_back(keypoint.raw_x, keypoint.raw_y);
  }
  UndistortPixels(camera, pixels);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    keypoints[i].x = pixels[i].x();
    keypoints[i].y = pixels[i].y();
  }
}

}  // namespace

struct OrbExtractor::Impl {
  OrbOptions options;
  ScalePyramid pyramid;
  std::vector<std::size_t> features_per_level;
  PatchDescriber describer;

  // Buffers, kept between frames.
  std::vector<GrayPlane> levels;
  std::vector<Shrinker> shrinkers;  // by level; the first is unused
  GrayPlane blurred;
  std::vector<std::uint8_t> blurred_row;
  FastDetector detector;
  CornerSelector selector;
  std::vector<Corner> corners;
  std::vector<Corner> moving_corners;
  std::vector<Corner> boundary_corners;

  explicit Impl(const OrbOptions& options_)
      : options(options_),
        pyramid(options_.levels, options_.scale_factor),
        features_per_level(FeaturesPerLevel(options_)),
        levels(static_cast<std::size_t>(options_.levels)),
        shrinkers(static_cast<std::size_t>(options_.levels)) {}

  void ExtractLevel(std::size_t level, std::span<const SampleMotion> motion, std::vector<Keypoint>& keypoints,
                    std::vector<Descriptor>& descriptors);
  void Select(std::size_t level, std::span<const SampleMotion> motion);
};

// Leaves the corners of a level that become keypoints.
void OrbExtractor::Impl::Select(std::size_t level, std::span<const SampleMotion> motion) {
  const int width = levels[level].width();
  const int height = levels[level].height();
  selector.DropWeak(width, height, static_cast<std::uint8_t>(options.fast_threshold), corners);
  moving_corners.clear();
  boundary_corners.clear();
  if (!motion.empty()) {
    const int columns = levels[0].width() / kDepthGridStep;
    const int rows = levels[0].height() / kDepthGridStep;
    const float cells_per_px = pyramid.scale[level] / kDepthGridStep;
    std::erase_if(corners, [&](const Corner& corner) {
      const int column = std::min(static_cast<int>(static_cast<float>(corner.x) * cells_per_px), columns - 1);
      const int row = std::min(static_cast<int>(static_cast<float>(corner.y) * cells_per_px), rows - 1);
      const SampleMotion here = motion[static_cast<std::size_t>(row * columns + column)];
      if (here != SampleMotion::kNone) {
        (here == SampleMotion::kMoves ? moving_corners : boundary_corners).push_back(corner);
      }
      return here != SampleMotion::kNone;
    });
  }
  const auto spread = [&](double share, std::vector<Corner>& some) {
    const double wanted = share * static_cast<double>(features_per_level[level]);
    selector.Spread(width, height, static_cast<std::size_t>(std::lround(wanted)), some);
  };
  spread(1, corners);
  spread(level < kFirstMovingLevel ? 0 : options.moving_ratio, moving_corners);
  spread(options.boundary_ratio, boundary_corners);
  corners.insert(corners.end(), moving_corners.begin(), moving_corners.end());
  corners.insert(corners.end(), boundary_corners.begin(), boundary_corners.end());
}

void OrbExtractor::Impl::ExtractLevel(std::size_t level, std::span<const SampleMotion> motion,
                                      std::vector<Keypoint>& keypoints, std::vector<Descriptor>& descriptors) {
  const GrayPlane& image = levels[level];
  const int inner_width = image.width() - 2 * kBorder;
  const int inner_height = image.height() - 2 * kBorder;
  if (inner_width < 1 || inner_height < 1) {
    return;
  }
  detector.Detect(image, static_cast<std::uint8_t>(options.min_fast_threshold), kBorder, corners);
  Select(level, motion);
  if (corners.empty()) {
    return;
  }
  Blur(image, blurred, blurred_row);
  const float scale = pyramid.scale[level];
  for (const Corner& corner : corners) {
    const Orientation orientation = OrientationAt(image.Row(corner.y) + corner.x, image.stride());
    Keypoint& keypoint = keypoints.emplace_back();
    keypoint.x = (corner.FineX() + 0.5F) * scale - 0.5F;
    keypoint.y = (corner.FineY() + 0.5F) * scale - 0.5F;
    keypoint.raw_x = keypoint.x;
    keypoint.raw_y = keypoint.y;
    keypoint.angle_deg = orientation.AngleDeg();
    keypoint.octave = static_cast<std::uint8_t>(level);
    descriptors.push_back(describer.Describe(blurred.Row(corner.y) + corner.x, blurred.stride(), orientation));
  }
}

OrbExtractor::OrbExtractor(const OrbOptions& options) {
  Check(options.features >= 0 && options.features * (1 + options.moving_ratio + options.boundary_ratio) <
                                     std::numeric_limits<std::uint16_t>::max(),
        "fewer than 65535 features");
  Check(options.levels > 0 && options.levels <= 255 && options.scale_factor > 1 && options.scale_factor <= 4,
        "a pyramid has levels that shrink, by at most 4");
  Check(options.min_fast_threshold >= 0 && options.min_fast_threshold <= options.fast_threshold &&
            options.fast_threshold <= 255,
        "FAST thresholds are gray values, the minimum not above the other");
  impl_ = std::make_unique<Impl>(options);
}

OrbExtractor::~OrbExtractor() = default;

const ScalePyramid& OrbExtractor::pyramid() const { return impl_->pyramid; }

FrameData OrbExtractor::Extract(const PinholeCamera& camera, const Image8& image, const Image16& depth,
                                std::span<const SampleMotion> motion, const Tangent6& velocity) {
  Check(image.width == camera.width && image.height == camera.height && (image.channels == 1 || image.channels == 3),
        "a gray or BGR image of the camera's size");
  Check(depth.width == camera.width && depth.height == camera.height && depth.channels == 1,
        "a depth image of the camera's size");
  Check(std::max(image.width, image.height) <= std::numeric_limits<std::int16_t>::max(),
        "an image of at most 32767 pixels a side");
  Check(motion.empty() || std::ssize(motion) == (image.width / kDepthGridStep) * (image.height / kDepthGridStep),
        "a mark for each sample of the depth grid");
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  keypoints.reserve(static_cast<std::size_t>(impl_->options.features));
  descriptors.reserve(static_cast<std::size_t>(impl_->options.features));
  ToGray(image, impl_->levels[0]);
  for (std::size_t level = 0; level < impl_->levels.size(); ++level) {
    if (level > 0) {
      const GrayPlane& larger = impl_->levels[level - 1];
      if (std::min(larger.width(), larger.height()) <= 2 * kBorder) {
        break;  // this level and all after it are smaller than a patch
      }
      impl_->shrinkers[level].Shrink(larger, impl_->options.scale_factor, impl_->levels[level]);
    }
    impl_->ExtractLevel(level, motion, keypoints, descriptors);
  }
  Undistort(camera, keypoints);
  const DepthLookup lookup(depth);
  LookUpDepth(camera, lookup, impl_->options.depth_edges, impl_->pyramid, keypoints);
  CorrectRollingShutter(camera, velocity, keypoints);
  return {camera, std::move(keypoints), std::move(descriptors), SampleDepth(camera, lookup)};
}

}  // namespace rds
