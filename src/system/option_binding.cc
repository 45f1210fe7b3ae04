// SPDX-License-Identifier: Apache-2.0
#include "system/option_binding.h"

#include "base/error.h"

namespace rds {
namespace {

void BindSystem(SystemOptions& options, OptionTable& table) {
  table.Flag("system.lockstep", options.lockstep,
             "run everything on one thread in a fixed order, so that the same input gives the same bytes");
  table.Int("system.keyframe_queue", options.keyframe_queue, 1, 100, "capacity of mapping's queue, in keyframes");
}

void BindTracking(TrackerOptions& options, OptionTable& table) {
  table.Int("tracking.min_start_points", options.min_start_points, 10, 10000,
            "keypoints with depth that the first keyframe needs");
  table.Int("tracking.min_inliers", options.min_inliers, 3, 1000, "inliers that a tracked frame needs");
  table.Real("tracking.acceleration_m_s2", options.motion.acceleration_m_s2, 0, 1000,
             "standard deviation of the camera's linear acceleration in the motion prior; 0 switches the prior off");
  table.Real("tracking.angular_acceleration_rad_s2", options.motion.angular_acceleration_rad_s2, 0.1, 1000,
             "standard deviation of its angular acceleration");
  AssociationOptions& association = options.association;
  table.Flag("tracking.use_semantics", association.use_semantics,
             "let moving probabilities select the matches (Algorithm 2 of the paper)");
  table.Int("tracking.min_observations", association.min_observations, 1, 255,
            "with semantics, a point with fewer observations has proportionally less weight");
  table.Int("tracking.tau", association.tau, 0, 10000, "static matches that are enough (Algorithm 2 of the paper)");
  table.Choice(
      "tracking.unknown", association.unknown,
      {{"paper", UnknownPoints::kPaper}, {"always", UnknownPoints::kAlways}, {"deferred", UnknownPoints::kDeferred}},
      "when points of unknown state are used: while there are fewer than tau static ones; always; or after the pose, "
      "where static ones are few, if they agree with it");
}

void BindPropagation(PropagationOptions& options, OptionTable& table) {
  table.Flag("propagation.enabled", options.enabled,
             "propagate labels from frame to frame along the surfaces in the depth images");
}

void BindPolicy(KeyframePolicyOptions& options, OptionTable& table) {
  table.Int("keyframe.max_frames", options.max_frames, 1, 10000,
            "a keyframe is made after this many frames at the latest");
  table.Int("keyframe.min_frames", options.min_frames, 0, 10000,
            "frames between keyframes unless the view changes fast");
  table.Real("keyframe.tracked_ratio", options.tracked_ratio, 0, 1,
             "a keyframe is wanted below this ratio of tracked points to those of the reference keyframe");
  table.Int("keyframe.semantic_frames", options.semantic_frames, 0, 10000,
            "give an idle segmenter a keyframe after this many frames; 0 = never");
}

void BindMapping(MappingOptions& options, LocalMapOptions& local_map, OptionTable& table) {
  table.Real("mapping.redundant_ratio", options.redundant_ratio, 0, 1,
             "a keyframe is redundant if this ratio of its close points is well observed without it");
  table.Int("mapping.local_map_keyframes", local_map.keyframes, 1, 10000, "keyframes in tracking's local map, at most");
  LocalBundleOptions& bundle = options.bundle;
  table.Int("mapping.ba_keyframes", bundle.keyframes, 2, 1000, "keyframes that local bundle adjustment optimizes");
  table.Int("mapping.ba_fixed_keyframes", bundle.fixed_keyframes, 0, 1000, "keyframes that it holds fixed");
  table.Flag("mapping.ba_weighted", bundle.weighted, "weight its residuals by 1 - p (equation 6)");
  table.Flag("mapping.ba_labeled_only", bundle.labeled_only, "optimize labeled keyframes only");
}

void BindSemantic(SemanticOptions& options, OptionTable& table) {
  table.Choice("semantic.selection", options.selection,
               {{"bidirectional", SelectionMode::kBidirectional},
                {"sequential", SelectionMode::kSequential},
                {"newest", SelectionMode::kNewest}},
               "order in which keyframes are labeled");
  table.Int("semantic.per_round", options.per_round, 1, 16, "keyframes that are selected at a time");
  table.Text("semantic.ignore", options.ignore,
             "image of the camera's size whose pixels that are not black are ignored in every frame: a robot's body, "
             "text burnt into the picture");
  table.Int("semantic.backlog", options.backlog, 2, 10000, "images of unlabeled keyframes that are kept at most");
  table.Int("semantic.start_frames", options.start_frames, 0, 1000,
            "frames for which the map waits for the first label before it grows, at most; they are then tracked again");
  table.Int("semantic.dilation_px", options.dilation_px, 0, 200,
            "dilation of masks, in pixels at an image width of 640");
  table.Flag(
      "semantic.free_space", options.free_space.enabled,
      "check free space: what stands where earlier keyframes looked through is dynamic, and what they saw as a static "
      "surface is static");
  table.Flag("semantic.motion", options.motion,
             "what moves otherwise than most of the picture is dynamic, whatever it is (two-view motion segmentation)");
  table.Real("semantic.max_mask_ratio", options.max_mask_ratio, 0.01, 1, "ratio of the image that a mask may cover");
  table.Real("semantic.finish_timeout_s", options.finish_timeout_s, 0, 3600,
             "time to wait for missing labels at the end, in seconds");
  table.Int("semantic.lockstep_delay_frames", options.lockstep_delay_frames, 0, 100000,
            "lockstep: frames between a request and its labels");
  MovingProbabilityOptions& probability = options.probability;
  table.Real("semantic.alpha", probability.alpha, 0.5, 0.999, "p(labeled dynamic | dynamic)");
  table.Real("semantic.beta", probability.beta, 0.5, 0.999, "p(labeled static | static)");
  table.Real("semantic.static_below", probability.static_below, 0, 0.5, "theta_s: below this a point is static");
  table.Real("semantic.dynamic_above", probability.dynamic_above, 0.5, 1, "theta_d: above this a point is dynamic");
  table.Flag("semantic.optimization", options.optimizer.enabled,
             "correct the poses of keyframes once they are labeled (section VI-A of the paper)");
}

void BindLoop(LoopOptions& options, AtlasOptions& atlas, OptionTable& table) {
  table.Flag("loop.enabled", options.enabled,
             "recognize places: close loops, merge worlds, look for a lost camera in all of the map");
  table.Flag("loop.bundle", options.bundle, "full bundle adjustment after a loop or a merge, in the background");
  table.Real("atlas.patience_s", atlas.patience_s, 0, 3600,
             "seconds of usable frames without a pose after which a new world begins; 0 = never");
  table.Choice("atlas.keep", options.keep, {{"larger", KeptWorld::kLarger}, {"current", KeptWorld::kCurrent}},
               "which of two worlds keeps its coordinates when they are merged: the larger, or that of the camera");
}

void BindSegmenter(SegmenterOptions& options, OptionTable& table) {
  table.Real(
      "semantic.stored.delay_ms", options.stored_delay_ms, 0, 3.6e6,
      "back end stored: time that a request takes, milliseconds (in lockstep see semantic.lockstep_delay_frames)");
  OpenVinoOptions& openvino = options.openvino;
  table.Text("semantic.dynamic_classes", options.dynamic_classes,
             "classes that move, by the names that the network gives them, with commas: person, cat, dog");
  table.Text("semantic.openvino.model", options.model,
             "back end openvino: weights, a file or fast or accurate; empty: $RDS_WEIGHTS, else what was fetched");
  table.Real("semantic.openvino.threshold", openvino.threshold, 0, 1,
             "probability from which a pixel is dynamic; 0: as the weights' description says");
  table.Real("semantic.openvino.unsure", openvino.unsure, -1, 1,
             "probability from which, up to the threshold, a pixel says nothing; -1: as the weights' description says");
  table.Int("semantic.openvino.threads", openvino.threads, 1, 256, "threads that inference uses");
  table.Int("semantic.openvino.max_batch", openvino.max_batch, 1, 2, "images in a run of the network");
  table.Text("semantic.openvino.device", openvino.device, "device, as OpenVINO names it");
  RemoteOptions& remote = options.remote;
  table.Text("semantic.remote.url", remote.url,
             "back end remote: the model on a server that speaks the Open Inference Protocol (KServe v2): "
             "http://HOST:PORT/v2/models/NAME");
  table.Text("semantic.remote.description", remote.description,
             "back end remote: YAML file that says what the model wants and gives; \"\" = built in, or not needed");
  table.Real("semantic.remote.timeout_s", remote.timeout_s, 0.05, 600, "back end remote: time for an answer, seconds");
  table.Int("semantic.remote.jpeg_quality", remote.jpeg_quality, 0, 100,
            "back end remote: send JPEG of this quality where the server takes both; 0 = raw");
}

void BindOrb(OrbOptions& options, OptionTable& table) {
  table.Int("orb.features", options.features, 100, 10000, "keypoints in a frame");
  table.Int("orb.levels", options.levels, 1, 16, "levels of the scale pyramid");
  table.Real("orb.scale_factor", options.scale_factor, 1.01, 2.0, "scale between levels of the pyramid");
  table.Int("orb.fast_threshold", options.fast_threshold, 1, 255, "contrast of a FAST corner, in gray values");
  table.Int("orb.min_fast_threshold", options.min_fast_threshold, 1, 255,
            "contrast used where orb.fast_threshold finds nothing, in gray values");
  table.Flag("orb.depth_edges", options.depth_edges,
             "trust keypoints at edges of the depth image less: where outlines cross there is no corner in space");
}

void CheckConsistent(const Options& options) {
  if (options.orb.min_fast_threshold > options.orb.fast_threshold) {
    throw InputError("option orb.min_fast_threshold must not be above orb.fast_threshold");
  }
  constexpr double kMostKeypoints = 65'000;  // their numbers have 16 bits
  if (options.orb.features * (1 + options.orb.moving_ratio + options.orb.boundary_ratio) > kMostKeypoints) {
    throw InputError("option orb.features, with those on what moves, must not be above 65000");
  }
}

}  // namespace

OptionTable BindOptions(Options& options) {
  OptionTable table;
  BindSystem(options.system, table);
  BindOrb(options.orb, table);
  BindTracking(options.tracking, table);
  BindPropagation(options.propagation, table);
  BindPolicy(options.tracking.policy, table);
  BindMapping(options.mapping, options.local_map, table);
  BindSemantic(options.semantic, table);
  BindSegmenter(options.segmenter, table);
  BindLoop(options.loop, options.atlas, table);
  return table;
}

void SetOption(Options& options, std::string_view key, const std::string& value) {
  BindOptions(options).Find(key).set(value);
}

void SetOption(Options& options, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError("option '" + assignment + "': expected key=value");
  }
  SetOption(options, assignment.substr(0, equals), assignment.substr(equals + 1));
}

void ValidateOptions(const Options& options) {
  Options copy = options;
  const OptionTable table = BindOptions(copy);
  for (const OptionEntry& entry : table.entries()) {
    entry.set(entry.get());
  }
  CheckConsistent(options);
}

}  // namespace rds
