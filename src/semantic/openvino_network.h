// From a weights file to the graph that OpenVINO compiles. Only for builds with OpenVINO.
#pragma once

#include <memory>

#include "semantic/segmentation_model.h"

namespace ov {
class Model;
}  // namespace ov

namespace rds {

// Reads the file and makes of its graph what the description says: ended at the tensor named, freed of the rounding of
// quantised networks, reshaped. Throws InputError for a file that cannot be read (naming `rds fetch weights`) and for a
// graph that the description does not fit.
[[nodiscard]] std::shared_ptr<ov::Model> ReadNetwork(const SegmentationModel& model);

// A copy of the network that takes `batch` recorded images (u8, NHWC, BGR, width x height) and converts them itself.
// Output: f32 logits or i32 labels.
[[nodiscard]] std::shared_ptr<ov::Model> WithPreprocessing(const ov::Model& network, const SegmentationModel& model,
                                                           int width, int height, int batch);

}  // namespace rds
