#include "io/trajectory_io.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/log.h"
#include "io/atomic_file.h"
#include "io/text_table.h"

namespace rds {
namespace {

constexpr std::array<const char*, 8> kColumns = {"timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"};
constexpr double kNormTolerance = 0.1;  // published quaternions have four decimals or more

StampedPose ParsePose(const TextTable& table, const TextRow& row) {
  if (row.fields.size() != kColumns.size()) {
    throw InputError(table.Where(row) + ": " + std::to_string(row.fields.size()) +
                     " columns, 8 are wanted: timestamp tx ty tz qx qy qz qw");
  }
  std::array<double, kColumns.size()> value{};
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    value[i] = table.Number(row, i, kColumns[i]);
  }
  const Eigen::Quaterniond rotation(value[7], value[4], value[5], value[6]);
  if (std::abs(rotation.norm() - 1) > kNormTolerance) {
    char norm[32];
    std::snprintf(norm, sizeof norm, "%.3g", rotation.norm());
    throw InputError(table.Where(row) + ": the quaternion (qx qy qz qw, columns 5 to 8) has norm " + norm +
                     "; a rotation has norm 1");
  }
  return {value[0], {rotation.normalized(), {value[1], value[2], value[3]}}};
}

}  // namespace

Trajectory ReadTrajectory(const std::filesystem::path& path) {
  const TextTable table = ReadTextTable(path);
  Trajectory trajectory;
  trajectory.reserve(table.rows.size());
  int repeated = 0;
  for (const TextRow& row : table.rows) {
    const StampedPose pose = ParsePose(table, row);
    if (!trajectory.empty() && pose.timestamp_s < trajectory.back().timestamp_s) {
      throw InputError(table.Where(row) + ": timestamp " + row.fields[0] +
                       " is before the one of the row above; sort the file by time");
    }
    if (!trajectory.empty() && pose.timestamp_s == trajectory.back().timestamp_s) {
      ++repeated;
      continue;
    }
    trajectory.push_back(pose);
  }
  if (trajectory.empty()) {
    throw InputError(path.string() + ": no poses in it; rows of 'timestamp tx ty tz qx qy qz qw' are wanted");
  }
  if (repeated > 0) {
    log::warn("{}: {} rows repeat the timestamp of the row before and are left out", path.string(), repeated);
  }
  return trajectory;
}

std::string FormatTrajectory(const Trajectory& trajectory) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  text.reserve(text.size() + 112 * trajectory.size());
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d& t = pose.world_from_camera.translation;
    const Eigen::Quaterniond& q = pose.world_from_camera.rotation;
    Check(std::isfinite(pose.timestamp_s) && t.allFinite() && q.coeffs().allFinite(),
          "pose to be written is not finite");
    // Sized for the longest number that %.6f can make of a double, 309 digits before the point.
    char line[512];
    const int size = std::snprintf(line, sizeof line, "%.6f %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", pose.timestamp_s,
                                   t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
    text.append(line, static_cast<std::size_t>(size));
  }
  return text;
}

void WriteTrajectory(const std::filesystem::path& path, const Trajectory& trajectory) {
  WriteFileAtomically(path, FormatTrajectory(trajectory));
}

}  // namespace rds
