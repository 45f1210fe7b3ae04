// SPDX-License-Identifier: Apache-2.0
// Fetching sequences of the TUM and Bonn RGB-D benchmarks from their own addresses.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "geometry/trajectory.h"

namespace rds {

// One sequence as its benchmark publishes it.
struct PublishedSequence {
  std::string name;           // of the folder: "rgbd_dataset_freiburg3_walking_xyz"
  std::string archive;        // below the benchmark's address: "freiburg3/rgbd_dataset_freiburg3_walking_xyz.tgz"
  bool marker_truth = false;  // its ground truth is that of markers on the camera (Bonn)
};

struct Benchmark {
  std::string name;                    // "tum"
  std::string url;                     // of its archives
  std::vector<std::string> sequences;  // names that are known; shorter ones name them, too
  std::vector<std::string> usual;      // what is fetched where none is named
};

// "tum" (Sturm et al., IROS 2012; CC BY 4.0) and "bonn" (Palazzolo et al., IROS 2019).
[[nodiscard]] const std::vector<Benchmark>& Benchmarks();

// The sequence called `name`: its folder's name, or that without its beginning ("walking_xyz", "fr3/walking_xyz",
// "balloon"). InputError with what was likely meant.
[[nodiscard]] PublishedSequence FindSequence(const Benchmark& benchmark, const std::string& name);

enum class FetchStage { kDownloading, kUnpacking, kChecking };
using FetchSequenceProgress = std::function<void(FetchStage stage, std::int64_t done, std::int64_t total)>;

// Brings a sequence into `folder`/NAME and returns that path. A sequence that is there and whole is left as it is. An
// interrupted download goes on where it stopped (NAME.tgz.part). The archive has the size that the server says, is
// unpacked beside the target, and becomes it only when each image that the lists name is there and their ground truth
// can be read. Ground truth of markers is made that of the camera; the original stays as groundtruth.markers.txt.
// InputError naming the address and what to do.
std::filesystem::path FetchSequence(const PublishedSequence& sequence, const std::filesystem::path& folder,
                                    const std::string& url_base, const FetchSequenceProgress& progress);

// The camera's poses from those of the Bonn benchmark's markers: T_ROS^-1 T T_ROS T_m, with the transforms of the
// benchmark's page (https://www.ipb.uni-bonn.de/data/rgbd-dynamic-dataset/); the rotation of T_m, which is published
// with four digits and a scale, is made the nearest one.
[[nodiscard]] Trajectory CameraFromBonnMarkers(Trajectory markers);

}  // namespace rds
