// SPDX-License-Identifier: Apache-2.0
// Options of the segmentation back ends.
#pragma once

#include <string>

namespace rds {

// What is dynamic unless said otherwise, as the paper has it.
inline constexpr const char* kDefaultDynamicClass = "person";

struct OpenVinoOptions {
  double threshold = 0;        // on the probability of a dynamic class, 0 .. 1; 0 = as the weights' description says
  double unsure = -1;          // above it, up to the threshold, a pixel says nothing; -1 = as the description says
  int threads = 1;             // that inference uses; one leaves the other cores to tracking
  int max_batch = 1;           // images a run of the network: 1, or 2 = a keyframe pair in one run
  std::string device = "CPU";  // as OpenVINO names devices
};

struct RemoteOptions {
  std::string url;          // of the model: http://HOST:PORT/v2/models/NAME
  std::string description;  // YAML of what the model wants and gives; "" = built in, or not needed
  double timeout_s = 5;     // for an answer
  int jpeg_quality = 0;     // of images where the server takes them raw or as JPEG; 0 = raw
};

struct SegmenterOptions {
  std::string dynamic_classes = kDefaultDynamicClass;  // names that the model gives its classes, with commas
  std::string model;         // weights: a file, "fast", "accurate", or "" = what is there (see ResolveWeights)
  OpenVinoOptions openvino;  // threshold, threads, images a run, device
  RemoteOptions remote;
  double stored_delay_ms = 200;  // time that a request to "stored" takes
};

}  // namespace rds
