// SPDX-License-Identifier: Apache-2.0
#include "synth/person.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "synth/paint.h"

namespace rds::synthetic {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

template <typename Paint>
std::shared_ptr<const Texture> Wrap(double around_m, double along_m, const Paint& paint) {
  Canvas canvas(around_m, along_m, around_m / 256.0);
  paint(canvas);
  return std::make_shared<Texture>(canvas, true);
}

}  // namespace

// Angles in radians; limbs: 0 = left, 1 = right. Positive thigh and arm angles point forward, positive knee and elbow
// bend.
struct Person::Pose {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double heading = 0;
  double hip_height = 0.93;  // for size 1
  double lean = 0;           // of the torso, forward
  double twist = 0;          // of the head, to the left
  std::array<double, 2> thigh{}, knee{}, arm{}, elbow{};
  std::array<double, 2> spread{0.12, 0.12};  // of the arms from the body
};

Person::Person(std::uint64_t seed) {
  Random random(seed);
  size_ = random.Uniform(0.93, 1.06);
  for (double& phase : phases_) {
    phase = random.Uniform(0, kTurn);
  }
  const float tan = static_cast<float>(random.Uniform(0.55, 1.0));
  const Color skin = tan * Color{165, 190, 232};
  constexpr std::array<Color, 4> kHair{{{60, 100, 140}, {34, 38, 46}, {40, 58, 86}, {110, 150, 176}}};
  const Color hair = kHair[random.Index(kHair.size())];
  // Shirt and sleeves are cut from the same cloth: same seed, other size.
  const std::uint64_t cloth = random.Bits();
  const auto with_cloth = [&](Canvas& canvas) {
    Random own(cloth);
    PaintShirt(canvas, own);
  };
  shirt_ = Wrap(1.0, 0.62, with_cloth);
  sleeve_ = Wrap(0.32, 0.38, with_cloth);
  trousers_ = Wrap(0.45, 0.55, [&](Canvas& canvas) { PaintDenim(canvas, random); });
  skin_ = Wrap(0.28, 0.3, [&](Canvas& canvas) { PaintSkin(canvas, random, skin); });
  face_ = Wrap(0.55, 0.26, [&](Canvas& canvas) { PaintFace(canvas, random, skin); });
  hair_ = Wrap(0.55, 0.26, [&](Canvas& canvas) {
    canvas.Fill(hair);
    canvas.Noise(random.Bits(), 0.01, 0.08, 3, 0.5);
  });
  const Color leather = RandomColor(random, 0.2, 0.7, 0.15, 0.7);
  shoe_ = Wrap(0.3, 0.3, [&](Canvas& canvas) { PaintFabric(canvas, random, leather); });
}

double Person::Sway(std::size_t which, double period_s, double time_s) const {
  const double phase = phases_[which % phases_.size()];
  return 0.7 * std::sin(kTurn * time_s / period_s + phase) +
         0.3 * std::sin(2.3 * kTurn * time_s / period_s + 3 * phase);
}

std::vector<Capsule> Person::Build(const Pose& pose) const {
  const double k = size_;
  const Eigen::Vector3d forward(std::cos(pose.heading), std::sin(pose.heading), 0);
  const Eigen::Vector3d left(-forward.y(), forward.x(), 0);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d hips(pose.position.x(), pose.position.y(), k * pose.hip_height);
  const Eigen::Vector3d spine = std::cos(pose.lean) * up + std::sin(pose.lean) * forward;
  const Eigen::Vector3d chest = std::cos(pose.lean) * forward - std::sin(pose.lean) * up;
  std::vector<Capsule> body;
  const auto limb = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& side, double r_side,
                        double r_other, const std::shared_ptr<const Texture>& texture) {
    body.push_back(MakeLimb(a, b, side, k * r_side, k * r_other, texture));
    body.back().is_mover = true;
  };
  limb(hips + k * 0.42 * spine, hips + k * 0.1 * spine, chest, 0.115, 0.19, shirt_);
  limb(hips + k * 0.05 * spine, hips - 0.02 * k * up, chest, 0.118, 0.165, trousers_);
  const Eigen::Vector3d neck = hips + k * 0.53 * spine;
  limb(neck + k * 0.06 * spine, neck - k * 0.04 * spine, chest, 0.052, 0.052, skin_);
  const Eigen::Vector3d gaze = std::cos(pose.twist) * chest + std::sin(pose.twist) * left;
  const Eigen::Vector3d head = neck + k * (0.155 * spine + 0.015 * gaze);
  limb(head + 0.02 * k * spine, head - 0.02 * k * spine, gaze, 0.1, 0.077, face_);
  const Eigen::Vector3d scalp = head + k * (0.028 * spine - 0.026 * gaze);
  limb(scalp + 0.025 * k * spine, scalp - 0.025 * k * spine, gaze, 0.098, 0.086, hair_);
  for (std::size_t i = 0; i < 2; ++i) {
    const double sign = i == 0 ? 1.0 : -1.0;
    const auto down = [&](double angle) -> Eigen::Vector3d { return std::sin(angle) * forward - std::cos(angle) * up; };
    const Eigen::Vector3d hip = hips + k * 0.095 * sign * left;
    const Eigen::Vector3d knee = hip + k * 0.42 * down(pose.thigh[i]);
    const Eigen::Vector3d ankle = knee + k * 0.42 * down(pose.thigh[i] - pose.knee[i]);
    const Eigen::Vector3d toward_toe = down(pose.thigh[i] - pose.knee[i]).cross(left);
    limb(hip, knee, forward + 0.2 * up, 0.085, 0.08, trousers_);
    limb(knee, ankle, forward + 0.2 * up, 0.062, 0.058, trousers_);
    limb(ankle - k * 0.01 * toward_toe, ankle + k * 0.15 * toward_toe, left, 0.045, 0.045, shoe_);
    const Eigen::Vector3d shoulder = hips + k * (0.44 * spine + 0.2 * sign * left);
    const auto hang = [&](double angle) -> Eigen::Vector3d {
      return (std::sin(angle) * chest - std::cos(angle) * spine + pose.spread[i] * sign * left).normalized();
    };
    const Eigen::Vector3d elbow = shoulder + k * 0.28 * hang(pose.arm[i]);
    const Eigen::Vector3d wrist = elbow + k * 0.25 * hang(pose.arm[i] + pose.elbow[i]);
    limb(shoulder, elbow, chest, 0.056, 0.056, sleeve_);
    limb(elbow, wrist, chest, 0.042, 0.042, skin_);
    limb(wrist, wrist + k * 0.07 * hang(pose.arm[i] + pose.elbow[i]), chest, 0.042, 0.03, skin_);
  }
  return body;
}

std::vector<Capsule> Person::Walking(const Stance& stance, double time_s) const {
  Pose pose;
  pose.position = stance.position;
  pose.heading = stance.heading;
  const double phase = kTurn * stance.distance_m / (1.35 * size_);
  const double effort = stance.effort;
  for (std::size_t i = 0; i < 2; ++i) {
    const double leg = phase + (i == 0 ? 0.0 : std::numbers::pi);
    pose.thigh[i] = effort * (0.42 * std::sin(leg) + 0.08);
    pose.knee[i] = effort * (0.12 + 0.75 * std::max(0.0, std::cos(leg)));
    pose.arm[i] = -effort * 0.45 * std::sin(leg) + 0.08 * Sway(i, 3.1, time_s);
    pose.elbow[i] = 0.25 + 0.25 * effort + 0.1 * Sway(i + 2, 2.7, time_s);
  }
  pose.hip_height = 0.9 - 0.03 * effort * (1.0 + std::cos(2.0 * phase)) * 0.5;
  pose.lean = 0.04 + 0.05 * effort;
  pose.twist = 0.4 * Sway(4, 4.3, time_s);
  return Build(pose);
}

std::vector<Capsule> Person::Sitting(const Eigen::Vector2d& position, double heading, double time_s) const {
  Pose pose;
  const double nod = Sway(5, 3.4, time_s);
  pose.position = position;
  pose.heading = heading + 0.12 * Sway(11, 5.3, time_s);
  pose.hip_height = 0.56;
  pose.lean = 0.06 + 0.13 * Sway(6, 4.7, time_s) + 0.05 * nod;
  pose.twist = 0.7 * Sway(7, 3.9, time_s);
  for (std::size_t i = 0; i < 2; ++i) {
    pose.thigh[i] = 1.5 + 0.03 * Sway(i, 2.2, time_s);
    pose.knee[i] = 1.45 + 0.12 * Sway(i + 2, 2.9, time_s);
    const double raised = std::max(0.0, Sway(8 + i, 5.1, time_s));
    pose.arm[i] = 0.35 + 0.9 * raised;
    pose.elbow[i] = 1.0 + 0.5 * Sway(i + 4, 1.7, time_s) + 0.4 * raised;
    pose.spread[i] = 0.18 + 0.1 * Sway(i + 9, 2.3, time_s);
  }
  return Build(pose);
}

}  // namespace rds::synthetic
