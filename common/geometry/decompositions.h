// Eigen's decompositions of the sizes that are used here, instantiated once, in decompositions.cpp. In every
// source that needs one a 6 x 6 ldlt().solve() costs 2.4 s of compiling and a 6 x 6 eigensolver 5 s. The
// precompiled headers include this; nobody else has to, and what is not listed is instantiated where it is
// used, as ever.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#define SGRAPHS_DECOMPOSITIONS(EXTERN, N)                                                                    \
  EXTERN template class Eigen::LDLT<Eigen::Matrix<double, N, N>>;                                            \
  EXTERN template class Eigen::LLT<Eigen::Matrix<double, N, N>>;                                             \
  EXTERN template class Eigen::PartialPivLU<Eigen::Matrix<double, N, N>>;                                    \
  EXTERN template class Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>>;                          \
  EXTERN template Eigen::LDLT<Eigen::Matrix<double, N, N>>&                                                  \
  Eigen::LDLT<Eigen::Matrix<double, N, N>>::compute(const Eigen::EigenBase<Eigen::Matrix<double, N, N>>&);   \
  EXTERN template Eigen::LLT<Eigen::Matrix<double, N, N>>& Eigen::LLT<Eigen::Matrix<double, N, N>>::compute( \
      const Eigen::EigenBase<Eigen::Matrix<double, N, N>>&);                                                 \
  EXTERN template Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>>&                                \
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>>::compute(                                       \
      const Eigen::EigenBase<Eigen::Matrix<double, N, N>>&, int);                                            \
  EXTERN template void Eigen::LDLT<Eigen::Matrix<double, N, N>>::_solve_impl_transposed<true>(               \
      const Eigen::Matrix<double, N, 1>&, Eigen::Matrix<double, N, 1>&) const;                               \
  EXTERN template void Eigen::LLT<Eigen::Matrix<double, N, N>>::_solve_impl_transposed<true>(                \
      const Eigen::Matrix<double, N, 1>&, Eigen::Matrix<double, N, 1>&) const

SGRAPHS_DECOMPOSITIONS(extern, 3);
SGRAPHS_DECOMPOSITIONS(extern, 6);
SGRAPHS_DECOMPOSITIONS(extern, Eigen::Dynamic);
