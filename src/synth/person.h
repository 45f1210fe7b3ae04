// SPDX-License-Identifier: Apache-2.0
// People made of capsules: walking and sitting bodies with clothes.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "synth/scene.h"

namespace rds::synthetic {

// Where a body stands and how far its gait has come.
struct Stance {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // of the hips, on the floor plan
  double heading = 0;                                  // radians from x to y
  double distance_m = 0;                               // walked so far: the phase of the gait
  double effort = 0;                                   // 0 stands, 1 walks
};

// A person of the seed's size, clothes and temperament. Immutable.
class Person {
 public:
  explicit Person(std::uint64_t seed);

  [[nodiscard]] std::vector<Capsule> Walking(const Stance& stance, double time_s) const;
  // On a seat .46 m high: leans, gestures and looks about.
  [[nodiscard]] std::vector<Capsule> Sitting(const Eigen::Vector2d& position, double heading, double time_s) const;

 private:
  struct Pose;
  [[nodiscard]] std::vector<Capsule> Build(const Pose& pose) const;
  // Fidgeting: a smooth value in about [-1, 1].
  [[nodiscard]] double Sway(std::size_t which, double period_s, double time_s) const;

  double size_ = 1;  // 1 = 1.75 m tall
  std::array<double, 12> phases_{};
  std::shared_ptr<const Texture> shirt_, trousers_, sleeve_, skin_, face_, hair_, shoe_;
};

}  // namespace rds::synthetic
