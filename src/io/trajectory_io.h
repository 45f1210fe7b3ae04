// SPDX-License-Identifier: Apache-2.0
// Trajectories in the TUM benchmark's text format: "timestamp tx ty tz qx qy qz qw", seconds and meters, # for
// comments.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "geometry/trajectory.h"

namespace rds {

// Reads a trajectory (estimate or ground truth): TUM's format, or columns named by a heading (EuRoC, csv), in seconds
// or in whole milli-, micro- or nanoseconds. Quaternions are normalized. Left out with a warning that counts them: rows
// with the timestamp of another (some recordings repeat a sample), with NaN, with a quaternion of zeros; rows out of
// order are sorted, with a warning. `frame_times`: the times of a sequence's frames, for files of KITTI's form (twelve
// columns without times, a row for each frame), and for frame numbers instead of times. InputError, naming file and
// line, for an unreadable or empty file, columns whose meaning is not certain, a word that is no number, a quaternion
// far from unit norm, and positions farther away than the moon.
Trajectory ReadTrajectory(const std::filesystem::path& path, std::span<const double> frame_times = {});

// The same text for the same poses on every machine: timestamps with 6 decimals, poses with 9 significant digits.
// InvariantError if a pose is not finite.
std::string FormatTrajectory(const Trajectory& trajectory);

// Writes FormatTrajectory, all or nothing (see io/atomic_file.h).
void WriteTrajectory(const std::filesystem::path& path, const Trajectory& trajectory);

}  // namespace rds
