// SPDX-License-Identifier: Apache-2.0
#include "io/ignored_pixels.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "io/dataset.h"
#include "segmentation/mask.h"

namespace rds {
namespace {

constexpr int kAround_px = 20;  // at an image width of 640
constexpr std::uint8_t kGray = 128;
constexpr double kMostIgnored = 0.9;

}  // namespace

IgnoredPixels::IgnoredPixels(Image8 mask) : mask_(std::move(mask)) {
  around_ = Dilate(mask_, DilationRadius(mask_.width, kAround_px));
}

void IgnoredPixels::Apply(Image8& color, Image16& depth) const {
  const auto channels = static_cast<std::size_t>(color.channels);
  for (std::size_t i = 0; i < mask_.data.size(); ++i) {
    if (mask_.data[i] != 0) {
      std::fill_n(color.data.begin() + static_cast<std::ptrdiff_t>(i * channels), channels, kGray);
    }
    depth.data[i] = around_.data[i] != 0 ? std::uint16_t{0} : depth.data[i];
  }
}

IgnoredPixels LoadIgnoredPixels(const std::filesystem::path& path, const PinholeCamera& camera) {
  Image8 mask = LoadMask(path, camera);
  const auto ignored =
      static_cast<double>(mask.data.size() - static_cast<std::size_t>(std::ranges::count(mask.data, 0)));
  if (const double share = ignored / static_cast<double>(mask.data.size()); share > kMostIgnored) {
    throw InputError(
        fmt::format("{}: {:.0f} % of the image would be ignored; black is what is used", path.string(), 100 * share));
  }
  return IgnoredPixels(std::move(mask));
}

}  // namespace rds
