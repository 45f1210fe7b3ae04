// SPDX-License-Identifier: Apache-2.0
#include "synth/building.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "synth/paint.h"
#include "synth/room_builder.h"

namespace rds::synthetic {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHalfX = 9;  // of the rectangle along the corridors' middle
constexpr double kHalfY = 7;
constexpr double kHalfWidth = 1.1;  // of a corridor
constexpr double kHeight = Room::kHeight;
constexpr double kCorner = 1.2;  // radius of the way
constexpr double kRoomWidth = 3.2;
constexpr double kRoomDepth = 2.6;
constexpr double kPlain_m = 3;  // length of the stretch without texture
constexpr double kSpeed_m_s = 0.8;
constexpr double kTexel_m = 0.006;

const Eigen::Vector3d kUpward = Eigen::Vector3d::UnitZ();

// One side of the ring: from its middle, `along` runs counterclockwise, `out` away from the middle of the building.
struct Side {
  Eigen::Vector3d out;
  double half_length;  // of the corridors' middle, corner to corner
  double distance;     // of the corridor's middle from that of the building
  [[nodiscard]] Eigen::Vector3d Along() const { return kUpward.cross(out); }
  [[nodiscard]] Eigen::Vector3d At(double along, double off, double up) const {
    return along * Along() + (distance + off) * out + up * kUpward;
  }
};

const std::array<Side, 4> kSides = {{{{1, 0, 0}, kHalfY, kHalfX},
                                     {{0, 1, 0}, kHalfX, kHalfY},
                                     {{-1, 0, 0}, kHalfY, kHalfX},
                                     {{0, -1, 0}, kHalfX, kHalfY}}};

// Paints with random numbers of its own, so that the same seed gives the same picture anywhere.
Painter Seeded(Painter painter, std::uint64_t seed) {
  return [painter = std::move(painter), seed](Canvas& canvas, Random& /*random*/) {
    Random own(seed);
    painter(canvas, own);
  };
}

class Builder {
 public:
  Builder(std::uint64_t seed, const BuildingLook& look, double texel_scale)
      : builder_(seed, texel_scale), random_(seed ^ 0xB11D1E6ULL), look_(look) {}

  Room Build() {
    for (std::size_t side = 0; side < kSides.size(); ++side) {
      BuildSide(side);
    }
    BuildFloors();
    return builder_.Finish({});
  }

 private:
  // Unlit: what counts is what is painted. Two of the same seed look the same.
  void Panel(const Eigen::Vector3d& center, const Eigen::Vector3d& normal, double width, double height, Painter painter,
             std::uint64_t seed, const Eigen::Vector3d& up = kUpward, double texel_m = kTexel_m) {
    builder_.AddPanel(center, normal, up, width, height, Seeded(std::move(painter), seed), texel_m, true);
  }
  void Box(const Eigen::Vector3d& center, const Eigen::Vector3d& out, const Eigen::Vector3d& half, Painter front,
           std::uint64_t seed) {
    const Eigen::Vector3d x = -out;
    const Eigen::Vector3d y(-x.y(), x.x(), 0);
    Panel(center + half.x() * x, x, 2 * half.y(), 2 * half.z(), front, seed);
    Panel(center + half.y() * y, y, 2 * half.x(), 2 * half.z(), front, seed + 1);
    Panel(center - half.y() * y, -y, 2 * half.x(), 2 * half.z(), front, seed + 2);
    Panel(center + half.z() * kUpward, kUpward, 2 * half.x(), 2 * half.y(), front, seed + 3, y);
  }

  // A piece of wall with pictures.
  void Wall(const Eigen::Vector3d& center, const Eigen::Vector3d& normal, double width, bool plain) {
    const std::uint64_t seed = random_.Bits();
    const auto tint = static_cast<float>(random_.Uniform(-18, 18));
    const Color color{190 + tint, 200 + 0.5F * tint, 205};
    if (plain) {
      Panel(
          center, normal, width, kHeight,
          [](Canvas& canvas, Random&) {
            canvas.Fill({200, 204, 206});
          },
          1);
      return;
    }
    if (random_.Index(2) == 0) {
      Panel(
          center, normal, width, kHeight,
          [color](Canvas& canvas, Random& random) { PaintPlaster(canvas, random, color); }, seed);
    } else {
      Panel(
          center, normal, width, kHeight,
          [color](Canvas& canvas, Random& random) { PaintWallpaper(canvas, random, color); }, seed);
    }
    const Eigen::Vector3d right = kUpward.cross(normal);
    for (double at = -0.5 * width + 0.5; at < 0.5 * width - 0.4; at += random_.Uniform(0.7, 1.3)) {
      const double size = random_.Uniform(0.3, 0.6);
      const double up = random_.Uniform(0.9, 1.9) - 0.5 * kHeight;
      Panel(center + at * right + up * kUpward + 0.012 * normal, normal, size, size * random_.Uniform(0.8, 1.4),
            PaintPoster, Decorated(random_.Bits()), kUpward, 0.003);
    }
  }

  [[nodiscard]] std::uint64_t Decorated(std::uint64_t seed) const {
    return seed ^ (look_.decor * 0x9E3779B97F4A7C15ULL);
  }

  // A room that opens to the corridor on the outside of it.
  void BuildRoom(const Side& side, double along, std::uint64_t seed) {
    Random look(seed);
    const double near = kHalfWidth;
    const double far = kHalfWidth + kRoomDepth;
    const auto bookshelf = [](Canvas& canvas, Random& random) { PaintBookshelf(canvas, random, {92, 136, 178}, 0.36); };
    const auto cabinet = [](Canvas& canvas, Random& random) { PaintCabinet(canvas, random, {128, 126, 122}, 2, 3); };
    const auto paper = [](Canvas& canvas, Random& random) { PaintPaperwork(canvas, random, {58, 82, 118}); };
    const auto wallpaper = [](Canvas& canvas, Random& random) { PaintWallpaper(canvas, random, {198, 186, 166}); };
    const Eigen::Vector3d a = side.Along();
    Panel(side.At(along, far, 0.5 * kHeight), -side.out, kRoomWidth, kHeight, wallpaper, look.Bits());
    Panel(side.At(along - 0.5 * kRoomWidth, 0.5 * (near + far), 0.5 * kHeight), a, kRoomDepth, kHeight, wallpaper,
          look.Bits());
    Panel(side.At(along + 0.5 * kRoomWidth, 0.5 * (near + far), 0.5 * kHeight), -a, kRoomDepth, kHeight, wallpaper,
          look.Bits());
    const double shelf = look.Uniform(-0.9, 0.9);
    Box(side.At(along + shelf, far - 0.2, 0.95), side.out, {0.18, 0.55, 0.95}, bookshelf, look.Bits());
    const double desk = shelf > 0 ? -0.8 : 0.8;
    Box(side.At(along + desk, far - 0.9, 0.37), side.out, {0.35, 0.55, 0.37}, paper, look.Bits());
    Box(side.At(along + look.Uniform(-0.3, 0.3), far - 1.6, 0.25), side.out, {0.25, 0.25, 0.25}, PaintCarton,
        look.Bits());
    Box(side.At(along + (shelf > 0 ? -1.35 : 1.35), far - 1.9, 0.5), side.out, {0.3, 0.2, 0.5}, cabinet, look.Bits());
    for (const double up : {1.2, 1.75}) {
      Panel(side.At(along + desk, far - 0.012, up), -side.out, look.Uniform(0.4, 0.7), look.Uniform(0.3, 0.45),
            PaintPoster, look.Bits(), kUpward, 0.003);
    }
  }

  void BuildSide(std::size_t index) {
    const Side& side = kSides[index];
    // The inner wall, in pieces; a stretch of the second side is plain, on both walls.
    const double inner = side.half_length - kHalfWidth;
    const bool has_plain = index == 1;
    for (double from = -inner; from < inner - 0.01;) {
      const double to = std::min(inner, from + 3);
      Wall(side.At(0.5 * (from + to), -kHalfWidth, 0.5 * kHeight), side.out, to - from,
           has_plain && from < 0 && to > -kPlain_m);
      from = to;
    }
    // The outer wall with two rooms; between them and beside them, walls with doors.
    const double outer = side.half_length + kHalfWidth;
    const double room = 0.5 * side.half_length;
    double from = -outer;
    for (const double along : {-room, room}) {
      OuterWall(side, from, along - 0.5 * kRoomWidth, has_plain);
      BuildRoom(side, along, Decorated(look_.alike ? 4711 : random_.Bits()));
      from = along + 0.5 * kRoomWidth;
    }
    OuterWall(side, from, outer, has_plain);
  }

  void OuterWall(const Side& side, double from, double to, bool has_plain) {
    const bool plain = has_plain && from < 0 && to > -0.5;
    Wall(side.At(0.5 * (from + to), kHalfWidth, 0.5 * kHeight), -side.out, to - from, plain);
    if (!plain && to - from > 1.4) {
      Panel(
          side.At(0.5 * (from + to), kHalfWidth - 0.02, 1.0), -side.out, 0.9, 2.0,
          [](Canvas& canvas, Random& random) {
            PaintWood(canvas, random, {92, 136, 178});
          },
          look_.alike ? 42 : random_.Bits());
    }
  }

  void BuildFloors() {
    const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
    constexpr double kPiece = 4;
    const double half_x = kHalfX + kHalfWidth + kRoomDepth;
    const double half_y = kHalfY + kHalfWidth + kRoomDepth;
    for (double x = -half_x; x < half_x; x += kPiece) {
      for (double v = -half_y; v < half_y; v += kPiece) {
        const double width = std::min(kPiece, half_x - x);
        const double height = std::min(kPiece, half_y - v);
        const Eigen::Vector3d center(x + 0.5 * width, v + 0.5 * height, 0);
        const bool inside =
            std::abs(center.x()) < kHalfX - kHalfWidth - kPiece && std::abs(center.y()) < kHalfY - kHalfWidth - kPiece;
        if (!inside) {
          Panel(
              center, kUpward, width, height,
              [](Canvas& canvas, Random& random) {
                PaintPlanks(canvas, random, {96, 138, 176}, 0.14, 1.4);
              },
              random_.Bits(), y, 0.01);
          Panel(center + kHeight * kUpward, -kUpward, width, height, PaintCeiling, random_.Bits(), y, 0.012);
        }
      }
    }
  }

  RoomBuilder builder_;
  Random random_;
  BuildingLook look_;
};

double Sway(double time_s, double period_s) { return std::sin(2 * kPi * time_s / period_s); }

}  // namespace

Room BuildBuilding(std::uint64_t seed, const BuildingLook& look, double texel_scale) {
  return Builder(seed, look, texel_scale).Build();
}

double RingLength() { return 4 * (kHalfX + kHalfY) - 8 * kCorner + 2 * kPi * kCorner; }

RingPlace RingAt(double way_m) {
  double rest = std::fmod(way_m, RingLength());
  rest += rest < 0 ? RingLength() : 0;
  // From the middle of the first side on: half a side, a corner, a side, ...
  constexpr double kArc = 0.5 * kPi * kCorner;
  for (std::size_t i = 0;; ++i) {
    const Side& side = kSides[i % 4];
    const double straight = side.half_length - kCorner;
    const double begin = i == 0 ? 0 : -straight;
    const double heading = std::atan2(side.Along().y(), side.Along().x());
    if (rest <= straight - begin) {
      return {side.At(begin + rest, 0, 0).head<2>(), heading};
    }
    rest -= straight - begin;
    if (rest <= kArc) {
      const double angle = rest / kCorner;
      const Eigen::Vector3d center = side.At(straight, -kCorner, 0);
      const Eigen::Vector3d place = center + kCorner * (std::cos(angle) * side.out + std::sin(angle) * side.Along());
      return {place.head<2>(), heading + angle};
    }
    rest -= kArc;
  }
}

Rigid3 RingGaze(double time_s, bool back) {
  const double way_m = kSpeed_m_s * time_s * (back ? -1 : 1);
  const RingPlace place = RingAt(way_m);
  const double forward = place.heading + (back ? kPi : 0);
  const double aside = 0.3 + 0.08 * Sway(time_s, 8.5);  // to the right of the way
  const double yaw = forward + 0.35 * Sway(time_s, 6.5) + 0.1 * Sway(time_s, 3.1);
  const double pitch = -0.08 + 0.06 * Sway(time_s, 4.3);
  const Eigen::Vector3d z(std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch));
  const Eigen::Vector3d x = z.cross(kUpward).normalized();
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  Rigid3 pose;
  pose.rotation = Eigen::Quaterniond(axes).normalized();
  pose.translation = {place.position.x() + aside * std::sin(forward), place.position.y() - aside * std::cos(forward),
                      1.35 + 0.04 * Sway(time_s, 5.2)};
  return pose;
}

std::vector<Mover> PlanRingWalkers(int count, double duration_s, std::uint64_t seed) {
  constexpr double kWalk_m_s = 1.0;
  std::vector<Mover> movers;
  for (int i = 0; i < count; ++i) {
    // From corner to corner, clockwise, on the left of the camera's way.
    Random random(seed * 977 + static_cast<std::uint64_t>(i));
    const double off = -0.35 - random.Uniform(0, 0.25);
    const auto corner = [&](int k) {
      const double x = (kHalfX + off) * (k % 4 == 0 || k % 4 == 3 ? 1 : -1);
      const double y = (kHalfY + off) * (k % 4 < 2 ? 1 : -1);
      return Eigen::Vector2d(x, y);
    };
    int at = static_cast<int>(random.Index(4));
    double time_s = random.Uniform(0, 4);
    double walked_m = 0;
    std::vector<Leg> legs;
    while (legs.empty() || time_s < duration_s) {
      Leg leg;
      leg.from = corner(at);
      at = (at + 3) % 4;
      leg.to = corner(at);
      const double length_m = (leg.to - leg.from).norm();
      leg.departure_s = time_s;
      leg.arrival_s = time_s + length_m / kWalk_m_s + kRamp_s;
      leg.walked_before_m = walked_m;
      leg.heading = std::atan2(leg.to.y() - leg.from.y(), leg.to.x() - leg.from.x());
      walked_m += length_m;
      time_s = leg.arrival_s + kTurn_s;
      legs.push_back(leg);
    }
    movers.emplace_back(seed + 31 * static_cast<std::uint64_t>(i), std::move(legs));
  }
  return movers;
}

}  // namespace rds::synthetic
