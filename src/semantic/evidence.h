// SPDX-License-Identifier: Apache-2.0
// Links between masks and map points: which points a label speaks of, and what it says.
#pragma once

#include "base/image.h"
#include "map/map.h"
#include "map/moving_probability.h"

namespace rds {

// What a pixel of a mask says.
[[nodiscard]] KeypointLabel LabelOfPixel(std::uint8_t pixel);

// Labels of keypoints under a dilated mask of the recorded image's size; none where it is unsure.
[[nodiscard]] std::vector<KeypointLabel> LabelKeypoints(const FrameData& data, const Image8& mask);

// Map operations that carry the moving probability along. All need the lock of the map.

// Stores the labels and takes one Bayes step for each point that the keyframe sees. Throws InvariantError if the
// keyframe is labeled already: the same evidence must not count twice.
void ApplyLabels(Map& map, KeyframeId keyframe, std::vector<KeypointLabel> labels, MovingProbabilities& probabilities,
                 const MovingProbabilityOptions& options);

// Map::AddPoint; the new point starts from what the keyframe's label says of it.
MapPoint& AddPoint(Map& map, const Eigen::Vector3d& position, KeyframeId keyframe, std::uint32_t keypoint,
                   MovingProbabilities& probabilities, const MovingProbabilityOptions& options);

// Map::AddObservation; a label that the keyframe has counts as evidence for its new point.
bool AddObservation(Map& map, PointId point, KeyframeId keyframe, std::uint32_t keypoint,
                    MovingProbabilities& probabilities, const MovingProbabilityOptions& options);

// Map::Fuse; the evidence on both points is joined.
void FusePoints(Map& map, PointId from, PointId to, MovingProbabilities& probabilities,
                const MovingProbabilityOptions& options);

}  // namespace rds
