// SPDX-License-Identifier: Apache-2.0
// The people of a scenario: who sits where, who walks which way and with whom.
#pragma once

#include <cstdint>
#include <vector>

#include "synth/camera_path.h"
#include "synth/mover.h"
#include "synth/room.h"
#include "synth/synthetic_options.h"

namespace rds::synthetic {

// Plans the people of a scenario for `duration_s` so that the camera sees much of them, nobody walks through furniture
// or another person, and nobody comes nearer to the camera than about half a meter. Walks are planned leg by leg: of
// many places to go to, that one is taken which keeps the walkers in view at the distance that the scenario wants.
std::vector<Mover> PlanMovers(SyntheticScenario scenario, int count, const Room& room, const CameraPath& camera,
                              double duration_s, std::uint64_t seed);

}  // namespace rds::synthetic
