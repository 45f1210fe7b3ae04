// SPDX-License-Identifier: Apache-2.0
// Numeric differentiation, to check analytic Jacobians in tests.
#pragma once

#include <Eigen/Core>

namespace rds {

// Central differences of f: R^Columns -> R^Rows at x. Returns a Rows x Columns matrix.
template <int Rows, int Columns, typename Function>
Eigen::Matrix<double, Rows, Columns> NumericJacobian(const Function& f, const Eigen::Matrix<double, Columns, 1>& x,
                                                     double step = 1e-6) {
  Eigen::Matrix<double, Rows, Columns> jacobian;
  for (int i = 0; i < Columns; ++i) {
    Eigen::Matrix<double, Columns, 1> low = x;
    Eigen::Matrix<double, Columns, 1> high = x;
    low[i] -= step;
    high[i] += step;
    jacobian.col(i) = (f(high) - f(low)) / (2.0 * step);
  }
  return jacobian;
}

}  // namespace rds
