// SPDX-License-Identifier: Apache-2.0
// Named sets of options.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "system/options.h"

namespace rds {

// "paper": what RDS-SLAM's paper has, without what this system adds to it: its use of unknown points (Algorithm 2),
// local bundle adjustment of labeled keyframes (section VI-B); no propagation of labels, no free space, no motion
// segmentation, no prior on poses, nothing tracked again. Keyframes are chosen as ORB-SLAM3 does, as the paper says;
// by the numbers that it gives for that (section II-A1) there would be too few where people hide the room.
[[nodiscard]] std::vector<std::string> PresetNames();

// Sets the options of a preset; leaves the others. InputError naming the presets if there is none of that name.
void ApplyPreset(Options& options, std::string_view name);

}  // namespace rds
