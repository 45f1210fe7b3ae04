// SPDX-License-Identifier: Apache-2.0
#include "tracking/data_association.h"

#include <algorithm>

namespace rds {
namespace {

// Weight by the number of observations: a point on something that moves is created again and again, and few keyframes
// observe it.
double ObservationWeight(const LocalMap& map, std::uint32_t point, const AssociationOptions& options) {
  return std::min<int>(map.observations[point], options.min_observations) /
         static_cast<double>(options.min_observations);
}

// Scales the weights so that the best match has weight 1.
void ScaleToOne(std::vector<PointMatch>& matches) {
  double most = 0;
  for (const PointMatch& match : matches) {
    most = std::max(most, match.weight);
  }
  for (PointMatch& match : matches) {
    match.weight /= most;
  }
}

}  // namespace

Association SelectMatches(std::span<const PointMatch> matches, const LocalMap& map,
                          const MovingProbabilities& probabilities, const KeypointProbabilities* propagated,
                          const AssociationOptions& options) {
  Association result;
  if (!options.use_semantics) {
    result.used.assign(matches.begin(), matches.end());
    return result;
  }
  result.used.reserve(matches.size());
  std::vector<PointMatch> unknown;
  for (PointMatch match : matches) {
    double p = probabilities.Get(map.ids[match.point]);
    if (propagated != nullptr && StateOf(p, probabilities.options()) == PointState::kUnknown) {
      p = (*propagated)[match.keypoint];
    }
    match.state = StateOf(p, probabilities.options());
    match.weight = (1.0 - p) * ObservationWeight(map, match.point, options);
    switch (match.state) {
      case PointState::kStatic:
        result.used.push_back(match);
        break;
      case PointState::kUnknown:
        unknown.push_back(match);
        break;
      case PointState::kDynamic:
        result.dynamic.push_back(match);
        break;
    }
  }
  result.static_count = static_cast<int>(result.used.size());
  // Algorithm 2, with tau; where unknown ones are gated, static ones may be fewer and still lead.
  const int enough =
      options.unknown == UnknownPoints::kDeferred ? std::min(options.tau, options.min_static_matches) : options.tau;
  if (result.static_count < enough || options.unknown == UnknownPoints::kAlways) {
    result.used.insert(result.used.end(), unknown.begin(), unknown.end());
  } else {
    result.deferred = std::move(unknown);
  }
  ScaleToOne(result.used);
  return result;
}

}  // namespace rds
