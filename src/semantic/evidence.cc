// SPDX-License-Identifier: Apache-2.0
#include "semantic/evidence.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "segmentation/mask.h"

namespace rds {
namespace {

void ObserveLabel(const Keyframe& keyframe, std::uint32_t keypoint, PointId point, MovingProbabilities& probabilities,
                  const MovingProbabilityOptions& options) {
  if (keyframe.IsLabeled() && keyframe.labels[keypoint] != KeypointLabel::kNone) {
    probabilities.Observe(point, keyframe.labels[keypoint] == KeypointLabel::kDynamic, options);
  }
}

}  // namespace

KeypointLabel LabelOfPixel(std::uint8_t pixel) {
  return pixel == kStaticPixel   ? KeypointLabel::kStatic
         : pixel == kUnsurePixel ? KeypointLabel::kNone
                                 : KeypointLabel::kDynamic;
}

std::vector<KeypointLabel> LabelKeypoints(const FrameData& data, const Image8& mask) {
  Check(mask.width == data.camera().width && mask.height == data.camera().height && mask.channels == 1,
        "the mask has the size of the image");
  std::vector<KeypointLabel> labels;
  labels.reserve(data.size());
  for (const Keypoint& keypoint : data.keypoints()) {
    const int x = std::clamp(static_cast<int>(std::lround(keypoint.raw_x)), 0, mask.width - 1);
    const int y = std::clamp(static_cast<int>(std::lround(keypoint.raw_y)), 0, mask.height - 1);
    labels.push_back(LabelOfPixel(mask.At(x, y)));
  }
  return labels;
}

void ApplyLabels(Map& map, KeyframeId id, std::vector<KeypointLabel> labels, MovingProbabilities& probabilities,
                 const MovingProbabilityOptions& options) {
  Keyframe& keyframe = map.At(id);
  Check(!keyframe.IsLabeled(), "a keyframe is labeled once");
  Check(labels.size() == keyframe.points.size(), "a label for each keypoint");
  keyframe.labels = std::move(labels);
  for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
    if (keyframe.points[i].valid()) {
      ObserveLabel(keyframe, static_cast<std::uint32_t>(i), keyframe.points[i], probabilities, options);
    }
  }
}

MapPoint& AddPoint(Map& map, const Eigen::Vector3d& position, KeyframeId keyframe, std::uint32_t keypoint,
                   MovingProbabilities& probabilities, const MovingProbabilityOptions& options) {
  MapPoint& point = map.AddPoint(position, keyframe, keypoint);
  ObserveLabel(map.At(keyframe), keypoint, point.id, probabilities, options);
  return point;
}

bool AddObservation(Map& map, PointId point, KeyframeId keyframe, std::uint32_t keypoint,
                    MovingProbabilities& probabilities, const MovingProbabilityOptions& options) {
  if (!map.AddObservation(point, keyframe, keypoint)) {
    return false;
  }
  ObserveLabel(map.At(keyframe), keypoint, point, probabilities, options);
  return true;
}

void FusePoints(Map& map, PointId from, PointId to, MovingProbabilities& probabilities,
                const MovingProbabilityOptions& options) {
  probabilities.Set(to, FuseProbabilities(probabilities.Get(from), probabilities.Get(to), options));
  map.Fuse(from, to);
}

}  // namespace rds
