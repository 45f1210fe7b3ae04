// SPDX-License-Identifier: Apache-2.0
#include "synth/room_builder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rds::synthetic {

RoomBuilder::RoomBuilder(std::uint64_t seed, double texel_scale)
    : random_(seed), seed_(seed), texel_scale_(texel_scale) {}

void RoomBuilder::AddPanel(const Eigen::Vector3d& center, const Eigen::Vector3d& normal, const Eigen::Vector3d& up,
                           double width, double height, Painter painter, double texel_m, bool glows) {
  Surface surface;
  surface.quad.right = up.cross(normal).normalized();
  surface.quad.down = -up;
  surface.quad.corner = center - 0.5 * width * surface.quad.right + 0.5 * height * up;
  surface.quad.width = width;
  surface.quad.height = height;
  surface.painter = std::move(painter);
  surface.texel_m = texel_m * texel_scale_;
  surface.glows = glows;
  surfaces_.push_back(std::move(surface));
}

void RoomBuilder::AddBox(const Box& box, const BoxStyle& style, double texel_m) {
  const Eigen::Vector3d& x = box.x_axis;
  const Eigen::Vector3d y(-x.y(), x.x(), 0);
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d& h = box.half_size;
  AddPanel(box.center + h.x() * x, x, z, 2 * h.y(), 2 * h.z(), style.front, texel_m, style.glows);
  if (style.has_back) {
    AddPanel(box.center - h.x() * x, -x, z, 2 * h.y(), 2 * h.z(), style.other, texel_m);
  }
  AddPanel(box.center + h.y() * y, y, z, 2 * h.x(), 2 * h.z(), style.other, texel_m);
  AddPanel(box.center - h.y() * y, -y, z, 2 * h.x(), 2 * h.z(), style.other, texel_m);
  AddPanel(box.center + h.z() * z, z, y, 2 * h.x(), 2 * h.y(), style.top ? style.top : style.other, texel_m);
  if (box.center.z() - h.z() > 0.3) {
    AddPanel(box.center - h.z() * z, -z, y, 2 * h.x(), 2 * h.y(), style.other, texel_m);
  }
  room_.boxes.push_back(box);
}

void RoomBuilder::AddCapsule(Capsule capsule, const Painter& painter) {
  const double around = 2.0 * std::numbers::pi * capsule.axes.col(0).norm();
  const double along = 2.0 * capsule.axes.col(2).norm() * (1.0 + capsule.half_length);
  Random random(seed_ ^ (0xCAB5ULL + 7919 * room_.scene.capsules.size()));
  Canvas canvas(around, along, around / 128.0);
  painter(canvas, random);
  capsule.texture = std::make_shared<Texture>(canvas, true);
  room_.scene.capsules.push_back(std::move(capsule));
}

void RoomBuilder::AddCylinder(const Eigen::Vector3d& bottom, double radius, double height, double rounding,
                              const Painter& painter) {
  Capsule capsule;
  capsule.center = bottom + Eigen::Vector3d(0, 0, 0.5 * height);
  capsule.axes = Eigen::Vector3d(radius, radius, rounding).asDiagonal();
  capsule.half_length = 0.5 * height / rounding - 1.0;
  AddCapsule(std::move(capsule), painter);
}

void RoomBuilder::AddBall(const Eigen::Vector3d& center, double radius, const Painter& painter) {
  Capsule capsule;
  capsule.center = center;
  capsule.axes = radius * Eigen::Matrix3d::Identity();
  AddCapsule(std::move(capsule), painter);
}

Room RoomBuilder::Finish(std::vector<AreaLight> lights) {
  const Lighting lighting(room_.boxes, std::move(lights), {Room::kHalfSize, Room::kHalfSize, Room::kHeight});
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    Surface& surface = surfaces_[i];
    Random random(seed_ * 0x9E3779B97F4A7C15ULL + 0x51ED27ULL * (i + 1));
    Canvas canvas(surface.quad.width, surface.quad.height, surface.texel_m);
    surface.painter(canvas, random);
    if (!surface.glows) {
      lighting.Apply(surface.quad, canvas);
    }
    surface.quad.texture = std::make_shared<Texture>(canvas);
    room_.scene.quads.push_back(surface.quad);
  }
  return std::move(room_);
}

double Room::Clearance(const Eigen::Vector3d& point) const {
  double clearance = std::min(kHalfSize - std::abs(point.x()), kHalfSize - std::abs(point.y()));
  clearance = std::min({clearance, point.z(), kHeight - point.z()});
  for (const Box& box : boxes) {
    clearance = std::min(clearance, box.Distance(point));
  }
  for (const Capsule& capsule : scene.capsules) {
    clearance = std::min(clearance, Distance(capsule, point));
  }
  return std::max(0.0, clearance);
}

double Room::FloorClearance(const Eigen::Vector2d& place) const {
  double clearance = std::min(kHalfSize - std::abs(place.x()), kHalfSize - std::abs(place.y()));
  for (const Box& box : boxes) {
    const double bottom = box.center.z() - box.half_size.z();
    if (bottom < 2.0) {
      clearance = std::min(clearance, box.Distance({place.x(), place.y(), box.center.z()}));
    }
  }
  return std::max(0.0, clearance);
}

}  // namespace rds::synthetic
