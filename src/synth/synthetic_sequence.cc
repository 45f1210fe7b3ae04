// SPDX-License-Identifier: Apache-2.0
#include "synth/synthetic_sequence.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <deque>
#include <future>
#include <string>
#include <thread>
#include <vector>

#include "base/error.h"
#include "io/atomic_file.h"
#include "io/camera_file.h"
#include "io/image_io.h"
#include "io/trajectory_io.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

// Not through a link: it may be somebody else's.
void WriteBytes(const fs::path& path, const std::string& bytes) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
  int error = file < 0 ? errno : 0;
  for (std::size_t done = 0; error == 0 && done < bytes.size();) {
    const ssize_t count = write(file, bytes.data() + done, bytes.size() - done);
    error = count < 0 && errno != EINTR ? errno : 0;
    done += static_cast<std::size_t>(std::max<ssize_t>(count, 0));
  }
  if (file >= 0 && close(file) != 0 && error == 0) {
    error = errno;
  }
  if (error != 0) {
    throw InputError(path.string() + ": cannot be written: " + std::strerror(error) +
                     "; choose another --out folder or make room");
  }
}

struct EncodedFrame {
  std::array<std::string, 3> images;  // color, depth, mask
  StampedPose truth;
};

EncodedFrame RenderEncoded(const SyntheticWorld& world, int index) {
  const SyntheticFrame frame = world.Render(index);
  return {{EncodePng(*frame.rgbd.image, 1), EncodePng(*frame.rgbd.depth, 1), EncodePng(*frame.mask, 1)},
          {frame.rgbd.timestamp_s, frame.world_from_camera}};
}

}  // namespace

void WriteSyntheticSequence(const SyntheticWorld& world, const fs::path& directory,
                            const std::function<void(int)>& on_frame) {
  PrepareOutputFolder(directory);
  constexpr std::array<const char*, 3> kFolders{"rgb", "depth", "mask"};
  std::array<std::string, 3> lists;
  for (std::size_t i = 0; i < kFolders.size(); ++i) {
    PrepareOutputFolder(directory / kFolders[i]);
    lists[i] = "# timestamp filename\n";
  }
  std::string associations;
  Trajectory truth;
  // One frame in the making for each core; they are written in their order.
  const auto ahead = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  std::deque<std::future<EncodedFrame>> rendering;
  for (int i = 0; i < world.frame_count() + ahead; ++i) {
    if (i < world.frame_count()) {
      rendering.push_back(std::async(std::launch::async, [&world, i] { return RenderEncoded(world, i); }));
    }
    if (i < ahead) {
      continue;
    }
    const EncodedFrame frame = rendering.front().get();
    rendering.pop_front();
    const std::string stamp = fmt::format("{:.6f}", frame.truth.timestamp_s);
    for (std::size_t k = 0; k < kFolders.size(); ++k) {
      WriteBytes(directory / kFolders[k] / (stamp + ".png"), frame.images[k]);
      lists[k] += fmt::format("{0} {1}/{0}.png\n", stamp, kFolders[k]);
    }
    associations += fmt::format("{0} rgb/{0}.png {0} depth/{0}.png\n", stamp);
    truth.push_back(frame.truth);
    if (on_frame) {
      on_frame(i - ahead + 1);
    }
  }
  const std::array<OutputFile, 6> files{{{directory / "rgb.txt", lists[0]},
                                         {directory / "depth.txt", lists[1]},
                                         {directory / "mask.txt", lists[2]},
                                         {directory / "associations.txt", associations},
                                         {directory / "groundtruth.txt", FormatTrajectory(truth)},
                                         {directory / "camera.yaml", FormatCamera(world.camera())}}};
  WriteFilesAtomically(files);
}

}  // namespace rds
