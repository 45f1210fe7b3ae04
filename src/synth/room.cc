// SPDX-License-Identifier: Apache-2.0
#include "synth/room.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "synth/paint.h"
#include "synth/room_builder.h"

namespace rds::synthetic {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHalf = Room::kHalfSize;
constexpr Color kOak{92, 136, 178};
constexpr Color kWalnut{58, 82, 118};
constexpr Color kBirch{170, 205, 225};
constexpr Color kGray{128, 126, 122};
constexpr Color kDark{58, 54, 52};

Painter Plain(void (*paint)(Canvas&, Random&)) { return paint; }
Painter Colored(void (*paint)(Canvas&, Random&, const Color&), const Color& color) {
  return [=](Canvas& canvas, Random& random) { paint(canvas, random, color); };
}
BoxStyle Wooden(const Color& color) { return {Colored(PaintWood, color), Colored(PaintWood, color), {}}; }

// One of the four walls: `along` runs to the right as one looks at it from inside.
struct Wall {
  Eigen::Vector3d normal;  // into the room
  [[nodiscard]] Eigen::Vector3d Right() const { return Eigen::Vector3d::UnitZ().cross(normal); }
  // A point `right` of the middle, `up` above the floor, `off` before the wall.
  [[nodiscard]] Eigen::Vector3d At(double right, double up, double off) const {
    return (off - kHalf) * normal + right * Right() + up * Eigen::Vector3d::UnitZ();
  }
  [[nodiscard]] double Yaw() const { return std::atan2(normal.y(), normal.x()); }
};

const Wall kEast{{-1, 0, 0}};   // x = +3.0
const Wall kWest{{1, 0, 0}};    // x = -3.0
const Wall kNorth{{0, -1, 0}};  // y = +3.0
const Wall kSouth{{0, 1, 0}};   // y = -3.0

// A box that stands against a wall: `right` and `bottom` of its lower middle.
Box Against(const Wall& wall, double right, double bottom, double width, double depth, double height) {
  return {
      wall.At(right, bottom + 0.5 * height, 0.5 * depth + 0.005), {0.5 * depth, 0.5 * width, 0.5 * height}, wall.Yaw()};
}

// Pictures on a wall, where there is room beside those that hang there already.
class Hanger {
 public:
  Hanger(RoomBuilder& builder, const Wall& wall) : builder_(builder), wall_(wall) {}

  void Hang(double right, double up, double width, double height, Painter painter, bool glows = false) {
    builder_.AddPanel(wall_.At(right, up, 0.012), wall_.normal, Eigen::Vector3d::UnitZ(), width, height,
                      std::move(painter), 0.0025, glows);
    taken_.push_back({right, up, width, height});
  }
  void Reserve(double right, double up, double width, double height) { taken_.push_back({right, up, width, height}); }

  void HangPosters(int tries) {
    Random& random = builder_.random();
    for (int i = 0; i < tries; ++i) {
      const double shrink = 1.0 - 0.5 * i / tries;
      const double width = random.Uniform(0.3, 0.85) * shrink;
      const double height = random.Uniform(0.3, 0.8) * shrink;
      const double right = random.Uniform(0.5 * width + 0.1 - kHalf, kHalf - 0.1 - 0.5 * width);
      const double up = random.Uniform(0.5 * height + 0.25, 2.5 - 0.5 * height);
      const bool free = std::none_of(taken_.begin(), taken_.end(), [&](const Area& area) {
        return std::abs(area.right - right) < 0.5 * (area.width + width) + 0.05 &&
               std::abs(area.up - up) < 0.5 * (area.height + height) + 0.05;
      });
      if (free) {
        Hang(right, up, width, height, Plain(PaintPoster));
      }
    }
  }

 private:
  struct Area {
    double right, up, width, height;
  };
  RoomBuilder& builder_;
  Wall wall_;
  std::vector<Area> taken_;
};

void BuildShell(RoomBuilder& builder) {
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  builder.AddPanel(
      {0, 0, 0}, z, y, 2 * kHalf, 2 * kHalf,
      [](Canvas& canvas, Random& random) {
        PaintPlanks(canvas, random, {96, 138, 176}, 0.14, 1.4);
      },
      0.004);
  builder.AddPanel({0, 0, Room::kHeight}, -z, y, 2 * kHalf, 2 * kHalf, Plain(PaintCeiling), 0.006);
  builder.AddPanel(kEast.At(0, 1.3, 0), kEast.normal, z, 2 * kHalf, Room::kHeight,
                   Colored(PaintWallpaper, {176, 200, 206}), 0.004);
  builder.AddPanel(kNorth.At(0, 1.3, 0), kNorth.normal, z, 2 * kHalf, Room::kHeight,
                   Colored(PaintPlaster, {196, 208, 206}), 0.004);
  builder.AddPanel(kWest.At(0, 1.3, 0), kWest.normal, z, 2 * kHalf, Room::kHeight,
                   Colored(PaintWallpaper, {198, 186, 166}), 0.004);
  builder.AddPanel(kSouth.At(0, 1.3, 0), kSouth.normal, z, 2 * kHalf, Room::kHeight,
                   Colored(PaintPlaster, {168, 196, 218}), 0.004);
  builder.AddPanel({-1.5, 0.2, 0.006}, z, y, 1.8, 2.6, Plain(PaintRug), 0.004);
  builder.AddPanel({1.9, -1.6, 0.006}, z, y, 1.4, 1.2, Plain(PaintRug), 0.004);
  for (const double x : {-1.5, 1.5}) {  // the lamps' glass
    builder.AddPanel(
        {x, 0, Room::kHeight - 0.015}, -z, y, 0.34, 1.3,
        [](Canvas& canvas, Random&) {
          canvas.Fill({246, 252, 254});
          for (int i = 0; i < 5; ++i) {
            canvas.Rect(0.5 * canvas.width_m(), (i + 0.5) * canvas.height_m() / 5, canvas.width_m(), 0.02,
                        {190, 194, 196});
          }
        },
        0.005, true);
  }
}

// Books, boxes and round things on a surface `half` wide and deep about `center`, whose height is center.z.
void BuildClutter(RoomBuilder& builder, const Eigen::Vector3d& center, const Eigen::Vector2d& half, int count,
                  double tallest) {
  Random& random = builder.random();
  std::vector<Eigen::Vector3d> taken;  // x, y, radius
  for (int i = 0; i < count * 4 && static_cast<int>(taken.size()) < count; ++i) {
    const double size = random.Uniform(0.05, 0.15);
    const double height = std::min(random.Uniform(0.03, 0.3), tallest);
    const Eigen::Vector3d place(center.x() + random.Uniform(-1, 1) * std::max(0.0, half.x() - size),
                                center.y() + random.Uniform(-1, 1) * std::max(0.0, half.y() - size), center.z());
    const bool free = std::none_of(taken.begin(), taken.end(), [&](const Eigen::Vector3d& other) {
      return (other.head<2>() - place.head<2>()).norm() < other.z() + 1.25 * size;
    });
    if (!free) {
      continue;
    }
    taken.emplace_back(place.x(), place.y(), 1.25 * size);
    switch (random.Index(4)) {
      case 0:
        builder.AddCylinder(place, 0.45 * size, std::max(height, 0.09), 0.006, Plain(PaintPoster));
        break;
      case 1:
        builder.AddBox(
            {place + Eigen::Vector3d(0, 0, 0.5 * height), {size, 0.7 * size, 0.5 * height}, random.Uniform(0, 2 * kPi)},
            {Plain(PaintCarton), Plain(PaintCarton), {}}, 0.002);
        break;
      default: {  // a pile of books
        double bottom = place.z();
        const int books = 1 + static_cast<int>(random.Index(4));
        for (int book = 0; book < books; ++book) {
          const double thick = random.Uniform(0.02, 0.05);
          const Color cover = RandomColor(random, 0.2, 0.8, 0.25, 0.9);
          builder.AddBox({{place.x(), place.y(), bottom + 0.5 * thick},
                          {0.95 * size, 0.7 * size, 0.5 * thick},
                          random.Uniform(0, 2 * kPi)},
                         {Colored(PaintFabric, cover), Colored(PaintFabric, cover), Plain(PaintPoster)}, 0.002);
          bottom += thick;
        }
      }
    }
  }
}

void BuildMonitor(RoomBuilder& builder, const Eigen::Vector3d& foot, double yaw) {
  const BoxStyle black{Colored(PaintFabric, kDark), Colored(PaintFabric, kDark), {}};
  builder.AddBox({foot + Eigen::Vector3d(0, 0, 0.01), {0.09, 0.12, 0.01}, yaw}, black);
  builder.AddBox({foot + Eigen::Vector3d(-0.04 * std::cos(yaw), -0.04 * std::sin(yaw), 0.1), {0.015, 0.03, 0.1}, yaw},
                 black);
  BoxStyle screen{Plain(PaintScreen), Plain(PaintPoster), Colored(PaintFabric, kDark)};
  screen.glows = true;
  builder.AddBox({foot + Eigen::Vector3d(0, 0, 0.27), {0.02, 0.28, 0.17}, yaw}, screen, 0.002);
  const Eigen::Vector3d before(std::cos(yaw), std::sin(yaw), 0);
  builder.AddBox({foot + 0.24 * before + Eigen::Vector3d(0, 0, 0.012), {0.075, 0.22, 0.012}, yaw},
                 {Colored(PaintFabric, kDark), Colored(PaintFabric, kDark), Plain(PaintKeyboard)}, 0.002);
}

void BuildTable(RoomBuilder& builder, const Eigen::Vector2d& center, const Eigen::Vector2d& half, const Color& wood) {
  BoxStyle top = Wooden(wood);
  top.top = Colored(PaintPaperwork, wood);
  builder.AddBox({{center.x(), center.y(), 0.72}, {half.x(), half.y(), 0.025}, 0}, top, 0.002);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      builder.AddBox(
          {{center.x() + x * (half.x() - 0.06), center.y() + y * (half.y() - 0.06), 0.3475}, {0.035, 0.035, 0.3475}, 0},
          Wooden(0.8F * wood));
    }
  }
}

void BuildChair(RoomBuilder& builder, const Eigen::Vector2d& place, double heading) {
  const Color cloth = RandomColor(builder.random(), 0.4, 0.8, 0.35, 0.75);
  const BoxStyle fabric{Colored(PaintFabric, cloth), Colored(PaintFabric, cloth), {}};
  const Eigen::Vector3d forward(std::cos(heading), std::sin(heading), 0);
  const Eigen::Vector3d base(place.x(), place.y(), 0);
  builder.AddBox({base + Eigen::Vector3d(0, 0, 0.43), {0.22, 0.22, 0.03}, heading}, fabric);
  builder.AddBox({base - 0.2 * forward + Eigen::Vector3d(0, 0, 0.71), {0.025, 0.2, 0.19}, heading}, fabric);
  builder.AddBox({base - 0.2 * forward + Eigen::Vector3d(0, 0, 0.49), {0.015, 0.04, 0.06}, heading}, Wooden(kDark));
  builder.AddBox({base + Eigen::Vector3d(0, 0, 0.22), {0.03, 0.03, 0.18}, heading}, Wooden(kDark));
  builder.AddBox({base + Eigen::Vector3d(0, 0, 0.025), {0.2, 0.2, 0.015}, heading}, Wooden(kDark));
  builder.AddSeat({place, heading});
}

void BuildMiddle(RoomBuilder& builder) {
  BuildTable(builder, {0, 0}, {0.45, 0.9}, kOak);
  builder.AddBox({{-0.02, -0.6, 0.28}, {0.28, 0.2, 0.28}, kPi},
                 {[](Canvas& canvas, Random& random) { PaintCabinet(canvas, random, kBirch, 1, 3); },
                  Colored(PaintWood, kBirch),
                  {}});
  BuildMonitor(builder, {0.14, 0.02, 0.745}, kPi + 0.1);
  BuildClutter(builder, {-0.22, -0.55, 0.745}, {0.2, 0.3}, 3, 0.22);
  BuildClutter(builder, {-0.25, 0.4, 0.745}, {0.16, 0.18}, 2, 0.15);
  BuildClutter(builder, {0.25, 0.6, 0.745}, {0.18, 0.27}, 3, 0.16);
  BuildClutter(builder, {0.22, -0.6, 0.745}, {0.2, 0.27}, 3, 0.16);
  builder.AddBall({-0.25, 0.75, 0.745 + 0.11}, 0.11, Plain(PaintPoster));
  BuildChair(builder, {0.82, 0.48}, kPi + 0.1);
  BuildChair(builder, {0.85, -0.45}, kPi - 0.15);
  BuildChair(builder, {0.02, 1.36}, -kPi / 2);
  BuildChair(builder, {0.05, -1.38}, kPi / 2);
}

void BuildShelf(RoomBuilder& builder, const Wall& wall, double right, double width, double height, const Color& wood) {
  BoxStyle style = Wooden(wood);
  style.front = [wood](Canvas& canvas, Random& random) { PaintBookshelf(canvas, random, wood, 0.33); };
  style.has_back = false;
  const Box box = Against(wall, right, 0, width, 0.32, height);
  builder.AddBox(box, style);
  if (height < 1.6) {
    const Eigen::Vector3d top = wall.At(right, height, 0.17);
    const bool along_x = std::abs(wall.normal.y()) > 0.5;
    BuildClutter(builder, top, along_x ? Eigen::Vector2d(0.5 * width, 0.15) : Eigen::Vector2d(0.15, 0.5 * width), 4,
                 0.3);
  }
}

void BuildCabinet(RoomBuilder& builder, const Wall& wall, double right, double bottom, const Eigen::Vector3d& size,
                  const Color& color, int columns, int rows) {
  BoxStyle style = Wooden(color);
  style.front = [=](Canvas& canvas, Random& random) { PaintCabinet(canvas, random, color, columns, rows); };
  style.has_back = false;
  builder.AddBox(Against(wall, right, bottom, size.y(), size.x(), size.z()), style);
  if (bottom == 0 && size.z() < 1.3) {
    const bool along_x = std::abs(wall.normal.y()) > 0.5;
    const Eigen::Vector2d half(0.48 * size.x(), 0.48 * size.y());
    BuildClutter(builder, wall.At(right, size.z(), 0.5 * size.x()),
                 along_x ? Eigen::Vector2d(half.y(), half.x()) : half, 5, 0.35);
  }
}

void BuildEast(RoomBuilder& builder) {
  Hanger hanger(builder, kEast);
  BuildShelf(builder, kEast, -2.35, 1.3, 2.05, kWalnut);
  BuildShelf(builder, kEast, -0.95, 1.2, 1.1, kOak);
  BuildCabinet(builder, kEast, 0.75, 0, {0.45, 1.6, 0.9}, kBirch, 3, 2);
  BuildShelf(builder, kEast, 2.4, 1.2, 1.9, kBirch);
  hanger.Reserve(-2.35, 1.0, 1.3, 2.1);
  hanger.Reserve(2.4, 0.95, 1.2, 1.9);
  hanger.Reserve(0, 0.5, 3.4, 1.1);
  hanger.Hang(0.75, 1.75, 1.5, 0.9, Plain(PaintWhiteboard));
  hanger.HangPosters(60);
}

void BuildNorth(RoomBuilder& builder) {
  Hanger hanger(builder, kNorth);
  hanger.Hang(0.3, 1.6, 1.9, 1.25, Plain(PaintWindow), true);
  BuildCabinet(builder, kNorth, 0.3, 0, {0.35, 2.0, 0.75}, kGray, 4, 1);
  BuildMonitor(builder, kNorth.At(-0.1, 0.75, 0.2), kNorth.Yaw());
  BuildShelf(builder, kNorth, -2.1, 1.1, 2.0, kOak);
  BuildCabinet(builder, kNorth, 2.12, 0, {0.5, 1.0, 1.9}, kWalnut, 2, 2);
  hanger.Reserve(-2.1, 1.0, 1.1, 2.0);
  hanger.Reserve(2.12, 0.95, 1.0, 1.9);
  hanger.Reserve(0.3, 0.4, 2.0, 0.8);
  hanger.HangPosters(60);
}

void BuildWest(RoomBuilder& builder) {
  Hanger hanger(builder, kWest);
  BuildTable(builder, {-2.63, 1.2}, {0.34, 0.8}, kBirch);
  BuildMonitor(builder, {-2.8, 1.3, 0.745}, -0.1);
  BuildClutter(builder, {-2.7, 0.65, 0.745}, {0.2, 0.2}, 2, 0.25);
  BuildClutter(builder, {-2.7, 1.8, 0.745}, {0.2, 0.15}, 2, 0.25);
  const Color cloth{96, 84, 146};
  const BoxStyle sofa{Colored(PaintFabric, cloth), Colored(PaintFabric, cloth), {}};
  builder.AddBox(Against(kWest, -1.15, 0, 1.6, 0.85, 0.42), sofa);
  builder.AddBox(Against(kWest, -1.15, 0.42, 1.6, 0.22, 0.42), sofa);
  builder.AddSeat({{-2.48, -0.75}, 0.0});
  builder.AddSeat({{-2.48, -1.5}, 0.0});
  BuildShelf(builder, kWest, -2.5, 0.95, 1.5, kWalnut);
  hanger.Reserve(-1.15, 0.4, 1.6, 0.9);
  hanger.Reserve(1.2, 0.6, 1.6, 1.2);
  hanger.Reserve(-2.5, 0.75, 0.95, 1.9);
  hanger.HangPosters(70);
}

void BuildSouth(RoomBuilder& builder) {
  Hanger hanger(builder, kSouth);
  BuildCabinet(builder, kSouth, -0.5, 0, {0.5, 2.2, 0.88}, kBirch, 4, 1);
  BuildCabinet(builder, kSouth, -0.5, 1.55, {0.3, 2.2, 0.7}, kOak, 4, 1);
  hanger.Hang(-0.5, 1.2, 2.2, 0.6, [](Canvas& canvas, Random& random) {
    PaintTiles(canvas, random, {206, 214, 216}, 0.1);
  });
  BuildCabinet(builder, kSouth, 2.1, 0, {0.5, 0.8, 2.0}, kGray, 1, 3);
  const auto door = [](Canvas& canvas, Random& random) { PaintCabinet(canvas, random, {206, 224, 232}, 1, 2); };
  hanger.Hang(1.15, 1.0, 0.9, 2.0, door);
  hanger.Reserve(2.1, 1.0, 0.9, 2.0);
  hanger.Reserve(-0.5, 0.45, 2.2, 0.9);
  hanger.Reserve(-0.5, 1.9, 2.2, 0.75);
  hanger.HangPosters(60);
  for (int i = 0; i < 3; ++i) {  // cartons in the corner, piled up
    builder.AddBox({kSouth.At(-2.2 + 0.05 * i, 0.17 + 0.34 * i, 0.42), {0.24 - 0.02 * i, 0.28, 0.17}, 0.15 * i + 1.4},
                   {Plain(PaintCarton), Plain(PaintCarton), {}});
  }
}

}  // namespace

Room BuildRoom(std::uint64_t seed, double texel_scale) {
  RoomBuilder builder(seed, texel_scale);
  BuildShell(builder);
  BuildMiddle(builder);
  BuildEast(builder);
  BuildNorth(builder);
  BuildWest(builder);
  BuildSouth(builder);
  return builder.Finish({
      {{-1.5, 0, Room::kHeight - 0.03}, {0.17, 0, 0}, {0, 0.65, 0}, 3.0},
      {{1.5, 0, Room::kHeight - 0.03}, {0.17, 0, 0}, {0, 0.65, 0}, 3.0},
      {kNorth.At(0.3, 1.6, 0.05), {0.9, 0, 0}, {0, 0, 0.55}, 1.6},
  });
}

}  // namespace rds::synthetic
