#include "stacked.hpp"

#include <utility>

namespace robotraj::native {

namespace {

/// Repeats of a piece at least, and its rows.
constexpr std::size_t kRepeats = 4, kRows = 16;

}  // namespace

Stacked::Stacked(const Csr& matrix) : Stacked(matrix.columns(), {{matrix, 1, 0}}) {}

Stacked::Stacked(std::size_t columns, std::vector<Piece> pieces) : columns_(columns), pieces_(std::move(pieces)) {
  for (const Piece& piece : pieces_) {
    rows_ += piece.repeats * piece.rows.rows();
    entries_ += piece.repeats * piece.rows.entries();
  }
}

std::size_t Stacked::kept() const {
  std::size_t sum = 0;
  for (const Piece& piece : pieces_) sum += piece.rows.entries();
  return sum;
}

void Stacked::times(const double* x, double* y) const {
  for (const Piece& piece : pieces_)
    for (std::size_t k = 0; k < piece.repeats; ++k, y += piece.rows.rows())
      piece.rows.times(x + static_cast<std::ptrdiff_t>(k) * piece.shift, y);
}

void Stacking::append(Csr block) {
  settle();
  last_ = Stacked::Piece{std::move(block), 1, 0};
}

bool Stacking::repeat(std::ptrdiff_t shift) {
  if (!last_ || (last_->repeats > 1 && last_->shift != shift)) return false;
  last_->shift = shift;
  ++last_->repeats;
  return true;
}

void Stacking::settle() {
  if (!last_) return;
  const Stacked::Piece piece = *std::exchange(last_, std::nullopt);
  if (piece.repeats >= kRepeats && piece.rows.rows() >= kRows) {
    close();
    pieces_.push_back(piece);
    return;
  }
  const Csr& rows = piece.rows;
  for (std::size_t k = 0; k < piece.repeats; ++k) {
    const auto before = static_cast<std::int32_t>(indices_.size());
    const auto shift = static_cast<std::int32_t>(static_cast<std::ptrdiff_t>(k) * piece.shift);
    for (std::size_t row = 1; row <= rows.rows(); ++row) starts_.push_back(before + rows.starts()[row]);
    for (std::size_t e = 0; e < rows.entries(); ++e) indices_.push_back(rows.indices()[e] + shift);
    data_.insert(data_.end(), rows.data(), rows.data() + rows.entries());
  }
}

void Stacking::close() {
  if (starts_.size() > 1)
    pieces_.push_back({Csr(columns_, std::move(starts_), std::move(indices_), std::move(data_)), 1, 0});
  starts_.assign(1, 0);
  indices_.clear();
  data_.clear();
}

Stacked Stacking::stacked() {
  settle();
  close();
  return Stacked(columns_, std::move(pieces_));
}

}  // namespace robotraj::native
