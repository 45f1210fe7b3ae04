// SPDX-License-Identifier: Apache-2.0
#include "optim/pose_optimizer.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "base/error.h"
#include "optim/reprojection.h"

namespace rds {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kMaxInput = 1e9;  // meters or pixels; anything larger (or NaN) is never used

constexpr double kTinyStep = 1e-7;          // meters and radians: the last round has converged
constexpr double kSmallStep = 1e-5;         // ... and good enough for another classification
constexpr double kTinyPoseDecrease = 1e-9;  // of the cost, relative
constexpr double kSingularPivot = 1e-11;    // of the normal matrix scaled to a unit diagonal
constexpr double kFirstPoseDamping = 1e-5;
constexpr double kMaxPoseDamping = 1e5;

// Four observations side by side, so that one AVX vector holds one quantity of four observations. (Eight are a quarter
// faster with AVX-512, three times slower without it, and g++ 12 warns about its own AVX-512 intrinsics.)
constexpr std::size_t kLanes = 4;
using Lanes = Eigen::Array<double, kLanes, 1>;

struct Block {
  Lanes x, y, z;        // point in the world
  Lanes u, v;           // measured, px
  Lanes inverse_depth;  // measured, 1 / m
  Lanes depth_px;       // 0 = no depth
  Lanes huber;          // threshold on the weighted residual's norm
  Lanes information;    // weight^2 inverse_sigma2, 0 = does not take part
};

// Normal equations at a pose: cost(Retract(delta, pose)) ~ cost + 2 gradient . delta + delta . hessian delta.
struct NormalEquations {
  Matrix6 hessian;
  Vector6 gradient;
  double cost = 0;
};

void AddPrior(const PosePrior& prior, const Rigid3& camera_from_world, NormalEquations* equations) {
  Matrix6 jacobian;
  const Vector6 residual = PriorResidual(prior, camera_from_world, &jacobian);
  const Vector6 weighted = prior.information * residual;
  equations->cost += residual.dot(weighted);
  equations->gradient += jacobian.transpose() * weighted;
  equations->hessian += jacobian.transpose() * prior.information * jacobian;
}

bool IsUsable(const PoseObservation& observation) {
  const PixelObservation& keypoint = observation.keypoint;
  const std::initializer_list<double> values = {observation.point_in_world.x(),
                                                observation.point_in_world.y(),
                                                observation.point_in_world.z(),
                                                keypoint.pixel.x(),
                                                keypoint.pixel.y(),
                                                keypoint.inverse_depth,
                                                keypoint.depth_px,
                                                keypoint.inverse_sigma2,
                                                keypoint.weight};
  return std::all_of(values.begin(), values.end(), [](double value) { return std::abs(value) < kMaxInput; });
}

// The observations in blocks and which of them take part.
class Problem {
 public:
  Problem(const PinholeCamera& camera, std::span<const PoseObservation> observations, const PosePrior* prior);

  // Marks all observations below their chi2 quantile and returns how many they are.
  int Classify(const Rigid3& camera_from_world, std::vector<std::uint8_t>* inlier) const;
  // Lets all usable observations in front of the camera take part, or only the marked ones. Returns how many with a
  // positive weight there are.
  int Activate(const Rigid3& camera_from_world, const std::vector<std::uint8_t>* only);
  [[nodiscard]] NormalEquations Evaluate(const Rigid3& camera_from_world, bool robust) const;

 private:
  PinholeCamera camera_;
  std::span<const PoseObservation> observations_;
  const PosePrior* prior_;  // or null
  std::vector<std::uint8_t> usable_;
  std::vector<Block> blocks_;
};

Problem::Problem(const PinholeCamera& camera, std::span<const PoseObservation> observations, const PosePrior* prior)
    : camera_(camera), observations_(observations), prior_(prior), usable_(observations.size()) {
  Block empty;
  for (Lanes* lanes :
       {&empty.x, &empty.y, &empty.u, &empty.v, &empty.inverse_depth, &empty.depth_px, &empty.information}) {
    lanes->setZero();
  }
  empty.z.setOnes();
  empty.huber.setOnes();
  blocks_.assign((observations.size() + kLanes - 1) / kLanes, empty);
  const double huber_mono = std::sqrt(kChi2Mono);
  const double huber_depth = std::sqrt(kChi2Depth);
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const PoseObservation& observation = observations[i];
    if (!IsUsable(observation)) {
      continue;
    }
    usable_[i] = 1;
    Block& block = blocks_[i / kLanes];
    const auto lane = static_cast<Eigen::Index>(i % kLanes);
    block.x[lane] = observation.point_in_world.x();
    block.y[lane] = observation.point_in_world.y();
    block.z[lane] = observation.point_in_world.z();
    block.u[lane] = observation.keypoint.pixel.x();
    block.v[lane] = observation.keypoint.pixel.y();
    const bool has_depth = observation.keypoint.HasDepth();
    block.inverse_depth[lane] = has_depth ? observation.keypoint.inverse_depth : 0.0;
    block.depth_px[lane] = has_depth ? observation.keypoint.depth_px : 0.0;
    block.huber[lane] = has_depth ? huber_depth : huber_mono;
  }
}

int Problem::Classify(const Rigid3& camera_from_world, std::vector<std::uint8_t>* inlier) const {
  const Eigen::Matrix3d rotation = camera_from_world.RotationMatrix();
  inlier->assign(observations_.size(), 0);
  int count = 0;
  for (std::size_t i = 0; i < observations_.size(); ++i) {
    const PixelObservation& keypoint = observations_[i].keypoint;
    const Eigen::Vector3d point = rotation * observations_[i].point_in_world + camera_from_world.translation;
    if (usable_[i] != 0 && IsInlier(keypoint, ReprojectionChi2(camera_, keypoint, point))) {
      (*inlier)[i] = 1;
      ++count;
    }
  }
  return count;
}

int Problem::Activate(const Rigid3& camera_from_world, const std::vector<std::uint8_t>* only) {
  const Eigen::RowVector3d depth_row = camera_from_world.RotationMatrix().row(2);
  int count = 0;
  for (std::size_t i = 0; i < observations_.size(); ++i) {
    const PixelObservation& keypoint = observations_[i].keypoint;
    const bool active = only != nullptr ? (*only)[i] != 0
                                        : usable_[i] != 0 && depth_row.dot(observations_[i].point_in_world) +
                                                                     camera_from_world.translation.z() >
                                                                 kMinReprojectionDepth_m;
    const double information = active ? keypoint.weight * keypoint.weight * keypoint.inverse_sigma2 : 0.0;
    blocks_[i / kLanes].information[static_cast<Eigen::Index>(i % kLanes)] = information;
    count += information > 0 ? 1 : 0;
  }
  return count;
}

// Each observation's residual depends on the pose through the camera point q = R X + t alone. With A = G^T W G,
// c = G^T W r, where G is the 3x3 derivative of the residual by q, a motion (dt, w) of the camera gives
//   hessian = [A, A [q]x^T; [q]x A, [q]x A [q]x^T],  gradient = [c; q x c]
// which needs a third of the operations of J^T W J.
NormalEquations Problem::Evaluate(const Rigid3& camera_from_world, bool robust) const {
  const Eigen::Matrix3d r = camera_from_world.RotationMatrix();
  const Eigen::Vector3d& t = camera_from_world.translation;
  const double fx = camera_.fx;
  const double fy = camera_.fy;

  Lanes cost = Lanes::Zero();
  Lanes c0 = cost, c1 = cost, c2 = cost, d0 = cost, d1 = cost, d2 = cost;        // gradient
  Lanes a00 = cost, a02 = cost, a11 = cost, a12 = cost, a22 = cost;              // hessian, A (a01 = 0)
  Lanes b00 = cost, b01 = cost, b02 = cost, b10 = cost, b11 = cost, b12 = cost;  // A [q]x^T
  Lanes b20 = cost, b21 = cost, b22 = cost;
  Lanes e00 = cost, e01 = cost, e02 = cost, e11 = cost, e12 = cost, e22 = cost;  // [q]x A [q]x^T
  for (const Block& block : blocks_) {
    const Lanes qx = r(0, 0) * block.x + r(0, 1) * block.y + r(0, 2) * block.z + t.x();
    const Lanes qy = r(1, 0) * block.x + r(1, 1) * block.y + r(1, 2) * block.z + t.y();
    const Lanes qz = r(2, 0) * block.x + r(2, 1) * block.y + r(2, 2) * block.z + t.z();
    // A point that a step carries behind the camera gets a huge residual: the step is rejected.
    const Lanes inverse_z = qz.max(kMinReprojectionDepth_m).inverse();
    const Lanes x = qx * inverse_z;
    const Lanes y = qy * inverse_z;
    const Lanes error_u = block.u - (fx * x + camera_.cx);
    const Lanes error_v = block.v - (fy * y + camera_.cy);
    const Lanes error_depth = block.depth_px * (block.inverse_depth - inverse_z);

    const Lanes squared = block.information * (error_u * error_u + error_v * error_v + error_depth * error_depth);
    Lanes weight = block.information;
    if (robust) {
      const Lanes norm = squared.sqrt();
      const Lanes inner = norm.min(block.huber);
      cost += inner * (2.0 * norm - inner);
      weight *= block.huber / norm.max(block.huber);
    } else {
      cost += squared;
    }

    // Rows of G: u (-gu, 0, gu x), v (0, -gv, gv y), depth (0, 0, depth_px / z^2).
    const Lanes gu = fx * inverse_z;
    const Lanes gv = fy * inverse_z;
    const Lanes guz = gu * x;
    const Lanes gvz = gv * y;
    const Lanes gdz = block.depth_px * inverse_z * inverse_z;
    const Lanes weighted_u = weight * error_u;
    const Lanes weighted_v = weight * error_v;
    const Lanes weighted_depth = weight * error_depth;
    const Lanes g0 = -(gu * weighted_u);
    const Lanes g1 = -(gv * weighted_v);
    const Lanes g2 = guz * weighted_u + gvz * weighted_v + gdz * weighted_depth;
    c0 += g0;
    c1 += g1;
    c2 += g2;
    d0 += qy * g2 - qz * g1;
    d1 += qz * g0 - qx * g2;
    d2 += qx * g1 - qy * g0;

    const Lanes h00 = weight * gu * gu;
    const Lanes h02 = -weight * gu * guz;
    const Lanes h11 = weight * gv * gv;
    const Lanes h12 = -weight * gv * gvz;
    const Lanes h22 = weight * (guz * guz + gvz * gvz + gdz * gdz);
    a00 += h00;
    a02 += h02;
    a11 += h11;
    a12 += h12;
    a22 += h22;
    const Lanes m00 = qy * h02;
    const Lanes m01 = qz * h00 - qx * h02;
    const Lanes m02 = -qy * h00;
    const Lanes m10 = qy * h12 - qz * h11;
    const Lanes m11 = -qx * h12;
    const Lanes m12 = qx * h11;
    const Lanes m20 = qy * h22 - qz * h12;
    const Lanes m21 = qz * h02 - qx * h22;
    const Lanes m22 = qx * h12 - qy * h02;
    b00 += m00;
    b01 += m01;
    b02 += m02;
    b10 += m10;
    b11 += m11;
    b12 += m12;
    b20 += m20;
    b21 += m21;
    b22 += m22;
    e00 += qy * m20 - qz * m10;
    e01 += qy * m21 - qz * m11;
    e02 += qy * m22 - qz * m12;
    e11 += qz * m01 - qx * m21;
    e12 += qz * m02 - qx * m22;
    e22 += qx * m12 - qy * m02;
  }

  NormalEquations result;
  result.cost = cost.sum();
  result.gradient << c0.sum(), c1.sum(), c2.sum(), d0.sum(), d1.sum(), d2.sum();
  Matrix6& h = result.hessian;
  h.topLeftCorner<3, 3>() << a00.sum(), 0, a02.sum(), 0, a11.sum(), a12.sum(), a02.sum(), a12.sum(), a22.sum();
  h.topRightCorner<3, 3>() << b00.sum(), b01.sum(), b02.sum(), b10.sum(), b11.sum(), b12.sum(), b20.sum(), b21.sum(),
      b22.sum();
  h.bottomLeftCorner<3, 3>() = h.topRightCorner<3, 3>().transpose();
  h.bottomRightCorner<3, 3>() << e00.sum(), e01.sum(), e02.sum(), e01.sum(), e11.sum(), e12.sum(), e02.sum(), e12.sum(),
      e22.sum();
  if (prior_ != nullptr) {
    AddPrior(*prior_, camera_from_world, &result);
  }
  return result;
}

// Normal matrix scaled to a unit diagonal, so that meters and radians, near and far scenes, look alike.
Matrix6 ScaledToUnitDiagonal(const Matrix6& hessian, Vector6* scale) {
  *scale = (hessian.diagonal().array() > 0).select(hessian.diagonal().array().sqrt().inverse(), 1.0);
  return scale->asDiagonal() * hessian * scale->asDiagonal();
}

bool IsSingular(const Matrix6& hessian) {
  Vector6 scale;
  const Eigen::LDLT<Matrix6> factors(ScaledToUnitDiagonal(hessian, &scale));
  return factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > kSingularPivot);
}

// Levenberg-Marquardt from `pose` (Nocedal and Wright, "Numerical Optimization", section 10.3). `equations` are those
// of the pose, before and after.
void Minimize(const Problem& problem, bool robust, int iterations, double small_step, Rigid3* pose,
              NormalEquations* equations) {
  double damping = kFirstPoseDamping;
  for (int iteration = 0; iteration < iterations && damping <= kMaxPoseDamping; ++iteration) {
    Vector6 scale;
    Matrix6 scaled = ScaledToUnitDiagonal(equations->hessian, &scale);
    scaled.diagonal().array() += damping;
    const Vector6 step = scale.cwiseProduct(scaled.ldlt().solve(-scale.cwiseProduct(equations->gradient)));
    const Rigid3 candidate = Retract(step, *pose);
    const NormalEquations next = problem.Evaluate(candidate, robust);
    if (!(next.cost <= equations->cost)) {
      if (step.lpNorm<Eigen::Infinity>() < small_step) {
        return;  // rounding has the last word
      }
      damping = std::max(10.0 * damping, 1e-3);
      continue;
    }
    const double decrease = equations->cost - next.cost;
    *pose = candidate;
    *equations = next;
    damping *= 0.1;
    if (step.lpNorm<Eigen::Infinity>() < small_step || decrease <= kTinyPoseDecrease * next.cost) {
      return;
    }
  }
}

}  // namespace

PoseResult OptimizePose(const PinholeCamera& camera, const Rigid3& initial_camera_from_world,
                        std::span<const PoseObservation> observations, const PoseOptimizerOptions& options,
                        const PosePrior* prior) {
  Check(options.rounds > 0 && options.iterations_per_round > 0, "pose optimizer: rounds and iterations must be > 0");
  Problem problem(camera, observations, prior);
  PoseResult result;
  result.camera_from_world = initial_camera_from_world;
  const auto fail = [&] {
    result.camera_from_world = initial_camera_from_world;
    result.inliers = problem.Classify(initial_camera_from_world, &result.inlier);
    return result;
  };

  if (problem.Activate(initial_camera_from_world, nullptr) < 3) {
    return fail();
  }
  std::vector<std::uint8_t> previous;
  for (int round = 0; round < options.rounds; ++round) {
    const bool robust = round < options.robust_rounds;
    const bool is_last = round + 1 == options.rounds;
    NormalEquations equations = problem.Evaluate(result.camera_from_world, robust);
    Minimize(problem, robust, options.iterations_per_round, is_last ? kTinyStep : kSmallStep, &result.camera_from_world,
             &equations);
    previous.swap(result.inlier);
    result.inliers = problem.Classify(result.camera_from_world, &result.inlier);
    if (is_last && previous == result.inlier) {
      result.information = equations.hessian;
      break;
    }
    if (problem.Activate(result.camera_from_world, &result.inlier) < 3) {
      return fail();
    }
    if (is_last) {
      result.information = problem.Evaluate(result.camera_from_world, robust).hessian;
    }
  }
  if (result.inliers < 3 || IsSingular(result.information)) {
    return fail();
  }
  result.converged = true;
  return result;
}

}  // namespace rds
