// SPDX-License-Identifier: Apache-2.0
// The back end "remote": a network that a server runs, asked by the Open Inference Protocol (KServe v2) over HTTP.
#pragma once

#include <memory>

#include "segmentation/segmenter.h"
#include "segmentation/segmenter_options.h"

namespace rds {

// How the server itself says that it is `rds serve`: its masks are taken as they are.
inline constexpr const char* kOwnPlatform = "rds";

// Asks the model at `options.url` (http://HOST:PORT/v2/models/NAME). What the model wants is read from its metadata:
// BYTES (pictures as JPEG), or UINT8 or FP32 of three channels; images are stretched to a fixed size and, for FP32,
// made what the description says. What it gives is described as for other networks (segmentation_model.h): in
// `options.description`, or built in for the published networks by their names; `rds serve` needs none. Two images go
// together where the model leaves the batch open.
//
// The connection is kept. What fails is tried again, three times within half a second, then Segment throws and the next
// request waits longer, up to five seconds, so that a server that is gone costs nothing and one that comes back, be it
// with another model, is found. Thread-safe as Segmenter demands.
//
// Throws InputError for an address that is none and for a model that the server says it does not have; where nobody
// answers it says so and goes on.
[[nodiscard]] std::unique_ptr<Segmenter> MakeRemoteSegmenter(const RemoteOptions& options,
                                                             const std::string& dynamic_classes);

}  // namespace rds
