// The chain rule over places, as sparse combinations of the nonzeros of the places' own derivatives.
//
//   rows = L y + sum_b S_b vec(Y_b),   Y_b,e = f_b(v_e),   v_e = (G_b y)_e
//   L + sum_b S_b blkdiag(J_b,e) G_b:   Jacobian entries j = j0 + sum_b M_b vec(J_b)
//   sum_b G_b' blkdiag(H_b,e) G_b:      entries of the upper triangle h = sum_b N_b vec(H_b)
//
// A row lies in one stage, a short run of columns, and so do the columns that a place reads. So entries are numbered
// stage by stage with a small table, and the long list of all products is never sorted.
#pragma once

#include <cstdint>
#include <vector>

#include "program.hpp"
#include "sparse/sparse.hpp"
#include "sparse/stacked.hpp"

namespace robotraj::native {

/// A block as the chain rule sees it.
struct Chain {
  std::size_t count, inputs, outputs;  // E, n_v, n_y
  Pattern jacobian;                    // nonzeros of one place
  Pattern hessian;                     // of one triangle of one place
  Csr scatter;                         // S (rows, n_y E)
  Csr reads;                           // (n_v E, columns of the problem): before columns are assigned to stages
  Csr gather;                          // G (n_v E, n_y): the same, read in the place's own stage
  std::vector<std::int64_t> stages;    // of the places (E,)

  /// Throws std::invalid_argument where shapes do not fit.
  void check() const;
};

/// Columns as they appear in stages: column c in stage s is row base[c] + s of X, over the variables y.
struct Slots {
  Csr expressions;
  std::vector<std::int64_t> base;
};

/// Runs of y and of rows that belong to stages.
struct Runs {
  std::vector<std::int64_t> starts;  // of the stages in y (stages + 1,)
  std::vector<std::int64_t> rows;    // stage of every row
};

/// Entries in row-major order, and the constant and the matrices that give them.
template <typename Matrix>
struct Combined {
  Pattern pattern;
  Numbers constant;
  std::vector<Matrix> parts;
};

/// j0 and M_b. A row reads places of other stages as its own stage sees their columns.
Combined<Csr> jacobian_chain(const Csr& linear, const std::vector<const Chain*>& chains, const Slots& slots,
                             const Runs& runs);

/// N_b. Stages that read alike have the same rows.
Combined<Stacked> hessian_chain(const std::vector<const Chain*>& chains, const Runs& runs);

}  // namespace robotraj::native
