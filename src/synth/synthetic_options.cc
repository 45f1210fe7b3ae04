// SPDX-License-Identifier: Apache-2.0
#include "synth/synthetic_options.h"

#include <array>
#include <utility>

#include "base/error.h"

namespace rds {
namespace {

constexpr std::array<std::pair<SyntheticScenario, std::string_view>, 7> kScenarios{{
    {SyntheticScenario::kStatic, "static"},
    {SyntheticScenario::kWalking, "walking"},
    {SyntheticScenario::kSitting, "sitting"},
    {SyntheticScenario::kCrowd, "crowd"},
    {SyntheticScenario::kCarried, "carried"},
    {SyntheticScenario::kCrossing, "crossing"},
    {SyntheticScenario::kBuilding, "building"},
}};

constexpr std::array<std::pair<SyntheticPath, std::string_view>, 8> kPaths{{
    {SyntheticPath::kOrbit, "orbit"},
    {SyntheticPath::kLoop, "loop"},
    {SyntheticPath::kXyz, "xyz"},
    {SyntheticPath::kRpy, "rpy"},
    {SyntheticPath::kHalfsphere, "halfsphere"},
    {SyntheticPath::kStatic, "static"},
    {SyntheticPath::kRing, "ring"},
    {SyntheticPath::kRingBack, "ring_back"},
}};

template <typename Table>
std::vector<std::string> Names(const Table& table) {
  std::vector<std::string> names;
  for (const auto& [value, name] : table) {
    names.emplace_back(name);
  }
  return names;
}

template <typename Table>
auto Parse(const Table& table, std::string_view name, const char* what) {
  std::string known;
  for (const auto& [value, its_name] : table) {
    if (its_name == name) {
      return value;
    }
    known += (known.empty() ? "" : ", ") + std::string(its_name);
  }
  throw InputError("unknown " + std::string(what) + " '" + std::string(name) + "'; there are: " + known);
}

template <typename Table, typename Value>
std::string_view Find(const Table& table, Value value) {
  for (const auto& [its_value, name] : table) {
    if (its_value == value) {
      return name;
    }
  }
  throw InvariantError("value without a name");
}

}  // namespace

PinholeCamera MakeSyntheticCamera(int width, int height) {
  PinholeCamera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 525.0 * width / 640.0;
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  camera.baseline_m = 0.075;
  return camera;
}

std::string_view NameOf(SyntheticScenario scenario) { return Find(kScenarios, scenario); }
std::string_view NameOf(SyntheticPath path) { return Find(kPaths, path); }
SyntheticScenario ParseSyntheticScenario(std::string_view name) { return Parse(kScenarios, name, "scenario"); }
SyntheticPath ParseSyntheticPath(std::string_view name) { return Parse(kPaths, name, "path"); }
std::vector<std::string> SyntheticScenarioNames() { return Names(kScenarios); }
std::vector<std::string> SyntheticPathNames() { return Names(kPaths); }

int ResolveMovers(const SyntheticOptions& options) {
  Validate(options);
  if (options.movers >= 0) {
    return options.movers;
  }
  switch (options.scenario) {
    case SyntheticScenario::kWalking:
      return 3;
    case SyntheticScenario::kStatic:
    case SyntheticScenario::kCarried:
      return 0;
    case SyntheticScenario::kBuilding:
      return 4;
    case SyntheticScenario::kCrowd:
      return 6;
    case SyntheticScenario::kSitting:
      return 3;
    default:
      return 2;
  }
}

void Validate(const SyntheticOptions& options) {
  const PinholeCamera& camera = options.camera;
  if (camera.width < 32 || camera.height < 24 || camera.width > 4096 || camera.height > 4096) {
    throw InputError("synthetic camera: size " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                     " is out of range (32x24 to 4096x4096)");
  }
  if (camera.fx <= 0 || camera.fy <= 0 || camera.depth_scale <= 0 || camera.HasDistortion()) {
    throw InputError("synthetic camera: focal lengths and depth scale must be positive, distortion zero");
  }
  if (options.frames < 1 || options.frames > 100000) {
    throw InputError("frames: " + std::to_string(options.frames) + " is out of range (1 to 100000)");
  }
  if (options.movers < -1 || options.movers > kMaxSyntheticMovers) {
    throw InputError("movers: " + std::to_string(options.movers) + " is out of range (0 to " +
                     std::to_string(kMaxSyntheticMovers) + ")");
  }
  if (!(options.depth_error >= 0 && options.depth_error <= 0.1)) {
    throw InputError("depth error: " + std::to_string(options.depth_error) + " is out of range (0 to 0.1)");
  }
  const bool is_ring = options.path == SyntheticPath::kRing || options.path == SyntheticPath::kRingBack;
  if (is_ring != (options.scenario == SyntheticScenario::kBuilding)) {
    throw InputError("the paths ring and ring_back are those of the scenario 'building', and the only ones there");
  }
  if (options.alike && options.scenario != SyntheticScenario::kBuilding) {
    throw InputError("alike: only the scenario 'building' has rooms that can look the same");
  }
  if (options.decor != 0 && options.scenario != SyntheticScenario::kBuilding) {
    throw InputError("decor: only the scenario 'building' can be decorated anew");
  }
  const bool has_people =
      options.scenario != SyntheticScenario::kStatic && options.scenario != SyntheticScenario::kCarried;
  if (!has_people && options.movers > 0) {
    throw InputError("movers: the scenario '" + std::string(NameOf(options.scenario)) +
                     "' has none; take another scenario, such as 'walking'");
  }
}

}  // namespace rds
