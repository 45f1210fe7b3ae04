// SPDX-License-Identifier: Apache-2.0
#include "synth/rasterizer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "synth/visibility.h"

namespace rds::synthetic {
namespace {

constexpr int kSamples = 2;  // a side of a pixel
constexpr int kRun = 8;      // neighboring samples that share a filter
constexpr int kMaxTaps = 4;  // of an oblique filter

struct View {
  const Scene& scene;
  SampleGrid grid;
  std::vector<ProjectedQuad> quads;
  std::vector<ProjectedCapsule> capsules;
  Eigen::Vector3d up;     // of the world, in the camera's frame
  Eigen::Vector3d light;  // direction to the main light, in the camera's frame

  View(const Scene& scene_, const PinholeCamera& camera, int factor, const Rigid3& camera_from_world)
      : scene(scene_), grid(camera, factor) {
    quads.reserve(scene.quads.size());
    for (const Quad& quad : scene.quads) {
      quads.push_back(Project(quad, grid, camera_from_world));
    }
    for (const Capsule& capsule : scene.capsules) {
      capsules.push_back(Project(capsule, camera_from_world));
    }
    up = camera_from_world.rotation * Eigen::Vector3d::UnitZ();
    light = camera_from_world.rotation * Eigen::Vector3d(-0.35, 0.3, 0.89).normalized();
  }

  [[nodiscard]] bool IsMover(std::uint16_t surface) const {
    return surface != VisibilityBuffer::kNothing &&
           (surface < quads.size() ? scene.quads[surface].is_mover : scene.capsules[surface - quads.size()].is_mover);
  }
};

// How a texture is read about a sample: an elliptic filter made of up to kMaxTaps round ones in a row.
struct Filter {
  int taps = 1;
  float lod = 0;     // of each round filter
  float step_x = 0;  // texels from one to the next
  float step_y = 0;
};

// The footprint of a sample on a rectangle's texture, by its derivatives at (column, row).
Filter FilterAt(const ProjectedQuad& projected, double column, double row, double per_s, double per_t) {
  const double inverse = 1.0 / std::max(projected.w.At(column, row), 1e-3);
  const double s = projected.s.At(column, row) * inverse;
  const double t = projected.t.At(column, row) * inverse;
  const double s_x = (projected.s.a - s * projected.w.a) * inverse * per_s;
  const double t_x = (projected.t.a - t * projected.w.a) * inverse * per_t;
  const double s_y = (projected.s.b - s * projected.w.b) * inverse * per_s;
  const double t_y = (projected.t.b - t * projected.w.b) * inverse * per_t;
  const double square_x = s_x * s_x + t_x * t_x;
  const double square_y = s_y * s_y + t_y * t_y;
  const bool along_x = square_x > square_y;
  const double major = std::sqrt(std::max({square_x, square_y, 1e-18}));
  // Width across the major axis: area of the sample's footprint over its length.
  const double minor = std::max(std::abs(s_x * t_y - s_y * t_x) / major, 1e-9);
  Filter filter;
  filter.taps = std::clamp(static_cast<int>(std::ceil(major / std::max(minor, 1.0) - 0.25)), 1, kMaxTaps);
  filter.lod = static_cast<float>(std::log2(std::max(major / filter.taps, minor)));
  filter.step_x = static_cast<float>((along_x ? s_x : s_y) / filter.taps);
  filter.step_y = static_cast<float>((along_x ? t_x : t_y) / filter.taps);
  return filter;
}

// Colors of `count` neighboring samples of a rectangle, all within one block of kRun columns. The filter is that of
// the block's middle, whatever part of the block the rectangle covers: what stands before it must not change its
// colors.
void ShadeQuad(const Quad& quad, const ProjectedQuad& projected, int column, int row, int count, Float4* out) {
  const Texture& texture = *quad.texture;
  const double per_s = texture.width() / quad.width;  // texels in a meter
  const double per_t = texture.height() / quad.height;
  const int block = column / kRun * kRun;
  const Filter filter = FilterAt(projected, block + 0.5 * (kRun - 1), row, per_s, per_t);
  const float first = -0.5F * static_cast<float>(filter.taps - 1);
  const auto w_0 = static_cast<float>(projected.w.At(block, row));
  const auto s_0 = static_cast<float>(projected.s.At(block, row) * per_s);
  const auto t_0 = static_cast<float>(projected.t.At(block, row) * per_t);
  const auto w_a = static_cast<float>(projected.w.a);
  const auto s_a = static_cast<float>(projected.s.a * per_s);
  const auto t_a = static_cast<float>(projected.t.a * per_t);
  for (int i = 0; i < count; ++i) {
    const auto step = static_cast<float>(column - block + i);
    const float depth = 1.0F / (w_0 + step * w_a);
    const float x = (s_0 + step * s_a) * depth + first * filter.step_x;
    const float y = (t_0 + step * t_a) * depth + first * filter.step_y;
    Float4 sum{};
    for (int tap = 0; tap < filter.taps; ++tap) {
      const auto k = static_cast<float>(tap);
      sum += texture.Sample(std::clamp(x + k * filter.step_x, 0.0F, texture.width()),
                            std::clamp(y + k * filter.step_y, 0.0F, texture.height()), filter.lod);
    }
    out[i] = sum / static_cast<float>(filter.taps);
  }
}

void ShadeCapsule(const View& view, std::size_t index, int column, int row, int count, const float* inverse_depth,
                  Float4* out) {
  const Capsule& capsule = view.scene.capsules[index];
  const ProjectedCapsule& projected = view.capsules[index];
  const Texture& texture = *capsule.texture;
  const double radius = 0.5 * (capsule.axes.col(0).norm() + capsule.axes.col(1).norm());
  const double texel_m = 2.0 * std::numbers::pi * radius / texture.width();
  const auto lod_at_1m = static_cast<float>(std::log2(view.grid.step_x / texel_m));
  const double turns = 0.5 / std::numbers::pi;
  const double ray_y = view.grid.y0 + view.grid.step_y * row;
  for (int i = 0; i < count; ++i) {
    const double depth = 1.0 / static_cast<double>(inverse_depth[i]);
    const float lod = lod_at_1m - std::log2(inverse_depth[i]);
    const Eigen::Vector3d ray(view.grid.x0 + view.grid.step_x * (column + i), ray_y, 1.0);
    Eigen::Vector3d local = projected.local_from_camera * ray * depth - projected.center;
    const double around = turns * std::atan2(local.y(), local.x()) + 0.5;
    const double along = 0.5 - 0.5 * local.z() / (1.0 + projected.half_length);
    local.z() -= std::clamp(local.z(), -projected.half_length, projected.half_length);
    const Eigen::Vector3d normal = (projected.local_from_camera.transpose() * local).normalized();
    const double lit =
        0.52 + 0.22 * normal.dot(view.up) + 0.34 * std::max(0.0, normal.dot(view.light)) + 0.12 * std::abs(normal.z());
    out[i] = static_cast<float>(lit) *
             texture.Sample(std::clamp(static_cast<float>(around), 0.0F, 1.0F) * texture.width(),
                            std::clamp(static_cast<float>(along), 0.0F, 1.0F) * texture.height(), lod);
  }
}

void ShadeRow(const View& view, const VisibilityBuffer& visible, int row, Float4* out) {
  const auto offset = static_cast<std::ptrdiff_t>(row) * view.grid.width;
  const std::uint16_t* surface = visible.surface.data() + offset;
  int end = 0;
  for (int begin = 0; begin < view.grid.width; begin = end) {
    const std::uint16_t id = surface[begin];
    for (end = begin + 1; end < view.grid.width && end % kRun != 0 && surface[end] == id;) {
      ++end;
    }
    if (id == VisibilityBuffer::kNothing) {
      std::fill(out + begin, out + end, Float4{});
    } else if (id < view.quads.size()) {
      ShadeQuad(view.scene.quads[id], view.quads[id], begin, row, end - begin, out + begin);
    } else {
      ShadeCapsule(view, id - view.quads.size(), begin, row, end - begin, visible.inverse_depth.data() + offset + begin,
                   out + begin);
    }
  }
}

// Color and the samples' part of the mask.
void DrawColor(const Scene& scene, const PinholeCamera& camera, const Rigid3& camera_from_world, Drawing& drawing) {
  const View view(scene, camera, kSamples, camera_from_world);
  const VisibilityBuffer visible = ComputeVisibility(scene, view.quads, view.capsules, view.grid, camera_from_world);
  const auto row_samples = static_cast<std::size_t>(view.grid.width);
  std::vector<Float4> samples(kSamples * row_samples);
  for (int y = 0; y < camera.height; ++y) {
    for (int k = 0; k < kSamples; ++k) {
      ShadeRow(view, visible, kSamples * y + k, samples.data() + static_cast<std::size_t>(k) * row_samples);
    }
    float* out = drawing.color.data() + 3 * static_cast<std::ptrdiff_t>(y) * camera.width;
    const std::uint16_t* surface = visible.surface.data() + static_cast<std::ptrdiff_t>(kSamples * y) * view.grid.width;
    for (int x = 0; x < camera.width; ++x) {
      const Float4* upper = samples.data() + 2 * x;
      const Float4* lower = upper + row_samples;
      const Float4 mean = 0.25F * (upper[0] + upper[1] + lower[0] + lower[1]);
      for (int c = 0; c < 3; ++c) {
        out[3 * x + c] = mean[c];
      }
      const std::uint16_t* four = surface + 2 * x;
      if (view.IsMover(four[0]) || view.IsMover(four[1]) || view.IsMover(four[row_samples]) ||
          view.IsMover(four[row_samples + 1])) {
        drawing.mask.At(x, y) = 255;
      }
    }
  }
}

// Depth, in double precision from the visible surface, and the center rays' part of the mask.
void DrawDepth(const Scene& scene, const PinholeCamera& camera, const Rigid3& camera_from_world, Drawing& drawing) {
  const View view(scene, camera, 1, camera_from_world);
  const VisibilityBuffer visible = ComputeVisibility(scene, view.quads, view.capsules, view.grid, camera_from_world);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const auto at = static_cast<std::size_t>(y * camera.width + x);
      const std::uint16_t id = visible.surface[at];
      if (id == VisibilityBuffer::kNothing) {
        continue;
      }
      drawing.depth_m[at] = id < view.quads.size() ? static_cast<float>(1.0 / view.quads[id].w.At(x, y))
                                                   : 1.0F / visible.inverse_depth[at];
      if (view.IsMover(id)) {
        drawing.mask.At(x, y) = 255;
      }
    }
  }
}

}  // namespace

Drawing Draw(const Scene& scene, const PinholeCamera& camera, const Rigid3& camera_from_world) {
  const auto pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  Drawing drawing{std::vector<float>(3 * pixels), std::vector<float>(pixels, 0.0F),
                  Image8(camera.width, camera.height)};
  DrawColor(scene, camera, camera_from_world, drawing);
  DrawDepth(scene, camera, camera_from_world, drawing);
  return drawing;
}

}  // namespace rds::synthetic
