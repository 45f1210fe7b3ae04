// SPDX-License-Identifier: Apache-2.0
// All options of the system: one struct a module, gathered here.
//
// To add an option: a member with its default in its module's struct, and one line in BindOptions (option_binding.cc).
#pragma once

#include <string>
#include <string_view>

#include "feature/orb_options.h"
#include "loop/loop_options.h"
#include "map/map_options.h"
#include "mapping/mapping_options.h"
#include "optim/optim_options.h"
#include "propagation/propagation_options.h"
#include "segmentation/segmenter_options.h"
#include "semantic/semantic_options.h"
#include "tracking/tracker_options.h"

namespace rds {

struct SystemOptions {
  bool lockstep = false;          // one thread, fixed order, same bytes every time
  bool keep_features = false;     // fill FrameResult::features, for drawing
  bool wait_for_mapping = false;  // Process waits for capacity in mapping's queue (frames faster than real time)
  int keyframe_queue = 3;         // keyframes that may wait for mapping
};

struct SemanticOptions {
  SelectionMode selection = SelectionMode::kBidirectional;
  int per_round = 2;      // keyframes selected in a round
  bool batch = true;      // in one request, or one by one
  std::string ignore;     // file of a mask of what is fixed to the camera; applied by who reads the images
  int backlog = 60;       // images of unlabeled keyframes kept at most
  int start_frames = 36;  // for which the map waits for the first label before it grows, at most
  int dilation_px = 15;   // radius at an image width of 640
  FreeSpaceOptions free_space;
  bool motion = true;             // what moves otherwise than most of the picture is dynamic, whatever it is
  double max_mask_ratio = 0.95;   // a mask that covers more says nothing
  double finish_timeout_s = 5;    // for labels still missing when the sequence ends
  double cancel_timeout_s = 2;    // for a back end to give up when asked to
  int lockstep_delay_frames = 6;  // lockstep: frames between a request and its labels
  MovingProbabilityOptions probability;
  SemanticOptimizerOptions optimizer;
};

struct AtlasOptions {
  double patience_s =
      1;  // of frames that a map could begin with, all of them lost: then another world begins; 0 = never
};

struct Options {
  SystemOptions system;
  OrbOptions orb;
  PoseOptimizerOptions pose;
  TrackerOptions tracking;
  PropagationOptions propagation;
  LocalMapOptions local_map;
  MappingOptions mapping;
  SemanticOptions semantic;
  LoopOptions loop;
  AtlasOptions atlas;
  SegmenterOptions segmenter;  // for MakeSegmenter; the system itself takes a ready one
};

// Sets one option from text. Throws InputError naming the key, the value and the range, or the nearest known key.
void SetOption(Options& options, std::string_view key, const std::string& value);

// The same for "key=value", as on the command line.
void SetOption(Options& options, const std::string& assignment);

// Throws InputError if a value lies out of its range or two options contradict each other.
void ValidateOptions(const Options& options);

}  // namespace rds
