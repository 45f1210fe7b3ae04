// SPDX-License-Identifier: Apache-2.0
// Collects boxes, panels and round things, then lights and paints them.
#pragma once

#include <functional>
#include <vector>

#include "synth/lighting.h"
#include "synth/room.h"

namespace rds::synthetic {

using Painter = std::function<void(Canvas&, Random&)>;

// How a box looks: its front is the local +x side. Sides that touch something else can be left out.
struct BoxStyle {
  Painter front;
  Painter other;
  Painter top;           // `other` if empty
  bool glows = false;    // the front shines by itself
  bool has_back = true;  // false: the -x side stands against a wall
};

class RoomBuilder {
 public:
  RoomBuilder(std::uint64_t seed, double texel_scale);

  // Random numbers for layout; each surface has its own for painting.
  Random& random() { return random_; }
  // A rectangle about `center` that faces along `normal`; its picture's upper border is toward `up`.
  void AddPanel(const Eigen::Vector3d& center, const Eigen::Vector3d& normal, const Eigen::Vector3d& up, double width,
                double height, Painter painter, double texel_m = 0.0025, bool glows = false);
  void AddBox(const Box& box, const BoxStyle& style, double texel_m = 0.0025);
  // Upright cylinder, flat or rounded at its ends over `rounding` meters; lit by its normal.
  void AddCylinder(const Eigen::Vector3d& bottom, double radius, double height, double rounding,
                   const Painter& painter);
  void AddBall(const Eigen::Vector3d& center, double radius, const Painter& painter);
  void AddSeat(const Seat& seat) { room_.seats.push_back(seat); }

  // Lights and paints everything.
  Room Finish(std::vector<AreaLight> lights);

 private:
  struct Surface {
    Quad quad;
    Painter painter;
    double texel_m = 0;
    bool glows = false;
  };
  void AddCapsule(Capsule capsule, const Painter& painter);

  Random random_;
  std::uint64_t seed_;
  double texel_scale_;
  std::vector<Surface> surfaces_;
  Room room_;
};

}  // namespace rds::synthetic
