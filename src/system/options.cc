#include "system/options.h"

#include "base/error.h"

namespace rds {
namespace {

void BindSystem(SystemOptions& options, OptionTable& table) {
  table.Flag("system.lockstep", options.lockstep,
             "run everything on one thread in a fixed order: same bytes every time");
  table.Flag("system.keep_features", options.keep_features, "keep each frame's features for drawing");
  table.Flag("system.wait_for_mapping", options.wait_for_mapping,
             "let a frame wait for room in mapping's queue (for frames faster than real time)");
  table.Int("system.keyframe_queue", options.keyframe_queue, 1, 100, "keyframes that may wait for mapping");
}

void BindTracking(TrackerOptions& options, OptionTable& table) {
  table.Int("tracking.min_start_points", options.min_start_points, 10, 10000,
            "keypoints with depth that the first keyframe needs");
  table.Real("tracking.motion_window_px", options.motion_window_px, 1, 100,
             "search window of the motion model at most, pixels of the finest level");
  table.Int("tracking.min_motion_matches", options.min_motion_matches, 3, 1000,
            "matches to the last frame below which the window is doubled, then the reference keyframe tried");
  table.Int("tracking.min_motion_inliers", options.min_motion_inliers, 3, 1000, "inliers of a first pose");
  table.Real("tracking.reference_ratio", options.reference_ratio, 0.1, 1, "ratio test against keyframes");
  table.Int("tracking.min_reference_matches", options.min_reference_matches, 3, 1000,
            "matches to a keyframe that are worth a pose");
  table.Real("tracking.local_window_px", options.local_window_px, 0.5, 50, "search window of local map points, pixels");
  table.Real("tracking.regain_window_px", options.regain_window_px, 0.5, 100,
             "the same while tracking is being regained");
  table.Real("tracking.local_ratio", options.local_ratio, 0.1, 1, "ratio test of local map points");
  table.Int("tracking.min_inliers", options.min_inliers, 3, 1000, "inliers of a tracked frame");
  table.Int("tracking.min_regain_inliers", options.min_regain_inliers, 3, 1000,
            "inliers of the frame that regains tracking");
  table.Int("tracking.regain_keyframes", options.regain_keyframes, 1, 1000,
            "nearest keyframes tried when tracking is lost");
  table.Real("tracking.close_baselines", options.close_baselines, 1, 1000, "depth in baselines that counts as close");
  table.Real("tracking.acceleration_m_s2", options.motion.acceleration_m_s2, 0, 1000,
             "how much the velocity of the camera may change; poses stay near what that allows; 0 = anywhere");
  table.Real("tracking.turn_rad_s2", options.motion.turn_rad_s2, 0.1, 1000, "the same for turning");
  SurfaceAlignmentOptions& alignment = options.alignment;
  table.Flag("tracking.align_surfaces", alignment.enabled,
             "lay the surfaces of a frame, static ones with semantics, over those of its reference keyframe first");
  table.Real("tracking.alignment_weight", alignment.weight, 1e-6, 1, "of each: errors of neighbours are alike");
  AssociationOptions& association = options.association;
  table.Flag("tracking.use_semantics", association.use_semantics,
             "let moving probabilities select the matches (Algorithm 2)");
  table.Int("tracking.proven_sightings", association.proven_sightings, 1, 255,
            "with semantics, a point that fewer keyframes see has proportionally less weight");
  table.Int("tracking.tau", association.tau, 0, 10000, "static matches that are enough (Algorithm 2)");
  table.Choice("tracking.unknown", association.unknown,
               {{"paper", UnknownPoints::kPaper}, {"always", UnknownPoints::kAlways}, {"gated", UnknownPoints::kGated}},
               "unknown points are used while fewer than tau static ones are there; always; or where static ones are "
               "few, if they agree with the pose of those");
  table.Int("tracking.few_static", association.few_static, 0, 10000,
            "gated: static inliers below which agreeing unknown points are let in");
  table.Int("tracking.pose_static", association.pose_static, 0, 10000,
            "gated: static matches that give a pose of their own; below, all unknown points are used");
}

void BindCarry(LabelCarryOptions& options, OptionTable& table) {
  table.Flag("carry.enabled", options.enabled,
             "carry labels from frame to frame over the surfaces that depth images show");
  table.Int("carry.frame_cost_px", options.frame_cost_px, 0, SurfaceLabel::kNone,
            "a label carried to the next frame is as if so much farther away, pixels");
  table.Int("carry.dynamic_reach_px", options.surface.dynamic_reach_px, 1, SurfaceLabel::kNone - 1,
            "how far a label of what moves spreads over a surface, pixels");
  table.Int("carry.static_reach_px", options.surface.static_reach_px, 1, SurfaceLabel::kNone - 1,
            "how far a label of what does not move spreads over a surface, pixels");
  table.Real("carry.step_depth", options.surface.step_depth, 0, 1,
             "neighbouring samples on a surface differ in depth by at most this share");
}

void BindPolicy(KeyframePolicyOptions& options, OptionTable& table) {
  table.Choice("keyframe.rule", options.rule, {{"orb_slam3", KeyframeRule::kOrbSlam3}, {"paper", KeyframeRule::kPaper}},
               "when a frame becomes a keyframe");
  table.Int("keyframe.max_frames", options.max_frames, 1, 10000, "a keyframe is due after so many frames");
  table.Int("keyframe.min_frames", options.min_frames, 0, 10000, "frames between keyframes while tracking is not weak");
  table.Real("keyframe.tracked_ratio", options.tracked_ratio, 0, 1,
             "share of the reference keyframe's points below which the view is new");
  table.Real("keyframe.weak_ratio", options.weak_ratio, 0, 1, "share below which a keyframe is wanted at once");
  table.Int("keyframe.close_tracked", options.close_tracked, 0, 10000, "fewer close points tracked than this, and ...");
  table.Int("keyframe.close_untracked", options.close_untracked, 0, 10000,
            "... more than this that could be: a keyframe is wanted");
  table.Int("keyframe.min_inliers", options.min_inliers, 0, 10000, "inliers that a keyframe needs");
  table.Int("keyframe.paper_frames", options.paper_frames, 0, 10000, "paper: frames since the last keyframe");
  table.Int("keyframe.paper_points", options.paper_points, 0, 10000, "paper: points tracked at least");
  table.Real("keyframe.paper_ratio", options.paper_ratio, 0, 1, "paper: share of the reference keyframe's points");
  table.Int("keyframe.semantic_frames", options.semantic_frames, 0, 10000,
            "a keyframe for an idle segmenter after so many frames; 0 = none");
}

void BindMapping(MappingOptions& options, LocalMapOptions& local_map, OptionTable& table) {
  table.Real("mapping.close_baselines", options.close_baselines, 1, 1000,
             "points are made from depth below so many baselines");
  table.Int("mapping.min_depth_points", options.min_depth_points, 0, 10000,
            "and from so many of the nearest keypoints in any case");
  table.Int("mapping.young_keyframes", options.young_keyframes, 1, 100, "keyframes that a new point is on trial");
  table.Real("mapping.min_found_ratio", options.min_found_ratio, 0, 1, "share of its views that must find a new point");
  table.Int("mapping.min_sightings", options.min_sightings, 1, 100, "keyframes that must see a new point");
  table.Int("mapping.triangulate_neighbours", options.triangulate_neighbours, 0, 100,
            "keyframes that new points are triangulated with");
  table.Real("mapping.triangulate_ratio", options.triangulate_ratio, 0.1, 1, "ratio test of that search");
  table.Int("mapping.fuse_neighbours", options.fuse_neighbours, 0, 100, "keyframes searched for duplicates");
  table.Real("mapping.redundant_share", options.redundant_share, 0, 1,
             "share of a keyframe's close points seen elsewhere that makes it redundant");
  table.Int("mapping.redundant_sightings", options.redundant_sightings, 1, 100, "other keyframes that must see them");
  table.Int("mapping.cull_keyframes", options.cull_keyframes, 0, 1000, "keyframes examined for that");
  table.Int("mapping.local_map_keyframes", local_map.keyframes, 1, 10000, "keyframes in tracking's local map");
  table.Int("mapping.local_map_neighbours", local_map.neighbours, 0, 1000,
            "best neighbours that each of its keyframes brings");
  LocalBundleOptions& bundle = options.bundle;
  table.Int("mapping.ba_keyframes", bundle.keyframes, 2, 1000, "keyframes that local bundle adjustment moves");
  table.Int("mapping.ba_fixed_keyframes", bundle.fixed_keyframes, 0, 1000, "keyframes that it holds fixed");
  table.Flag("mapping.ba_weighted", bundle.weighted, "weight its residuals by 1 - p (equation 6)");
  table.Flag("mapping.ba_labelled_only", bundle.labelled_only, "let only labelled keyframes take part");
  table.Int("mapping.ba_enough_labelled", bundle.enough_labelled, 1, 1000,
            "labelled keyframes in the window that make it so");
  table.Int("mapping.ba_robust_iterations", bundle.solver.robust_iterations, 1, 1000, "steps with the robust kernel");
  table.Int("mapping.ba_final_iterations", bundle.solver.final_iterations, 0, 1000, "steps without the outliers");
}

void BindSemantic(SemanticOptions& options, OptionTable& table) {
  table.Choice("semantic.selection", options.selection,
               {{"bidirectional", SelectionMode::kBidirectional},
                {"sequential", SelectionMode::kSequential},
                {"newest", SelectionMode::kNewest}},
               "keyframes that are labelled next");
  table.Int("semantic.per_round", options.per_round, 1, 16, "keyframes selected at a time");
  table.Flag("semantic.batch", options.batch, "segment them in one request, not one by one");
  table.Int("semantic.backlog", options.backlog, 2, 10000, "images of unlabelled keyframes kept");
  table.Int("semantic.start_frames", options.start_frames, 0, 1000,
            "frames at most that wait for the first label before the map grows, and are tracked again with it");
  table.Int("semantic.dilation_px", options.dilation_px, 0, 200, "dilation of masks, pixels at an image width of 640");
  table.Real("semantic.complete_step_depth", options.complete_step_depth, 0, 1,
             "unsure pixels join dynamic ones over steps in depth of at most this share; 0 = never");
  table.Flag("semantic.free_space", options.free_space.enabled,
             "labels come through space, too: dynamic where earlier keyframes looked through what is there now, static "
             "where they saw the same static surface");
  table.Real("semantic.free_space_margin", options.free_space.margin_depth, 0.01, 1,
             "share of the depth that they must have looked farther");
  table.Real("semantic.free_space_match", options.free_space.match_depth, 0.001, 1,
             "share of the depth up to which a surface is the same one");
  table.Real("semantic.max_mask_share", options.max_mask_share, 0.01, 1, "share of the image that a mask may cover");
  table.Real("semantic.finish_timeout_s", options.finish_timeout_s, 0, 3600,
             "time for missing labels at the end, seconds");
  table.Real("semantic.cancel_timeout_s", options.cancel_timeout_s, 0, 3600, "time for a back end to give up, seconds");
  table.Int("semantic.lockstep_delay_frames", options.lockstep_delay_frames, 0, 100000,
            "lockstep: frames between a request and its labels");
  MovingProbabilityOptions& probability = options.probability;
  table.Real("semantic.alpha", probability.alpha, 0.5, 0.999, "p(labelled dynamic | dynamic)");
  table.Real("semantic.beta", probability.beta, 0.5, 0.999, "p(labelled static | static)");
  table.Real("semantic.static_below", probability.static_below, 0, 0.5, "theta_s: below this a point is static");
  table.Real("semantic.dynamic_above", probability.dynamic_above, 0.5, 1, "theta_d: above this a point is dynamic");
  table.Real("semantic.floor", probability.floor, 0, 0.3, "least distance of a probability from 0 and 1");
  table.Flag("semantic.optimisation", options.optimizer.enabled,
             "correct poses of keyframes once labelled (section VI-A)");
  table.Int("semantic.optimisation_keyframes", options.optimizer.most_keyframes, 1, 10000,
            "keyframes corrected at a time: a labelled one and those after it");
  table.Int("semantic.optimisation_min_static", options.optimizer.min_static, 3, 10000,
            "static matches that this needs");
  table.Real("semantic.optimisation_min_shift_m", options.optimizer.min_shift_m, 0, 10,
             "smaller corrections are left out, metres");
  table.Real("semantic.optimisation_min_turn_deg", options.optimizer.min_turn_deg, 0, 180,
             "unless the rotation is larger than this, degrees");
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
  table.Int("orb.features", options.features, 100, 10000, "keypoints wanted in a frame");
  table.Int("orb.levels", options.levels, 1, 16, "levels of the scale pyramid");
  table.Real("orb.scale_factor", options.scale_factor, 1.01, 2.0, "scale between levels of the pyramid");
  table.Int("orb.fast_threshold", options.fast_threshold, 1, 255, "contrast of a FAST corner, in grey values");
  table.Int("orb.min_fast_threshold", options.min_fast_threshold, 1, 255,
            "contrast used where orb.fast_threshold finds nothing, in grey values");
  table.Flag("orb.depth_edges", options.depth_edges,
             "trust keypoints less around which the depth jumps, or is near and has holes: outlines that cross are no "
             "corners");
  table.Real("orb.moving_share", options.moving_share, 0, 10,
             "keypoints wanted in addition on what moves, as a share of those of each coarse level");
  table.Real("orb.beside_share", options.beside_share, 0, 10,
             "keypoints wanted in addition right beside it, as a share of those of each level");
}

void BindPose(PoseOptimizerOptions& options, OptionTable& table) {
  table.Int("pose.rounds", options.rounds, 1, 10, "rounds of pose optimisation; inliers are classified after each");
  table.Int("pose.iterations_per_round", options.iterations_per_round, 1, 100, "steps in a round, at most");
  table.Int("pose.robust_rounds", options.robust_rounds, 0, 10, "first rounds that use the Huber kernel");
}

void CheckConsistent(const Options& options) {
  if (options.orb.min_fast_threshold > options.orb.fast_threshold) {
    throw InputError("option orb.min_fast_threshold must not be above orb.fast_threshold");
  }
  constexpr double kMostKeypoints = 65'000;  // their numbers have 16 bits
  if (options.orb.features * (1 + options.orb.moving_share + options.orb.beside_share) > kMostKeypoints) {
    throw InputError("option orb.features times 1 + orb.moving_share + orb.beside_share must not be above 65000");
  }
}

}  // namespace

OptionTable BindOptions(Options& options) {
  OptionTable table;
  BindSystem(options.system, table);
  BindOrb(options.orb, table);
  BindPose(options.pose, table);
  BindTracking(options.tracking, table);
  BindCarry(options.carry, table);
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
