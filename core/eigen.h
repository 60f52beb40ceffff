// Eigenvalues and eigenvectors of small symmetric matrices, by Jacobi's method of cyclic rotations.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace umbrage {

template <std::size_t N>
using SymmetricMatrix = std::array<std::array<double, N>, N>;

/// Eigenvalues, ascending, and unit eigenvectors of either sign: vectors[k] belongs to values[k].
template <std::size_t N>
struct EigenSystem {
  std::array<double, N> values{};
  std::array<std::array<double, N>, N> vectors{};
};

/// Returns the eigenvalues and eigenvectors of a finite matrix.
template <std::size_t N>
EigenSystem<N> eigen_of(SymmetricMatrix<N> a) {
  constexpr int kMaxSweeps = 40;
  constexpr double kPrecision = 1e-30;  // of squares, relative to the diagonal
  SymmetricMatrix<N> v{};
  for (std::size_t i = 0; i < N; ++i) v[i][i] = 1.0;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double off = 0.0, diagonal = 0.0;
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = 0; j < N; ++j) (i == j ? diagonal : off) += a[i][j] * a[i][j];
    if (!(off > kPrecision * diagonal)) break;
    for (std::size_t p = 0; p < N; ++p)
      for (std::size_t q = p + 1; q < N; ++q) {
        if (a[p][q] == 0.0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
        const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
        const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
        for (std::size_t k = 0; k < N; ++k) {
          const double x = a[k][p], y = a[k][q];
          a[k][p] = c * x - s * y;
          a[k][q] = s * x + c * y;
        }
        for (std::size_t k = 0; k < N; ++k) {
          const double x = a[p][k], y = a[q][k];
          a[p][k] = c * x - s * y;
          a[q][k] = s * x + c * y;
        }
        for (std::size_t k = 0; k < N; ++k) {
          const double x = v[k][p], y = v[k][q];
          v[k][p] = c * x - s * y;
          v[k][q] = s * x + c * y;
        }
      }
  }
  std::array<std::size_t, N> order;
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return a[i][i] < a[j][j]; });
  EigenSystem<N> out;
  for (std::size_t k = 0; k < N; ++k) {
    out.values[k] = a[order[k]][order[k]];
    for (std::size_t i = 0; i < N; ++i) out.vectors[k][i] = v[i][order[k]];
  }
  return out;
}

}  // namespace umbrage
