// SPDX-License-Identifier: Apache-2.0
// Options of the segmentation back ends.
#pragma once

#include <string>

namespace rds {

struct OpenVinoOptions {
  double threshold = 0;        // on the probability of a dynamic class, 0 .. 1; 0 = as the weights' description says
  double unsure = -1;          // above it, up to the threshold, a pixel says nothing; -1 = as the description says
  int threads = 1;             // that inference uses; one leaves the other cores to tracking
  int max_batch = 1;           // images a run of the network: 1, or 2 = a keyframe pair in one run
  std::string device = "CPU";  // as OpenVINO names devices
};

struct SegmenterOptions {
  std::string model;             // weights: a file, "fast", "accurate", or "" = what is there (see ResolveWeights)
  OpenVinoOptions openvino;      // threshold, threads, images a run, device
  double stored_delay_ms = 200;  // time that a request to "stored" takes
};

}  // namespace rds
