// SPDX-License-Identifier: Apache-2.0
#include "io/trajectory_io.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/log.h"
#include "io/atomic_file.h"
#include "io/text_table.h"
#include "io/time_unit.h"
#include "io/trajectory_columns.h"

namespace rds {
namespace {

constexpr std::array<const char*, 8> kColumns = {"timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"};
constexpr double kNormTolerance = 0.1;  // published quaternions have four decimals or more
constexpr double kFarthest_m = 1e9;

void CheckPosition(const TextTable& table, const TextRow& row, const Eigen::Vector3d& position) {
  if (position.cwiseAbs().maxCoeff() > kFarthest_m) {
    char value[32];
    std::snprintf(value, sizeof value, "%.3g", position.cwiseAbs().maxCoeff());
    throw InputError(table.Where(row) + ": a position of " + value +
                     " m is farther away than the moon; is the file damaged, or are these no meters?");
  }
}

// Nothing for a row that says that there is no pose: NaN, or a quaternion of zeros.
std::optional<StampedPose> ParsePose(const TextTable& table, const TextRow& row, const PoseColumns& columns) {
  if (row.fields.size() <= *std::ranges::max_element(columns)) {
    throw InputError(table.Where(row) + ": " + std::to_string(row.fields.size()) +
                     " columns, 8 are wanted: timestamp tx ty tz qx qy qz qw");
  }
  std::array<double, kColumns.size()> value{};
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    const std::optional<double> number = ParseNumber(row.fields[columns[i]]);
    if (number && !std::isfinite(*number) && i > 0) {
      return std::nullopt;
    }
    value[i] = table.Number(row, columns[i], kColumns[i]);
  }
  const Eigen::Quaterniond rotation(value[7], value[4], value[5], value[6]);
  if (rotation.norm() == 0) {
    return std::nullopt;
  }
  if (!(std::abs(rotation.norm() - 1) <= kNormTolerance)) {
    char norm[32];
    std::snprintf(norm, sizeof norm, "%.3g", rotation.norm());
    throw InputError(table.Where(row) + ": the quaternion (qx qy qz qw, columns 5 to 8) has norm " + norm +
                     "; a rotation has norm 1");
  }
  const Eigen::Vector3d position{value[1], value[2], value[3]};
  CheckPosition(table, row, position);
  return StampedPose{value[0], {rotation.normalized(), position}};
}

// Rows of the upper three rows of a matrix, as KITTI has them.
Trajectory ParseMatrices(const TextTable& table, std::span<const double> frame_times) {
  Trajectory trajectory;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const TextRow& row = table.rows[i];
    if (row.fields.size() != 12) {
      throw InputError(table.Where(row) + ": " + std::to_string(row.fields.size()) +
                       " columns, the rows before have 12");
    }
    Eigen::Matrix<double, 3, 4, Eigen::RowMajor> matrix;
    for (std::size_t k = 0; k < 12; ++k) {
      matrix.data()[k] = table.Number(row, k, "an entry of the matrix");
    }
    const Eigen::Matrix3d rotation = matrix.leftCols<3>();
    if (!((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < kNormTolerance) ||
        !(rotation.determinant() > 0)) {
      throw InputError(table.Where(row) + ": the matrix (columns 1 to 3, 5 to 7, 9 to 11) is no rotation");
    }
    CheckPosition(table, row, matrix.col(3));
    trajectory.push_back({frame_times[i], {Eigen::Quaterniond(rotation).normalized(), matrix.col(3)}});
  }
  return trajectory;
}

void ToSeconds(const TextTable& table, bool frames_known, Trajectory& trajectory) {
  std::vector<double> times;
  for (const StampedPose& pose : trajectory) {
    times.push_back(pose.timestamp_s);
  }
  std::ranges::sort(times);
  const TimeUnit unit = GuessTimeUnit(times, true);
  if (unit == TimeUnit::kSeconds || (unit == TimeUnit::kFrames && !frames_known)) {
    return;
  }
  log::info("{}: times are {}", table.path.string(), NameOf(unit));
  for (StampedPose& pose : trajectory) {
    pose.timestamp_s *= SecondsIn(unit);
  }
}

// Sorted, each time once; says what had to be done.
void PutInOrder(const TextTable& table, Trajectory& trajectory) {
  const auto earlier = [](const StampedPose& a, const StampedPose& b) { return a.timestamp_s < b.timestamp_s; };
  if (!std::ranges::is_sorted(trajectory, earlier)) {
    log::warn("{}: timestamps are not in order; the rows are sorted", table.path.string());
    std::stable_sort(trajectory.begin(), trajectory.end(), earlier);
  }
  const auto rest = std::ranges::unique(trajectory, {}, &StampedPose::timestamp_s);
  if (!rest.empty()) {
    log::warn("{}: {} rows repeat the timestamp of the row before and are left out", table.path.string(), rest.size());
    trajectory.erase(rest.begin(), rest.end());
  }
}

InputError UnknownColumns(const TextTable& table) {
  const std::size_t count = table.rows.front().fields.size();
  const std::string where = table.Where(table.rows.front()) + ": " + std::to_string(count) + " columns, ";
  return InputError(count == 12 ? where + "as KITTI has them: no times, and not a row for each frame of a sequence"
                                : where + "8 are wanted: timestamp tx ty tz qx qy qz qw");
}

}  // namespace

Trajectory ReadTrajectory(const std::filesystem::path& path, std::span<const double> frame_times) {
  const TextTable table = ReadTextTable(path);
  if (table.rows.empty()) {
    throw InputError(path.string() + ": no poses in it; rows of 'timestamp tx ty tz qx qy qz qw' are wanted");
  }
  const std::optional<PoseColumns> columns = FindPoseColumns(table);
  if (!columns) {
    if (table.rows.front().fields.size() == 12 && table.rows.size() == frame_times.size()) {
      return ParseMatrices(table, frame_times);
    }
    throw UnknownColumns(table);
  }
  Trajectory trajectory;
  trajectory.reserve(table.rows.size());
  std::size_t without_pose = 0;
  for (const TextRow& row : table.rows) {
    if (const std::optional<StampedPose> pose = ParsePose(table, row, *columns)) {
      trajectory.push_back(*pose);
    } else if (++without_pose == 1) {
      log::warn("{}: no pose in this row (NaN, or a quaternion of zeros); such rows are left out", table.Where(row));
    }
  }
  if (trajectory.empty()) {
    throw InputError(path.string() + ": no poses in it: every row is NaN or has a quaternion of zeros");
  }
  if (without_pose > 1) {
    log::warn("{}: {} of {} rows have no pose", path.string(), without_pose, table.rows.size());
  }
  ToSeconds(table, !frame_times.empty(), trajectory);
  PutInOrder(table, trajectory);
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
