// SPDX-License-Identifier: Apache-2.0
#include "segmentation/network_output.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace rds {
namespace {

std::size_t Count(std::span<const std::int64_t> shape) {
  std::size_t count = 1;
  for (const std::int64_t size : shape) {
    count *= static_cast<std::size_t>(std::max<std::int64_t>(size, 0));
  }
  return count;
}

void CheckOutput(const SegmentationModel& model, bool condition, const char* wanted) {
  if (!condition) {
    throw InputError(fmt::format("weights {}: the output has not {}; see the keys under output in {}.yaml",
                                 model.weights, wanted, model.weights));
  }
}

// The part of a batch's output that belongs to one image.
struct OneImage {
  std::vector<std::int64_t> shape;
  std::span<const float> values;
};

OneImage Part(const SegmentationModel& model, const OutputTensor& output, std::size_t index) {
  CheckOutput(model, !output.shape.empty() && output.values.size() == Count(output.shape), "the numbers of its shape");
  CheckOutput(model, index < static_cast<std::size_t>(output.shape[0]), "an answer for each image of the batch");
  const std::size_t size = output.values.size() / static_cast<std::size_t>(output.shape[0]);
  return {{output.shape.begin() + 1, output.shape.end()}, std::span(output.values).subspan(index * size, size)};
}

// Without dimensions of one: what is left are rows and columns.
OneImage Flat(const SegmentationModel& model, const OutputTensor& output, std::size_t index, const char* wanted) {
  OneImage one = Part(model, output, index);
  // Some networks leave out the dimension of a single image.
  if (one.shape.size() == 1 && index == 0 && output.shape.size() == 2) {
    one = {output.shape, output.values};
  }
  if (one.shape.size() > 2) {
    std::erase(one.shape, 1);
  }
  CheckOutput(model, one.shape.size() == 2, wanted);
  return one;
}

ScoreGrid GridOf(const SegmentationModel& model, int network_height, int network_width, std::int64_t rows,
                 std::int64_t columns) {
  return model.Grid(network_height, network_width, static_cast<int>(rows), static_cast<int>(columns));
}

bool IsDynamicClass(const SegmentationModel& model, float label) {
  return std::ranges::any_of(model.labels, [&](int wanted) { return static_cast<float>(wanted) == label; });
}

// A box in pixels of the network's input, edges included and excluded.
struct Box {
  double left = 0;
  double top = 0;
  double right = 0;
  double bottom = 0;
};

Box BoxOf(const SegmentationModel& model, std::span<const float> corners, int network_height, int network_width) {
  const bool x_first = model.box_order == SegmentationModel::BoxOrder::kXyxy;
  Box box{corners[x_first ? 0 : 1], corners[x_first ? 1 : 0], corners[x_first ? 2 : 3], corners[x_first ? 3 : 2]};
  if (model.boxes_are_relative) {
    box = {box.left * network_width, box.top * network_height, box.right * network_width, box.bottom * network_height};
  }
  const auto within = [](double value, int most) {
    return std::isfinite(value) ? std::clamp(value, 0.0, 1.0 * most) : 0;
  };
  return {within(box.left, network_width), within(box.top, network_height), within(box.right, network_width),
          within(box.bottom, network_height)};
}

// A small image of probabilities, to be stretched over a box.
struct Patch {
  std::span<const float> values;
  int rows = 0;
  int columns = 0;

  [[nodiscard]] float At(double row, double column) const {
    const double y = std::clamp(row, 0.0, rows - 1.0);
    const double x = std::clamp(column, 0.0, columns - 1.0);
    const int y0 = static_cast<int>(y);
    const int x0 = static_cast<int>(x);
    const int y1 = std::min(y0 + 1, rows - 1);
    const int x1 = std::min(x0 + 1, columns - 1);
    const auto value = [&](int r, int c) {
      return static_cast<double>(values[static_cast<std::size_t>(r * columns + c)]);
    };
    const double top = value(y0, x0) + (x - x0) * (value(y0, x1) - value(y0, x0));
    const double bottom = value(y1, x0) + (x - x0) * (value(y1, x1) - value(y1, x0));
    return static_cast<float>(top + (y - y0) * (bottom - top));
  }
};

// Lays the patch over its box; each pixel keeps the greater probability.
void Paste(const Patch& patch, const Box& box, int network_width, std::vector<float>& probability) {
  const double width = box.right - box.left;
  const double height = box.bottom - box.top;
  if (!(width > 0 && height > 0)) {
    return;
  }
  for (int y = static_cast<int>(std::ceil(box.top - 0.5)); y + 0.5 < box.bottom; ++y) {
    for (int x = static_cast<int>(std::ceil(box.left - 0.5)); x + 0.5 < box.right; ++x) {
      const double row = (y + 0.5 - box.top) / height * patch.rows - 0.5;
      const double column = (x + 0.5 - box.left) / width * patch.columns - 0.5;
      float& pixel = probability[static_cast<std::size_t>(y * network_width + x)];
      pixel = std::max(pixel, patch.At(row, column));
    }
  }
}

// The union of the dynamic classes' instances above the score (Liu and Miura 2021, section IV-C).
std::vector<float> UnionOfInstances(const SegmentationModel& model, std::span<const OutputTensor> outputs,
                                    int network_height, int network_width) {
  const auto& [boxes, scores, classes, masks] = std::tie(outputs[0], outputs[1], outputs[2], outputs[3]);
  const std::size_t instances = scores.values.size();
  CheckOutput(model, boxes.values.size() == 4 * instances && boxes.values.size() == Count(boxes.shape),
              "four corners for each score");
  CheckOutput(model, classes.values.size() == instances, "a class for each score");
  CheckOutput(model, masks.shape.size() >= 3 && masks.values.size() == Count(masks.shape), "masks of two dimensions");
  const auto rows = static_cast<int>(masks.shape[masks.shape.size() - 2]);
  const auto columns = static_cast<int>(masks.shape[masks.shape.size() - 1]);
  const std::size_t area = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
  CheckOutput(model, masks.values.size() == instances * area, "a mask for each score");
  const bool whole = rows == network_height && columns == network_width;
  std::vector<float> probability(static_cast<std::size_t>(network_height) * static_cast<std::size_t>(network_width), 0);
  for (std::size_t i = 0; i < instances; ++i) {
    if (!(static_cast<double>(scores.values[i]) >= model.score) || !IsDynamicClass(model, classes.values[i])) {
      continue;
    }
    const Patch patch{std::span(masks.values).subspan(i * area, area), rows, columns};
    const Box box = whole ? Box{0, 0, 1.0 * network_width, 1.0 * network_height}
                          : BoxOf(model, std::span(boxes.values).subspan(4 * i, 4), network_height, network_width);
    Paste(patch, box, network_width, probability);
  }
  return probability;
}

}  // namespace

MaskThresholds ThresholdsOf(const SegmentationModel& model, double threshold, double unsure) {
  const double dynamic = threshold > 0 ? threshold : model.threshold;
  return {static_cast<float>(dynamic), static_cast<float>(std::min(unsure >= 0 ? unsure : model.unsure, dynamic))};
}

std::vector<std::string> OutputNames(const SegmentationModel& model) {
  return model.output == SegmentationModel::Output::kInstances
             ? std::vector<std::string>{model.boxes_tensor, model.scores_tensor, model.classes_tensor,
                                        model.masks_tensor}
             : std::vector<std::string>{model.output_tensor};
}

Image8 MaskOfOutput(const SegmentationModel& model, const MaskThresholds& thresholds,
                    std::span<const OutputTensor> outputs, std::size_t index, int network_height, int network_width,
                    int width, int height) {
  CheckOutput(model, outputs.size() == OutputNames(model).size(), "the tensors that the description names");
  const auto grid = [&](std::int64_t rows, std::int64_t columns) {
    return GridOf(model, network_height, network_width, rows, columns);
  };
  const auto masked = [&](std::span<const float> probability, const ScoreGrid& cells) {
    return MaskFromProbability(probability, cells, width, height, thresholds.dynamic, thresholds.unsure);
  };
  switch (model.output) {
    case SegmentationModel::Output::kLabels: {
      const OneImage one = Flat(model, outputs[0], index, "two dimensions of labels");
      const std::vector<int> cells(one.values.begin(), one.values.end());
      return MaskFromLabels(cells, grid(one.shape[0], one.shape[1]), width, height, model.labels);
    }
    case SegmentationModel::Output::kMask: {
      const OneImage one = Flat(model, outputs[0], index, "two dimensions of a mask");
      CheckOutput(model, std::ranges::all_of(one.values, [](float v) { return std::isfinite(v); }), "finite numbers");
      const bool bytes = std::ranges::any_of(one.values, [](float v) { return v > 1; });  // 0 to 255
      std::vector<float> probability(one.values.begin(), one.values.end());
      for (float& value : probability) {
        value /= bytes ? 255.0F : 1.0F;
      }
      return masked(probability, grid(one.shape[0], one.shape[1]));
    }
    case SegmentationModel::Output::kInstances:
      return masked(UnionOfInstances(model, outputs, network_height, network_width),
                    model.PixelGrid(network_height, network_width));
    case SegmentationModel::Output::kLogits:
      break;
  }
  const OneImage one = Part(model, outputs[0], index);
  CheckOutput(model, one.shape.size() == 3, "three dimensions of logits");
  const bool first = model.output_order == ChannelOrder::kFirst;
  const auto classes = static_cast<int>(first ? one.shape[0] : one.shape[2]);
  const ScoreGrid cells = grid(first ? one.shape[1] : one.shape[0], first ? one.shape[2] : one.shape[1]);
  CheckOutput(model, *std::ranges::max_element(model.labels) < classes, "more classes than labels");
  return masked(ClassProbability(one.values, cells.width * cells.height, classes, model.output_order, model.labels),
                cells);
}

}  // namespace rds
