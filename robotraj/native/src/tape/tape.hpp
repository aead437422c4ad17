// Scalar graphs as lists of instructions, run for a pack of points at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scalar_graph.hpp"

namespace robotraj::native {

/// Kinds of instructions. Sums, differences and products differ by data alone (`Signs`): no branch is mispredicted.
enum class Step : std::int16_t { add, subtract, multiply, divide, sine, cosine, other };

/// One operation of a tape on its memory; `Step::other` is done point by point.
struct Instruction {
  std::int32_t out, first, second;
  Step step;
  std::int16_t operation;  ///< CasADi's number of it
};

/// A tape as the kernels read it. Its memory is [ work | arguments | constants | result ].
struct TapeCode {
  const Instruction* instructions = nullptr;
  std::size_t count = 0;
  const std::size_t* inputs = nullptr;  ///< numbers in each argument
  std::size_t arguments = 0;
  const double* constants = nullptr;
  std::size_t constant_count = 0;
  std::size_t work = 0;
  std::size_t outputs = 0;
};

/// The instructions of which results of a graph are computed.
class Tape {
 public:
  Tape() = default;
  Tape(const ScalarGraph& graph, const Nodes& results);

  TapeCode code() const;
  /// Packs of memory that running it takes.
  std::size_t memory() const { return result_ + outputs_; }
  /// Numbers in the result.
  std::size_t outputs() const { return outputs_; }
  /// Numbers in each argument.
  const std::vector<std::size_t>& inputs() const { return inputs_; }
  bool empty() const { return instructions_.empty(); }
  /// Whether the result depends on this argument.
  bool reads(std::size_t argument) const { return argument < read_.size() && read_[argument]; }

 private:
  std::vector<Instruction> instructions_;
  std::vector<std::size_t> inputs_;
  std::vector<bool> read_;
  std::vector<double> constants_;
  std::size_t work_ = 0;
  std::size_t result_ = 0;
  std::size_t outputs_ = 0;
};

}  // namespace robotraj::native
