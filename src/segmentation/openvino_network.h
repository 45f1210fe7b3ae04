// SPDX-License-Identifier: Apache-2.0
// From a weights file to the graph that OpenVINO compiles. Only for builds with OpenVINO.
#pragma once

#include <memory>
#include <string>

#include "segmentation/segmentation_model.h"

namespace ov {
class Model;
}  // namespace ov

namespace rds {

// The file's whole graph, read as the format that its name says. Throws InputError for a file that cannot be read: one
// that is damaged, cut short, or no model.
[[nodiscard]] std::shared_ptr<ov::Model> ReadNetworkFile(const std::string& weights);

// Reads the file and makes of its graph what the description says: ended at the tensor named, freed of the rounding of
// quantized networks, reshaped. Throws InputError for a file that cannot be read (naming `rds fetch weights`) and for a
// graph that the description does not fit.
[[nodiscard]] std::shared_ptr<ov::Model> ReadNetwork(const SegmentationModel& model);

// A copy of the network that takes `batch` recorded images (u8, NHWC, BGR, width x height) and converts them itself.
// Outputs: all f32.
[[nodiscard]] std::shared_ptr<ov::Model> WithPreprocessing(const ov::Model& network, const SegmentationModel& model,
                                                           int width, int height, int batch);

}  // namespace rds
