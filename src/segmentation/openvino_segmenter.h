// SPDX-License-Identifier: Apache-2.0
// The back end "openvino": a segmentation network run in this process by OpenVINO.
#pragma once

#include <memory>
#include <string>

#include "segmentation/segmentation_model.h"
#include "segmentation/segmenter.h"
#include "segmentation/segmenter_options.h"

namespace rds {

// Whether this build has the OpenVINO runtime.
[[nodiscard]] bool HasOpenVino();

// Throws InputError naming the ways out where this build has no OpenVINO.
void CheckOpenVino();

// Throws InputError for a file that is damaged, cut short or no network at all, whatever it wants and gives; and as
// CheckOpenVino does.
void CheckNetworkFile(const std::string& weights);

// Runs a network (.onnx, .tflite, or OpenVINO's .xml with its .bin). It is compiled for the image's size with the first
// request; a published file of the published size is read then, too (SLAM starts sooner; its digest was checked when it
// was fetched), any other one here. Gray images are run as gray BGR. Cancel interrupts a run under way. Thread-safe as
// Segmenter demands. Throws InputError as CheckOpenVino does, and for weights that cannot be read, such as a file cut
// short (naming `rds fetch weights`).
[[nodiscard]] std::unique_ptr<Segmenter> MakeOpenVinoSegmenter(const SegmentationModel& model,
                                                               const OpenVinoOptions& options);

// Version of the runtime; "" in a build without it.
[[nodiscard]] std::string OpenVinoVersion();

}  // namespace rds
