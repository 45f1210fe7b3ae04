// SPDX-License-Identifier: Apache-2.0
// From the words of the command line to a segmentation back end.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "segmentation/openvino_segmenter.h"
#include "segmentation/segmenter.h"
#include "segmentation/segmenter_options.h"
#include "segmentation/stored_segmenter.h"

namespace rds {

// The back ends' names, as --segmenter takes them: "openvino", "remote", "stored", "geometry", "none".
[[nodiscard]] const std::vector<std::string>& SegmenterNames();

// The back end of that name; null for "none". `masks` are the sequence's, for "stored", and
// `mask_reader` reads them. Throws InputError where it
// cannot be had (unknown name, no runtime, no weights, no masks), naming the ways out: never a silent run without
// semantics.
[[nodiscard]] std::unique_ptr<Segmenter> MakeSegmenter(const std::string& name, const SegmenterOptions& options,
                                                       std::vector<StoredMask> masks, MaskReader mask_reader);

// The weights file meant by `model`: a path; "fast" or "accurate", fetched before into the cache folder; or, for "",
// $RDS_WEIGHTS (a path or such a name), else what the cache folder has, "accurate" before "fast". Throws InputError
// naming the ways out if there is none.
[[nodiscard]] std::string ResolveWeights(const std::string& model);

}  // namespace rds
