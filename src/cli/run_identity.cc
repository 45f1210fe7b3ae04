// SPDX-License-Identifier: Apache-2.0
#include "cli/run_identity.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/version.hpp>
#include <random>

#include "base/version.h"
#include "segmentation/openvino_segmenter.h"

namespace rds {

std::string NewRunId() {
  std::random_device random;
  const std::uint64_t high = random();
  return fmt::format("{:016x}", (high << 32U) | random());
}

nlohmann::ordered_json VersionsJson() {
  const std::string openvino = OpenVinoVersion();
  return {{"rds", kVersion},
          {"compiler", __VERSION__},
          {"eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
          {"opencv", CV_VERSION},
          {"openvino", openvino.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(openvino)}};
}

}  // namespace rds
