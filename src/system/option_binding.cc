// SPDX-License-Identifier: Apache-2.0
#include "system/option_binding.h"

#include "base/error.h"
#include "propagation/surface_labels.h"

namespace rds {
namespace {

void BindSystem(SystemOptions& options, OptionTable& table) {
  table.Flag("system.lockstep", options.lockstep,
             "run everything on one thread in a fixed order, so that the same input gives the same bytes");
  table.Flag("system.keep_features", options.keep_features, "keep each frame's features for drawing");
  table.Flag("system.wait_for_mapping", options.wait_for_mapping,
             "let a frame wait until mapping's queue has capacity (for frames that come faster than real time)");
  table.Int("system.keyframe_queue", options.keyframe_queue, 1, 100, "capacity of mapping's queue, in keyframes");
}

void BindTracking(TrackerOptions& options, OptionTable& table) {
  table.Int("tracking.min_start_points", options.min_start_points, 10, 10000,
            "keypoints with depth that the first keyframe needs");
  table.Real("tracking.motion_window_px", options.motion_window_px, 1, 100,
             "largest search window around predictions of the motion model, in pixels of the finest level");
  table.Int("tracking.min_motion_matches", options.min_motion_matches, 3, 1000,
            "with fewer matches to the last frame the window is doubled, and then the reference keyframe is tried");
  table.Int("tracking.min_motion_inliers", options.min_motion_inliers, 3, 1000, "inliers that the coarse pose needs");
  table.Real("tracking.reference_ratio", options.reference_ratio, 0.1, 1, "ratio test of matches to a keyframe");
  table.Int("tracking.min_reference_matches", options.min_reference_matches, 3, 1000,
            "matches to a keyframe from which a pose is computed");
  table.Real("tracking.local_window_px", options.local_window_px, 0.5, 50,
             "search window around local map points, in pixels");
  table.Real("tracking.recovery_window_px", options.recovery_window_px, 0.5, 100,
             "the same while lost tracking is being recovered");
  table.Real("tracking.local_ratio", options.local_ratio, 0.1, 1, "ratio test of local map points");
  table.Int("tracking.min_inliers", options.min_inliers, 3, 1000, "inliers that a tracked frame needs");
  table.Int("tracking.min_recovery_inliers", options.min_recovery_inliers, 3, 1000,
            "inliers that the frame needs which recovers tracking");
  table.Int("tracking.recovery_keyframes", options.recovery_keyframes, 1, 1000,
            "nearest keyframes that are tried when tracking is lost");
  table.Real("tracking.acceleration_m_s2", options.motion.acceleration_m_s2, 0, 1000,
             "standard deviation of the camera's linear acceleration in the motion prior; 0 switches the prior off");
  table.Real("tracking.angular_acceleration_rad_s2", options.motion.angular_acceleration_rad_s2, 0.1, 1000,
             "standard deviation of its angular acceleration");
  DepthRegistrationOptions& registration = options.registration;
  table.Flag(
      "tracking.register_depth", registration.enabled,
      "first register a frame's depth image (with semantics: its static surfaces) to that of the reference keyframe");
  table.Real("tracking.registration_weight", registration.weight, 1e-6, 1,
             "weight of one depth sample in that registration; small, because the errors of neighboring samples are "
             "correlated");
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
  table.Int("tracking.min_static_inliers", association.min_static_inliers, 0, 10000,
            "deferred: with fewer static inliers, unknown points that agree are let in");
  table.Int("tracking.min_static_matches", association.min_static_matches, 0, 10000,
            "deferred: with fewer static matches, all unknown points are used");
}

void BindPropagation(PropagationOptions& options, OptionTable& table) {
  table.Flag("propagation.enabled", options.enabled,
             "propagate labels from frame to frame along the surfaces in the depth images");
  table.Int("propagation.age_penalty_px", options.age_penalty_px, 0, SurfaceLabel::kNone,
            "distance that a label ages by with each frame, in pixels");
  table.Int("propagation.max_dynamic_distance_px", options.surface.max_dynamic_distance_px, 1, SurfaceLabel::kNone - 1,
            "distance over which a dynamic label spreads along a surface, in pixels");
  table.Int("propagation.max_static_distance_px", options.surface.max_static_distance_px, 1, SurfaceLabel::kNone - 1,
            "distance over which a static label spreads along a surface, in pixels");
  table.Real("propagation.depth_step_ratio", options.surface.depth_step_ratio, 0, 1,
             "largest step in depth between neighboring samples of one surface, as a ratio of the depth");
}

void BindPolicy(KeyframePolicyOptions& options, OptionTable& table) {
  table.Choice("keyframe.rule", options.rule, {{"orb_slam3", KeyframeRule::kOrbSlam3}, {"paper", KeyframeRule::kPaper}},
               "rule by which a frame becomes a keyframe");
  table.Int("keyframe.max_frames", options.max_frames, 1, 10000,
            "a keyframe is made after this many frames at the latest");
  table.Int("keyframe.min_frames", options.min_frames, 0, 10000,
            "frames between keyframes unless the view changes fast");
  table.Real("keyframe.tracked_ratio", options.tracked_ratio, 0, 1,
             "a keyframe is wanted below this ratio of tracked points to those of the reference keyframe");
  table.Real("keyframe.shared_ratio", options.shared_ratio, 0, 1,
             "a keyframe is wanted at once below this share of the reference keyframe's points");
  table.Int("keyframe.depth_tracked", options.depth_tracked, 0, 10000,
            "a keyframe is wanted at once with fewer keypoints with depth tracked than this ...");
  table.Int("keyframe.depth_untracked", options.depth_untracked, 0, 10000,
            "... while there are more than this that could be tracked");
  table.Int("keyframe.min_inliers", options.min_inliers, 0, 10000, "inliers that a keyframe needs");
  table.Int("keyframe.paper_frames", options.paper_frames, 0, 10000, "paper: frames since the last keyframe");
  table.Int("keyframe.paper_points", options.paper_points, 0, 10000, "paper: least number of tracked points");
  table.Real("keyframe.paper_ratio", options.paper_ratio, 0, 1,
             "paper: ratio of tracked points to those of the reference keyframe");
  table.Int("keyframe.semantic_frames", options.semantic_frames, 0, 10000,
            "give an idle segmenter a keyframe after this many frames; 0 = never");
}

void BindMapping(MappingOptions& options, LocalMapOptions& local_map, OptionTable& table) {
  table.Int("mapping.probation_keyframes", options.probation_keyframes, 1, 100,
            "keyframes for which a new point is on probation");
  table.Real("mapping.min_found_ratio", options.min_found_ratio, 0, 1,
             "on probation, a point must be found in this ratio of the frames that should see it");
  table.Int("mapping.min_observations", options.min_observations, 1, 100,
            "on probation, a point needs this many observations");
  table.Int("mapping.triangulate_neighbors", options.triangulate_neighbors, 0, 100,
            "neighboring keyframes with which new points are triangulated");
  table.Real("mapping.triangulate_ratio", options.triangulate_ratio, 0.1, 1, "ratio test of that search");
  table.Int("mapping.fuse_neighbors", options.fuse_neighbors, 0, 100,
            "neighboring keyframes that are searched for duplicate points");
  table.Real("mapping.redundant_ratio", options.redundant_ratio, 0, 1,
             "a keyframe is redundant if this ratio of its close points is well observed without it");
  table.Int("mapping.redundant_observations", options.redundant_observations, 1, 100,
            "observations by other keyframes that this takes");
  table.Int("mapping.cull_keyframes", options.cull_keyframes, 0, 1000,
            "neighboring keyframes that are examined for redundancy");
  table.Int("mapping.local_map_keyframes", local_map.keyframes, 1, 10000, "keyframes in tracking's local map, at most");
  table.Int("mapping.local_map_neighbors", local_map.neighbors, 0, 1000,
            "neighbors that each covisible keyframe adds to it");
  LocalBundleOptions& bundle = options.bundle;
  table.Int("mapping.ba_keyframes", bundle.keyframes, 2, 1000, "keyframes that local bundle adjustment optimizes");
  table.Int("mapping.ba_fixed_keyframes", bundle.fixed_keyframes, 0, 1000, "keyframes that it holds fixed");
  table.Flag("mapping.ba_weighted", bundle.weighted, "weight its residuals by 1 - p (equation 6)");
  table.Flag("mapping.ba_labeled_only", bundle.labeled_only, "optimize labeled keyframes only");
  table.Int("mapping.ba_enough_labeled", bundle.enough_labeled, 1, 1000,
            "labeled keyframes in the window that this takes");
  table.Int("mapping.ba_robust_iterations", bundle.solver.robust_iterations, 1, 1000, "steps with the robust kernel");
  table.Int("mapping.ba_final_iterations", bundle.solver.final_iterations, 0, 1000, "steps without the outliers");
}

void BindSemantic(SemanticOptions& options, OptionTable& table) {
  table.Choice("semantic.selection", options.selection,
               {{"bidirectional", SelectionMode::kBidirectional},
                {"sequential", SelectionMode::kSequential},
                {"newest", SelectionMode::kNewest}},
               "order in which keyframes are labeled");
  table.Int("semantic.per_round", options.per_round, 1, 16, "keyframes that are selected at a time");
  table.Flag("semantic.batch", options.batch, "segment them in one request instead of one by one");
  table.Text("semantic.ignore", options.ignore,
             "image of the camera's size whose pixels that are not black are ignored in every frame: a robot's body, "
             "text burnt into the picture");
  table.Int("semantic.backlog", options.backlog, 2, 10000, "images of unlabeled keyframes that are kept at most");
  table.Int("semantic.start_frames", options.start_frames, 0, 1000,
            "frames for which the map waits for the first label before it grows, at most; they are then tracked again");
  table.Int("semantic.dilation_px", options.dilation_px, 0, 200,
            "dilation of masks, in pixels at an image width of 640");
  table.Real("semantic.completion_step_ratio", options.completion_step_ratio, 0, 1,
             "unsure pixels join dynamic ones across steps in depth up to this ratio; 0 = never");
  table.Flag(
      "semantic.free_space", options.free_space.enabled,
      "check free space: what stands where earlier keyframes looked through is dynamic, and what they saw as a static "
      "surface is static");
  table.Real("semantic.free_space_margin", options.free_space.margin_ratio, 0.01, 1,
             "distance by which they must have seen beyond it, as a ratio of the depth");
  table.Real("semantic.free_space_match", options.free_space.match_ratio, 0.001, 1,
             "difference in depth up to which a surface is the same, as a ratio of the depth");
  table.Flag("semantic.motion", options.motion,
             "what moves otherwise than most of the picture is dynamic, whatever it is (two-view motion segmentation)");
  table.Real("semantic.max_mask_ratio", options.max_mask_ratio, 0.01, 1, "ratio of the image that a mask may cover");
  table.Real("semantic.finish_timeout_s", options.finish_timeout_s, 0, 3600,
             "time to wait for missing labels at the end, in seconds");
  table.Real("semantic.cancel_timeout_s", options.cancel_timeout_s, 0, 3600,
             "time that a back end has to give up when canceled, in seconds");
  table.Int("semantic.lockstep_delay_frames", options.lockstep_delay_frames, 0, 100000,
            "lockstep: frames between a request and its labels");
  MovingProbabilityOptions& probability = options.probability;
  table.Real("semantic.alpha", probability.alpha, 0.5, 0.999, "p(labeled dynamic | dynamic)");
  table.Real("semantic.beta", probability.beta, 0.5, 0.999, "p(labeled static | static)");
  table.Real("semantic.static_below", probability.static_below, 0, 0.5, "theta_s: below this a point is static");
  table.Real("semantic.dynamic_above", probability.dynamic_above, 0.5, 1, "theta_d: above this a point is dynamic");
  table.Real("semantic.floor", probability.floor, 0, 0.3, "least distance of a probability from 0 and 1");
  table.Flag("semantic.optimization", options.optimizer.enabled,
             "correct the poses of keyframes once they are labeled (section VI-A of the paper)");
  table.Int("semantic.optimization_keyframes", options.optimizer.most_keyframes, 1, 10000,
            "keyframes that are corrected at a time: a labeled one and those after it");
  table.Int("semantic.optimization_min_static", options.optimizer.min_static, 3, 10000,
            "static matches that this takes");
  table.Real("semantic.optimization_min_shift_m", options.optimizer.min_shift_m, 0, 10,
             "smaller corrections are not applied, in meters ...");
  table.Real("semantic.optimization_min_rotation_deg", options.optimizer.min_rotation_deg, 0, 180,
             "... unless they rotate by more than this, in degrees");
}

void BindSegmenter(SegmenterOptions& options, OptionTable& table) {
  table.Real(
      "semantic.stored.delay_ms", options.stored_delay_ms, 0, 3.6e6,
      "back end stored: time that a request takes, milliseconds (in lockstep see semantic.lockstep_delay_frames)");
  OpenVinoOptions& openvino = options.openvino;
  table.Text("semantic.openvino.model", options.model,
             "back end openvino: weights, a file or fast or accurate; empty: $RDS_WEIGHTS, else what was fetched");
  table.Real("semantic.openvino.threshold", openvino.threshold, 0, 1,
             "probability from which a pixel is dynamic; 0: as the weights' description says");
  table.Real("semantic.openvino.unsure", openvino.unsure, -1, 1,
             "probability from which, up to the threshold, a pixel says nothing; -1: as the weights' description says");
  table.Int("semantic.openvino.threads", openvino.threads, 1, 256, "threads that inference uses");
  table.Int("semantic.openvino.max_batch", openvino.max_batch, 1, 2, "images in a run of the network");
  table.Text("semantic.openvino.device", openvino.device, "device, as OpenVINO names it");
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
  table.Real("orb.moving_ratio", options.moving_ratio, 0, 10,
             "additional keypoints on dynamic surfaces, as a ratio of those of each coarse level");
  table.Real("orb.boundary_ratio", options.boundary_ratio, 0, 10,
             "additional keypoints at the boundary of dynamic surfaces, as a ratio of those of each level");
}

void BindPose(PoseOptimizerOptions& options, OptionTable& table) {
  table.Int("pose.rounds", options.rounds, 1, 10,
            "rounds of pose optimization; inliers are classified anew after each");
  table.Int("pose.iterations_per_round", options.iterations_per_round, 1, 100, "steps in a round, at most");
  table.Int("pose.robust_rounds", options.robust_rounds, 0, 10, "rounds that use the Huber kernel, from the first on");
}

void CheckConsistent(const Options& options) {
  if (options.orb.min_fast_threshold > options.orb.fast_threshold) {
    throw InputError("option orb.min_fast_threshold must not be above orb.fast_threshold");
  }
  constexpr double kMostKeypoints = 65'000;  // their numbers have 16 bits
  if (options.orb.features * (1 + options.orb.moving_ratio + options.orb.boundary_ratio) > kMostKeypoints) {
    throw InputError("option orb.features times 1 + orb.moving_ratio + orb.boundary_ratio must not be above 65000");
  }
}

}  // namespace

OptionTable BindOptions(Options& options) {
  OptionTable table;
  BindSystem(options.system, table);
  BindOrb(options.orb, table);
  BindPose(options.pose, table);
  BindTracking(options.tracking, table);
  BindPropagation(options.propagation, table);
  BindPolicy(options.tracking.policy, table);
  BindMapping(options.mapping, options.local_map, table);
  BindSemantic(options.semantic, table);
  BindSegmenter(options.segmenter, table);
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
