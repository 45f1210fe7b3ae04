// SPDX-License-Identifier: Apache-2.0
#include "io/sequence_fetch.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/SVD>
#include <algorithm>
#include <system_error>

#include "base/error.h"
#include "base/file.h"
#include "base/suggest.h"
#include "io/archive.h"
#include "io/atomic_file.h"
#include "io/dataset.h"
#include "io/download.h"
#include "io/trajectory_io.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kLargestSequence_bytes = std::int64_t{64} << 30;
constexpr const char* kTumBegin = "rgbd_dataset_freiburg";
constexpr const char* kBonnBegin = "rgbd_bonn_";

std::string TumName(const std::string& text) { return kTumBegin + text; }
std::string BonnName(const std::string& text) { return kBonnBegin + text; }

std::vector<std::string> WithBeginning(std::string (*full)(const std::string&),
                                       std::initializer_list<const char*> names) {
  std::vector<std::string> all;
  std::ranges::transform(names, std::back_inserter(all), full);
  return all;
}

// "fr3/walking_xyz" and "freiburg3_walking_xyz" say "3_walking_xyz".
std::string Shortened(std::string name) {
  for (const char* const beginning : {kTumBegin, kBonnBegin, "freiburg", "fr"}) {
    if (name.starts_with(beginning)) {
      name.erase(0, std::string(beginning).size());
    }
  }
  std::ranges::replace(name, '/', '_');
  return name;
}

std::string UrlOf(const std::string& base, const std::string& archive) {
  return base + (base.ends_with('/') ? "" : "/") + archive;
}

void Complete(const std::string& url, const fs::path& part, std::int64_t bytes, const FetchSequenceProgress& progress) {
  constexpr int kTries = 5;
  std::string problem;
  for (int i = 0; i < kTries; ++i) {
    const DownloadResult result = Download(url, part, bytes, [&](std::int64_t done, std::int64_t total) {
      progress(FetchStage::kDownloading, done, total);
    });
    if (result.complete) {
      return;
    }
    problem = result.problem;
    if (!result.worth_retrying) {
      break;
    }
  }
  throw InputError(problem);
}

// Whether a folder is a sequence with all its images.
bool IsWhole(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return false;
  }
  try {
    return Dataset::Open(folder).ground_truth().has_value();
  } catch (const InputError&) {
    return false;
  }
}

// What was unpacked is a sequence with all that its lists name.
void CheckSequence(const fs::path& folder) {
  try {
    if (!Dataset::Open(folder).ground_truth()) {
      throw ArchiveError(folder.string() + ": no ground truth that can be read");
    }
  } catch (const InputError& problem) {
    throw ArchiveError(problem.what());
  }
}

void MakeTruthOfCamera(const fs::path& folder) {
  const fs::path truth = folder / "groundtruth.txt";
  const fs::path markers = folder / "groundtruth.markers.txt";
  const Trajectory poses = ReadTrajectory(truth);
  const std::string text =
      "# poses of the camera, from those of the markers (groundtruth.markers.txt) by the transforms of\n"
      "# https://www.ipb.uni-bonn.de/data/rgbd-dynamic-dataset/\n# timestamp tx ty tz qx qy qz qw\n" +
      FormatTrajectory(CameraFromBonnMarkers(poses));
  WriteFileAtomically(markers, ReadFile(truth));
  WriteFileAtomically(truth, text);
}

void Rename(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) {
    throw InputError(fmt::format("{}: cannot be renamed to {}: {}", from.string(), to.string(), error.message()));
  }
}

}  // namespace

const std::vector<Benchmark>& Benchmarks() {
  static const std::vector<Benchmark> benchmarks = {
      {"tum", "https://cvg.cit.tum.de/rgbd/dataset",
       WithBeginning(&TumName, {"3_walking_halfsphere",
                                "3_walking_rpy",
                                "3_walking_static",
                                "3_walking_xyz",
                                "3_sitting_halfsphere",
                                "3_sitting_rpy",
                                "3_sitting_static",
                                "3_sitting_xyz",
                                "3_long_office_household",
                                "3_teddy",
                                "2_desk_with_person",
                                "2_desk",
                                "2_xyz",
                                "2_rpy",
                                "2_large_with_loop",
                                "1_xyz",
                                "1_rpy",
                                "1_360",
                                "1_desk",
                                "1_desk2",
                                "1_floor",
                                "1_plant",
                                "1_room",
                                "1_teddy"}),
       WithBeginning(&TumName, {"3_walking_halfsphere", "3_walking_rpy", "3_walking_static", "3_walking_xyz",
                                "3_sitting_static"})},
      {"bonn", "https://www.ipb.uni-bonn.de/html/projects/rgbd_dynamic2019",
       WithBeginning(&BonnName, {"balloon",
                                 "balloon2",
                                 "balloon_tracking",
                                 "balloon_tracking2",
                                 "crowd",
                                 "crowd2",
                                 "crowd3",
                                 "kidnapping_box",
                                 "kidnapping_box2",
                                 "moving_nonobstructing_box",
                                 "moving_nonobstructing_box2",
                                 "moving_obstructing_box",
                                 "moving_obstructing_box2",
                                 "person_tracking",
                                 "person_tracking2",
                                 "placing_nonobstructing_box",
                                 "placing_nonobstructing_box2",
                                 "placing_nonobstructing_box3",
                                 "placing_obstructing_box",
                                 "removing_nonobstructing_box",
                                 "removing_nonobstructing_box2",
                                 "removing_obstructing_box",
                                 "synchronous",
                                 "synchronous2",
                                 "static",
                                 "static_close_far"}),
       WithBeginning(&BonnName, {"balloon", "crowd", "person_tracking", "moving_nonobstructing_box"})}};
  return benchmarks;
}

PublishedSequence FindSequence(const Benchmark& benchmark, const std::string& name) {
  const std::string wanted = Shortened(name);
  std::vector<std::string> found;
  for (const std::string& known : benchmark.sequences) {
    const std::string brief = Shortened(known);
    const bool is_tum = benchmark.name == "tum";
    if (brief == wanted || (is_tum && brief.substr(2) == wanted)) {
      found.push_back(known);
    }
  }
  if (found.size() != 1) {
    std::vector<std::string> names;
    std::ranges::transform(benchmark.sequences, std::back_inserter(names), Shortened);
    throw InputError(fmt::format("rds fetch {}: '{}' is {}{}; there are {}", benchmark.name, name,
                                 found.empty() ? "unknown" : "ambiguous", Suggestion(wanted, names),
                                 fmt::join(benchmark.sequences, ", ")));
  }
  if (benchmark.name == "tum") {
    const std::string camera = found[0].substr(std::string("rgbd_dataset_").size(), std::string("freiburg3").size());
    return {found[0], fmt::format("{}/{}.tgz", camera, found[0]), false};
  }
  return {found[0], found[0] + ".zip", true};
}

fs::path FetchSequence(const PublishedSequence& sequence, const fs::path& folder, const std::string& url_base,
                       const FetchSequenceProgress& progress) {
  const fs::path target = folder / sequence.name;
  if (IsWhole(target)) {
    return target;
  }
  std::error_code error;
  if (fs::exists(target, error)) {
    throw InputError(target.string() + ": is there, but is no whole sequence; remove it, then fetch again");
  }
  PrepareOutputFolder(folder);
  const std::string url = UrlOf(url_base, sequence.archive);
  const fs::path part = folder / (fs::path(sequence.archive).filename().string() + ".part");
  const fs::path staging = folder / ("." + sequence.name + ".unpacking");
  const std::int64_t bytes = RemoteSize(url);
  Complete(url, part, bytes, progress);
  fs::remove_all(staging, error);
  try {
    Unpack(part, staging, kLargestSequence_bytes,
           [&](std::int64_t done) { progress(FetchStage::kUnpacking, done, bytes); });
    progress(FetchStage::kChecking, bytes, bytes);
    const fs::path unpacked = staging / sequence.name;
    CheckSequence(unpacked);
    if (sequence.marker_truth) {
      MakeTruthOfCamera(unpacked);
    }
    Rename(unpacked, target);
  } catch (const ArchiveError& problem) {
    fs::remove_all(staging, error);
    fs::remove(part, error);  // what it holds is no sequence: fetched anew the next time
    throw InputError(fmt::format("{}: what came is not the sequence that was published: {}", url, problem.what()));
  } catch (...) {
    fs::remove_all(staging, error);
    throw;
  }
  fs::remove_all(staging, error);
  fs::remove(part, error);
  return target;
}

Trajectory CameraFromBonnMarkers(Trajectory markers) {
  Eigen::Matrix3d ros;
  ros << -1, 0, 0, 0, 0, 1, 0, 1, 0;
  Eigen::Matrix3d marker;
  marker << 1.0157, 0.1828, -0.2389, 0.0009, -0.8431, -0.6413, -0.3009, 0.6147, -0.8085;
  const Eigen::Vector3d marker_at(0.0113, -0.0098, 0.0111);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(marker, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
  Check(rotation.determinant() > 0, "the published transform is a rotation");
  for (StampedPose& pose : markers) {
    const Eigen::Matrix3d turned = ros.transpose() * pose.world_from_camera.RotationMatrix() * ros;
    const Eigen::Vector3d at = ros.transpose() * pose.world_from_camera.translation;
    pose.world_from_camera = Rigid3{Eigen::Quaterniond(turned * rotation).normalized(), turned * marker_at + at};
  }
  return markers;
}

}  // namespace rds
