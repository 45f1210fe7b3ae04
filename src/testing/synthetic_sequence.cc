#include "testing/synthetic_sequence.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "base/error.h"
#include "io/atomic_file.h"
#include "io/camera_config.h"
#include "io/trajectory_io.h"

namespace rds {
namespace {

namespace fs = std::filesystem;

void WriteBytes(const fs::path& path, const std::vector<unsigned char>& bytes) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) {
    throw InputError(path.string() + ": cannot be written: " + (errno != 0 ? std::strerror(errno) : "unknown reason") +
                     "; choose another --out folder or make room");
  }
}

template <typename T>
void WritePng(const fs::path& path, const Image<T>& image, int type) {
  const cv::Mat view(image.height, image.width, type, const_cast<T*>(image.data.data()));
  std::vector<unsigned char> bytes;
  Check(cv::imencode(".png", view, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1}), "PNG cannot be encoded");
  WriteBytes(path, bytes);
}

void MakeFolder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) {
    throw InputError(path.string() + ": cannot be created: " + error.message() + "; choose another --out folder");
  }
}

}  // namespace

void WriteSyntheticSequence(const SyntheticWorld& world, const fs::path& directory,
                            const std::function<void(int)>& on_frame) {
  PrepareOutputFolder(directory);
  constexpr std::array<const char*, 3> kFolders{"rgb", "depth", "mask"};
  std::array<std::string, 3> lists;
  for (std::size_t i = 0; i < kFolders.size(); ++i) {
    MakeFolder(directory / kFolders[i]);
    lists[i] = "# timestamp filename\n";
  }
  std::string associations;
  Trajectory truth;
  for (int i = 0; i < world.frame_count(); ++i) {
    const SyntheticFrame frame = world.Render(i);
    const std::string stamp = fmt::format("{:.6f}", frame.rgbd.timestamp_s);
    WritePng(directory / "rgb" / (stamp + ".png"), *frame.rgbd.image, CV_8UC3);
    WritePng(directory / "depth" / (stamp + ".png"), *frame.rgbd.depth, CV_16UC1);
    WritePng(directory / "mask" / (stamp + ".png"), *frame.mask, CV_8UC1);
    for (std::size_t k = 0; k < kFolders.size(); ++k) {
      lists[k] += fmt::format("{0} {1}/{0}.png\n", stamp, kFolders[k]);
    }
    associations += fmt::format("{0} rgb/{0}.png {0} depth/{0}.png\n", stamp);
    truth.push_back({frame.rgbd.timestamp_s, frame.world_from_camera});
    if (on_frame) {
      on_frame(i + 1);
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
