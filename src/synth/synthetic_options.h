// SPDX-License-Identifier: Apache-2.0
// What a synthetic world shows and how its camera moves.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/camera.h"

namespace rds {

enum class SyntheticScenario : std::uint8_t {
  kStatic,    // nobody
  kWalking,   // three people stand and stroll together, about 1 m in front of the camera
  kSitting,   // people sit on chairs and fidget
  kCrowd,     // many: three in four walk, the rest sit
  kCarried,   // nobody in view, but a printed board is carried before the camera: no network knows it
  kCrossing,  // people cross the view close to the camera, .8 to 1.4 m
  kBuilding,  // a ring of corridors with rooms, 61 m once round, where people walk; on the ring's paths only
};

enum class SyntheticPath : std::uint8_t {
  kOrbit,       // once around the table in the middle, looking at it (34 s a round)
  kLoop,        // a small circle, looking outwards: sees the whole room (15 s a round)
  kXyz,         // to and fro along the three axes, orientation kept
  kRpy,         // turning about the three axes, place kept
  kHalfsphere,  // on a half sphere about the table
  kStatic,      // held still
  kRing,        // round the building: 77 s a round
  kRingBack,    // the other way round, on the other side of the corridor
};

// TUM-like camera: 525 px focal length at 640 x 480, scaled with the width. No distortion. Width and height > 0.
PinholeCamera MakeSyntheticCamera(int width = 640, int height = 480);

struct SyntheticOptions {
  PinholeCamera camera = MakeSyntheticCamera();  // distortion must be zero
  SyntheticScenario scenario = SyntheticScenario::kWalking;
  SyntheticPath path = SyntheticPath::kOrbit;
  int frames = 300;  // >= 1, at 30 Hz
  std::uint64_t seed = 1;
  bool noise = true;        // sensor noise of color and depth; without, both are exact at any range
  int movers = -1;          // 0 to 12; -1: as many as the scenario has of itself
  bool alike = false;       // kBuilding: all rooms and doors look the same
  std::uint64_t decor = 0;  // kBuilding: pictures and furniture; the rest follows from the seed
  double depth_error = 0;   // the depth of each frame is off by a factor 1 + N(0, depth_error); 0 to 0.1
};

inline constexpr int kMaxSyntheticMovers = 12;
inline constexpr double kSyntheticFrameRateHz = 30.0;

// Names as the command line has them, such as "walking" and "halfsphere". Parse throws InputError listing what there
// is.
std::string_view NameOf(SyntheticScenario scenario);
std::string_view NameOf(SyntheticPath path);
SyntheticScenario ParseSyntheticScenario(std::string_view name);
SyntheticPath ParseSyntheticPath(std::string_view name);
std::vector<std::string> SyntheticScenarioNames();
std::vector<std::string> SyntheticPathNames();

// Movers that the options ask for, with -1 resolved. Throws InputError for options out of range.
int ResolveMovers(const SyntheticOptions& options);
void Validate(const SyntheticOptions& options);

}  // namespace rds
