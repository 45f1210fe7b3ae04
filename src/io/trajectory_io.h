// Trajectories in the TUM benchmark's text format: "timestamp tx ty tz qx qy qz qw", seconds and metres, # for
// comments.
#pragma once

#include <filesystem>
#include <string>

#include "geometry/trajectory.h"

namespace rds {

// Reads a trajectory (estimate or ground truth). Quaternions are normalised. A row with the same timestamp as the row
// before (some recordings repeat a sample) is left out, with a warning that counts them. InputError, naming file and
// line, for an unreadable or empty file, a malformed row, a number that is not finite, a quaternion far from unit norm,
// and timestamps out of order.
Trajectory ReadTrajectory(const std::filesystem::path& path);

// The same text for the same poses on every machine: timestamps with 6 decimals, poses with 9 significant digits.
// InvariantError if a pose is not finite.
std::string FormatTrajectory(const Trajectory& trajectory);

// Writes FormatTrajectory, all or nothing (see io/atomic_file.h).
void WriteTrajectory(const std::filesystem::path& path, const Trajectory& trajectory);

}  // namespace rds
