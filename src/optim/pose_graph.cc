// SPDX-License-Identifier: Apache-2.0
#include "optim/pose_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "optim/block_system.h"

namespace rds {
namespace {

using Matrix6 = BlockSystem::Block;

// Relative to the diagonal, of which the bending of a chain of n poses as a whole has (pi / n)^2: 1e-7 for 10,000. What
// is damped by more hardly moves.
constexpr double kGraphDamping = 1e-12;
constexpr double kMaxGraphDamping = 1e6;
constexpr double kTinyGraphDecrease = 1e-6;  // of the cost, relative
constexpr double kScaling = 22.5;  // chi2 of a robust edge from which its weight falls: 99.9 % of right ones are below
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// measured^-1 * predicted, in units of the standard deviations.
Tangent6 Residual(const PoseGraphProblem::Edge& edge, const Rigid3& error) {
  Tangent6 residual;
  residual.head<3>() = error.translation / edge.sigma_m;
  residual.tail<3>() = LogSo3(error.rotation) / edge.sigma_rad;
  return residual;
}

Rigid3 ErrorOf(const PoseGraphProblem::Edge& edge, const std::vector<Rigid3>& poses) {
  return edge.to_from_from.Inverse() * (poses[edge.to] * poses[edge.from].Inverse());
}

// Of a residual with this chi2: dynamic covariance scaling's weight, squared, and its cost.
double Weight(const PoseGraphProblem::Edge& edge, double chi2) {
  const double scale = edge.robust ? std::min(1.0, 2 * kScaling / (kScaling + chi2)) : 1.0;
  return scale * scale;
}
double CostOf(const PoseGraphProblem::Edge& edge, double chi2) {
  const double scale = edge.robust ? std::min(1.0, 2 * kScaling / (kScaling + chi2)) : 1.0;
  return scale * scale * chi2 + kScaling * (1 - scale) * (1 - scale);
}

double Cost(const PoseGraphProblem& problem, const std::vector<Rigid3>& poses) {
  double cost = 0;
  for (const PoseGraphProblem::Edge& edge : problem.edges) {
    cost += CostOf(edge, Residual(edge, ErrorOf(edge, poses)).squaredNorm());
  }
  return cost;
}

// Derivatives of a residual by small motions of both cameras, Retract's.
struct Jacobians {
  Matrix6 by_from = Matrix6::Zero();
  Matrix6 by_to = Matrix6::Zero();
};

Jacobians Differentiate(const PoseGraphProblem::Edge& edge, const std::vector<Rigid3>& poses, const Rigid3& error) {
  const Rigid3 predicted = poses[edge.to] * poses[edge.from].Inverse();
  const Eigen::Matrix3d measured_inverse = edge.to_from_from.RotationMatrix().transpose();
  const Eigen::Vector3d turn = LogSo3(error.rotation);
  Jacobians jacobians;
  jacobians.by_to.topLeftCorner<3, 3>() = measured_inverse / edge.sigma_m;
  jacobians.by_to.topRightCorner<3, 3>() = -measured_inverse * CrossMatrix(predicted.translation) / edge.sigma_m;
  jacobians.by_to.bottomRightCorner<3, 3>() = LeftJacobianSo3(turn).inverse() * measured_inverse / edge.sigma_rad;
  jacobians.by_from.topLeftCorner<3, 3>() = -error.RotationMatrix() / edge.sigma_m;
  jacobians.by_from.bottomRightCorner<3, 3>() = -LeftJacobianSo3(-turn).inverse() / edge.sigma_rad;
  return jacobians;
}

class Graph {
 public:
  explicit Graph(const PoseGraphProblem& problem) : problem_(problem), slot_(problem.poses.size(), kNone) {
    std::vector<std::uint8_t> has_edge(problem.poses.size(), 0);
    for (const PoseGraphProblem::Edge& edge : problem.edges) {
      has_edge[edge.from] = has_edge[edge.to] = 1;
    }
    for (std::size_t i = 0; i < problem.poses.size(); ++i) {
      if (!problem.poses[i].fixed && has_edge[i] != 0) {
        slot_[i] = free_++;
      }
    }
    system_ = BlockSystem(free_);
    for (const PoseGraphProblem::Edge& edge : problem.edges) {
      const auto [low, high] = std::minmax(slot_[edge.from], slot_[edge.to]);
      if (high != kNone && low != high) {
        system_.Declare(high, low);
      }
    }
    diagonal_.resize(free_);
    gradient_.resize(6 * static_cast<Eigen::Index>(free_));
  }

  [[nodiscard]] bool empty() const { return free_ == 0; }

  void Linearize(const std::vector<Rigid3>& poses) {
    system_.SetZero();
    std::ranges::fill(diagonal_, Matrix6::Zero());
    gradient_.setZero();
    for (const PoseGraphProblem::Edge& edge : problem_.edges) {
      const Rigid3 error = ErrorOf(edge, poses);
      const Tangent6 residual = Residual(edge, error);
      const Jacobians jacobians = Differentiate(edge, poses, error);
      const double weight = Weight(edge, residual.squaredNorm());
      const std::uint32_t from = slot_[edge.from];
      const std::uint32_t to = slot_[edge.to];
      Add(from, jacobians.by_from, residual, weight);
      Add(to, jacobians.by_to, residual, weight);
      if (from != kNone && to != kNone && from != to) {
        const Matrix6 block = weight * jacobians.by_to.transpose() * jacobians.by_from;
        if (to > from) {
          system_.At(to, from) += block;
        } else {
          system_.At(from, to) += block.transpose();
        }
      }
    }
  }

  // A step for each pose, or nothing.
  [[nodiscard]] Eigen::VectorXd Step(double damping) {
    for (std::uint32_t i = 0; i < free_; ++i) {
      system_.At(i, i) = diagonal_[i];
      system_.At(i, i).diagonal() += damping * diagonal_[i].diagonal();
    }
    return system_.Solve(-gradient_);
  }

  [[nodiscard]] std::vector<Rigid3> Moved(std::vector<Rigid3> poses, const Eigen::VectorXd& step) const {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (slot_[i] != kNone) {
        poses[i] = Retract(step.segment<6>(6 * static_cast<Eigen::Index>(slot_[i])), poses[i]);
      }
    }
    return poses;
  }

 private:
  void Add(std::uint32_t slot, const Matrix6& jacobian, const Tangent6& residual, double weight) {
    if (slot != kNone) {
      diagonal_[slot] += weight * jacobian.transpose() * jacobian;
      gradient_.segment<6>(6 * static_cast<Eigen::Index>(slot)) += weight * jacobian.transpose() * residual;
    }
  }

  const PoseGraphProblem& problem_;
  std::vector<std::uint32_t> slot_;  // of each pose among the free ones; kNone = it stays
  std::uint32_t free_ = 0;
  BlockSystem system_{0};
  std::vector<Matrix6> diagonal_;
  Eigen::VectorXd gradient_;
};

}  // namespace

PoseGraphResult OptimizePoseGraph(const PoseGraphProblem& problem, int iterations, const std::function<bool()>& stop) {
  for (const PoseGraphProblem::Edge& edge : problem.edges) {
    Check(edge.from < problem.poses.size() && edge.to < problem.poses.size(), "pose graph: index out of range");
  }
  PoseGraphResult result;
  for (const PoseGraphProblem::Pose& pose : problem.poses) {
    result.poses.push_back(pose.camera_from_world);
  }
  Graph graph(problem);
  if (graph.empty()) {
    return result;
  }
  double cost = Cost(problem, result.poses);
  double damping = kGraphDamping;
  bool is_linear = false;
  while (result.iterations < iterations && damping <= kMaxGraphDamping) {
    if (stop && stop()) {
      return result;
    }
    ++result.iterations;
    if (!is_linear) {
      graph.Linearize(result.poses);
      is_linear = true;
    }
    const Eigen::VectorXd step = graph.Step(damping);
    std::vector<Rigid3> moved = step.size() > 0 ? graph.Moved(result.poses, step) : result.poses;
    const double moved_cost = step.size() > 0 ? Cost(problem, moved) : std::numeric_limits<double>::infinity();
    if (moved_cost < cost) {
      const bool is_tiny = cost - moved_cost <= kTinyGraphDecrease * cost;
      result.poses = std::move(moved);
      cost = moved_cost;
      is_linear = false;
      damping *= 0.1;
      if (is_tiny) {
        break;
      }
    } else if (moved_cost <= cost * (1 + kTinyGraphDecrease)) {
      break;  // as low as it gets
    } else {
      damping = std::max(10 * damping, 1e-4);
    }
  }
  result.usable = true;
  for (const PoseGraphProblem::Edge& edge : problem.edges) {
    result.chi2.push_back(Residual(edge, ErrorOf(edge, result.poses)).squaredNorm());
  }
  return result;
}

}  // namespace rds
