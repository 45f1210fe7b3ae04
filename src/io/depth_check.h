// SPDX-License-Identifier: Apache-2.0
// Whether depth images and the camera file speak of the same unit.
#pragma once

#include "io/dataset.h"

namespace rds {

// Looks at a few depth images of the sequence; InputError if their median is what no RGB-D camera sees (DepthProblem),
// with the depth_scale that was likely meant; a warning if much of it is far away. Images that cannot be read, or have
// no depth, say nothing here.
void CheckDepthScale(const Dataset& dataset, const PinholeCamera& camera);

}  // namespace rds
