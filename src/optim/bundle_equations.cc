// SPDX-License-Identifier: Apache-2.0
#include "optim/bundle_equations.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "optim/reprojection.h"

namespace rds {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

double RobustCost(double squared, double huber) {
  return squared <= huber * huber ? 0.5 * squared : huber * (std::sqrt(squared) - 0.5 * huber);
}

// A point seen once without depth has no information along its ray, which may be an axis: damp all axes.
Eigen::Vector3d PointScale(const Eigen::Matrix3d& hessian) {
  return hessian.diagonal().cwiseMax(1e-3 * hessian.trace());
}

}  // namespace

BundleEquations::BundleEquations(const BundleProblem& problem, const BundleOptions& options)
    : problem_(problem), options_(options), points_(problem.points) {
  cameras_.reserve(problem.poses.size());
  for (const BundleProblem::Pose& pose : problem.poses) {
    cameras_.emplace_back(pose.camera_from_world);
  }
  CollectTerms();
  AssignSlots();
  CollectLinks();
}

double BundleEquations::Chi2(const BundleProblem::Observation& observation) const {
  const Camera& camera = cameras_[observation.pose];
  return ReprojectionChi2(problem_.camera, observation.keypoint,
                          camera.rotation * points_[observation.point] + camera.from_world.translation);
}

// Sorts the usable observations by point.
void BundleEquations::CollectTerms() {
  const auto& observations = problem_.observations;
  std::vector<std::uint32_t> next(points_.size() + 1);  // counts, then where each point's next term goes
  std::vector<std::uint8_t> usable(observations.size());
  for (std::size_t i = 0; i < observations.size(); ++i) {
    usable[i] = observations[i].keypoint.weight > 0 && std::isfinite(Chi2(observations[i])) ? 1 : 0;
    next[observations[i].point + 1] += usable[i];
  }
  for (std::size_t point = 0; point < points_.size(); ++point) {
    if (next[point + 1] > 0) {
      Landmark landmark;
      landmark.point = static_cast<std::uint32_t>(point);
      landmark.first_term = next[point];
      landmarks_.push_back(landmark);
    }
    next[point + 1] += next[point];
  }
  terms_.resize(next.back());
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (usable[i] != 0) {
      const PixelObservation& keypoint = observations[i].keypoint;
      Term& term = terms_[next[observations[i].point]++];
      term.keypoint = keypoint;
      term.pose = observations[i].pose;
      term.scale2 = keypoint.weight * keypoint.weight * keypoint.inverse_sigma2;
      term.huber = keypoint.HasDepth() ? options_.huber_depth : options_.huber_mono;
    }
  }
  Landmark mark;
  mark.first_term = static_cast<std::uint32_t>(terms_.size());
  landmarks_.push_back(mark);
}

void BundleEquations::AssignSlots() {
  std::vector<std::uint8_t> seen(cameras_.size());
  for (const Term& term : terms_) {
    seen[term.pose] = 1;
  }
  const bool any_fixed = std::any_of(problem_.poses.begin(), problem_.poses.end(),
                                     [](const BundleProblem::Pose& pose) { return pose.fixed; });
  slot_.assign(cameras_.size(), kNone);
  for (std::size_t pose = 0; pose < cameras_.size(); ++pose) {
    const bool fixed = problem_.poses[pose].fixed || (pose == 0 && !any_fixed);
    if (seen[pose] != 0 && !fixed) {
      slot_[pose] = static_cast<std::uint32_t>(free_.size());
      free_.push_back({static_cast<std::uint32_t>(pose), Matrix6::Zero(), Vector6::Zero()});
    }
  }
}

void BundleEquations::CollectLinks() {
  system_ = BlockSystem(free_.size());
  links_.reserve(terms_.size());
  std::vector<std::uint32_t> slots;  // of the free poses that see a point
  for (std::size_t i = 0; i + 1 < landmarks_.size(); ++i) {
    Landmark& landmark = landmarks_[i];
    landmark.first_link = static_cast<std::uint32_t>(links_.size());
    const std::uint32_t end_term = landmarks_[i + 1].first_term;
    slots.clear();
    for (std::uint32_t t = landmark.first_term; t < end_term; ++t) {
      if (slot_[terms_[t].pose] != kNone) {
        slots.push_back(slot_[terms_[t].pose]);
      }
    }
    std::sort(slots.begin(), slots.end());
    slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
    for (std::size_t a = 0; a < slots.size(); ++a) {
      links_.emplace_back().slot = slots[a];
      for (std::size_t b = 0; b < a; ++b) {
        system_.Declare(slots[a], slots[b]);
      }
    }
    for (std::uint32_t t = landmark.first_term; t < end_term; ++t) {
      if (slot_[terms_[t].pose] != kNone) {
        const auto at = std::lower_bound(slots.begin(), slots.end(), slot_[terms_[t].pose]) - slots.begin();
        terms_[t].link = landmark.first_link + static_cast<std::uint32_t>(at);
      }
    }
  }
  landmarks_.back().first_link = static_cast<std::uint32_t>(links_.size());
  point_step_.resize(landmarks_.size() - 1);
}

double BundleEquations::Cost(bool robust) const {
  double cost = 0;
  for (std::size_t i = 0; i + 1 < landmarks_.size(); ++i) {
    const Eigen::Vector3d& point = points_[landmarks_[i].point];
    for (std::uint32_t t = landmarks_[i].first_term; t < landmarks_[i + 1].first_term; ++t) {
      const Term& term = terms_[t];
      if (term.scale2 == 0) {
        continue;
      }
      const Camera& camera = cameras_[term.pose];
      const Eigen::Vector3d in_camera = camera.rotation * point + camera.from_world.translation;
      if (!(in_camera.z() > kMinReprojectionDepth_m)) {
        return std::numeric_limits<double>::infinity();
      }
      const double squared = term.scale2 * ReprojectionError(problem_.camera, term.keypoint, in_camera).squaredNorm();
      cost += robust ? RobustCost(squared, term.huber) : 0.5 * squared;
    }
  }
  return cost;
}

void BundleEquations::Linearize(bool robust) {
  for (FreePose& pose : free_) {
    pose.hessian.setZero();
    pose.gradient.setZero();
  }
  for (Link& link : links_) {
    link.block.setZero();
  }
  for (std::size_t i = 0; i + 1 < landmarks_.size(); ++i) {
    landmarks_[i].hessian.setZero();
    landmarks_[i].gradient.setZero();
    for (std::uint32_t t = landmarks_[i].first_term; t < landmarks_[i + 1].first_term; ++t) {
      if (terms_[t].scale2 != 0) {
        LinearizeTerm(terms_[t], robust, &landmarks_[i]);
      }
    }
  }
}

// With p = R X + t, the point in the camera, and A = G^T W G, c = G^T W r, where G is the derivative of the residual r
// by p: dp = dt + w x p + R dX for a motion (dt, w) of the camera (Retract) and dX of the point.
void BundleEquations::LinearizeTerm(const Term& term, bool robust, Landmark* landmark) {
  const Camera& camera = cameras_[term.pose];
  const Eigen::Vector3d in_camera = camera.rotation * points_[landmark->point] + camera.from_world.translation;
  const Eigen::Vector3d error = ReprojectionError(problem_.camera, term.keypoint, in_camera);
  const Eigen::Matrix3d by_point = ReprojectionJacobian(problem_.camera, term.keypoint, in_camera);
  const double squared = term.scale2 * error.squaredNorm();
  double weight = term.scale2;
  if (robust && squared > term.huber * term.huber) {
    weight *= term.huber / std::sqrt(squared);
  }

  const Eigen::Matrix3d information = by_point.transpose() * (weight * by_point);
  const Eigen::Vector3d gradient = by_point.transpose() * (weight * error);
  const Eigen::Matrix3d translation_by_point = information * camera.rotation;
  landmark->hessian.noalias() += camera.rotation.transpose() * translation_by_point;
  landmark->gradient.noalias() += camera.rotation.transpose() * gradient;
  if (term.link == kNone) {
    return;
  }
  const Eigen::Matrix3d cross = CrossMatrix(in_camera);
  const Eigen::Matrix3d rotation_by_translation = cross * information;
  Link& link = links_[term.link];
  link.block.topRows<3>() += translation_by_point;
  link.block.bottomRows<3>().noalias() += cross * translation_by_point;
  FreePose& pose = free_[link.slot];
  pose.gradient.head<3>() += gradient;
  pose.gradient.tail<3>() += in_camera.cross(gradient);
  pose.hessian.topLeftCorner<3, 3>() += information;  // the lower triangle is enough
  pose.hessian.bottomLeftCorner<3, 3>() += rotation_by_translation;
  pose.hessian.bottomRightCorner<3, 3>().noalias() -= rotation_by_translation * cross;
}

// Forms the Schur complement of the points' blocks, damped, and its right hand side.
void BundleEquations::EliminatePoints(double damping, Eigen::VectorXd* right) {
  system_.SetZero();
  for (std::size_t slot = 0; slot < free_.size(); ++slot) {
    Matrix6& block = system_.At(slot, slot);
    block = free_[slot].hessian;
    block.diagonal() += damping * block.diagonal();
    block.diagonal() = (block.diagonal().array() > 0).select(block.diagonal(), 1.0);
    right->segment<6>(static_cast<Eigen::Index>(6 * slot)) = -free_[slot].gradient;
  }
  for (std::size_t i = 0; i + 1 < landmarks_.size(); ++i) {
    Landmark& landmark = landmarks_[i];
    Eigen::Matrix3d damped = landmark.hessian;
    damped.diagonal() += damping * PointScale(landmark.hessian);
    const Eigen::LLT<Eigen::Matrix3d> root(damped);
    if (root.info() == Eigen::Success) {
      landmark.inverse_root = root.matrixL().solve(Eigen::Matrix3d::Identity());
    } else {
      landmark.inverse_root.setZero();  // stays where it is
    }
    landmark.whitened = landmark.inverse_root * landmark.gradient;
    const std::uint32_t end = landmarks_[i + 1].first_link;
    for (std::uint32_t a = landmark.first_link; a < end; ++a) {
      Link& link = links_[a];
      link.whitened.noalias() = link.block * landmark.inverse_root.transpose();
      right->segment<6>(6 * static_cast<Eigen::Index>(link.slot)).noalias() += link.whitened * landmark.whitened;
      for (std::uint32_t b = landmark.first_link; b <= a; ++b) {
        system_.At(link.slot, links_[b].slot).noalias() -= link.whitened * links_[b].whitened.transpose();
      }
    }
  }
}

double BundleEquations::FindStep(double damping) {
  Eigen::VectorXd right(static_cast<Eigen::Index>(6 * free_.size()));
  EliminatePoints(damping, &right);
  pose_step_ = free_.empty() ? right : system_.Solve(right);
  if (pose_step_.size() != right.size() || !pose_step_.allFinite()) {
    return -1;
  }
  // The model decreases by -(gradient . step) / 2 + damping (step . D step) / 2.
  double decrease = 0;
  for (std::size_t slot = 0; slot < free_.size(); ++slot) {
    const Vector6 step = pose_step_.segment<6>(static_cast<Eigen::Index>(6 * slot));
    decrease += 0.5 * step.dot(damping * free_[slot].hessian.diagonal().cwiseProduct(step) - free_[slot].gradient);
  }
  for (std::size_t i = 0; i + 1 < landmarks_.size(); ++i) {
    const Landmark& landmark = landmarks_[i];
    Eigen::Vector3d whitened = landmark.whitened;
    for (std::uint32_t a = landmark.first_link; a < landmarks_[i + 1].first_link; ++a) {
      whitened.noalias() +=
          links_[a].whitened.transpose() * pose_step_.segment<6>(6 * static_cast<Eigen::Index>(links_[a].slot));
    }
    const Eigen::Vector3d step = -(landmark.inverse_root.transpose() * whitened);
    decrease += 0.5 * step.dot(damping * PointScale(landmark.hessian).cwiseProduct(step) - landmark.gradient);
    point_step_[i] = step;
  }
  return std::isfinite(decrease) ? decrease : -1;
}

void BundleEquations::TakeStep() {
  cameras_before_ = cameras_;
  points_before_ = points_;
  for (std::size_t slot = 0; slot < free_.size(); ++slot) {
    Camera& camera = cameras_[free_[slot].pose];
    camera = Camera(Retract(pose_step_.segment<6>(static_cast<Eigen::Index>(6 * slot)), camera.from_world));
  }
  for (std::size_t i = 0; i < point_step_.size(); ++i) {
    points_[landmarks_[i].point] += point_step_[i];
  }
}

void BundleEquations::Revert() {
  cameras_ = cameras_before_;
  points_ = points_before_;
}

void BundleEquations::DropOutliers() {
  for (std::size_t i = 0; i + 1 < landmarks_.size(); ++i) {
    for (std::uint32_t t = landmarks_[i].first_term; t < landmarks_[i + 1].first_term; ++t) {
      Term& term = terms_[t];
      const Camera& camera = cameras_[term.pose];
      const double chi2 =
          ReprojectionChi2(problem_.camera, term.keypoint,
                           camera.rotation * points_[landmarks_[i].point] + camera.from_world.translation);
      if (!IsInlier(term.keypoint, chi2)) {
        term.scale2 = 0;
      }
    }
  }
}

std::vector<Rigid3> BundleEquations::Poses() const {
  std::vector<Rigid3> poses;
  poses.reserve(cameras_.size());
  for (const Camera& camera : cameras_) {
    poses.push_back(camera.from_world);
  }
  return poses;
}

}  // namespace rds
