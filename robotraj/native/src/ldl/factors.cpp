#include "factors.hpp"

#include <algorithm>
#include <cstring>

#include "kernels/packed.hpp"

namespace robotraj::native::ldl {

Factors::Factors(Pattern pattern, const std::vector<int>& groups, const std::string& processor)
    : pattern_(std::move(pattern)),
      kernels_(kernels_of(processor).fronts),
      tree_(tree_of_fewest_products(pattern_, groups)),
      parts_(tree_.nodes.size()) {
  make_room();
}

void Factors::make_room() {
  std::size_t factor = 0, stacked = 0, stack = 0, front = 0;
  for (const Node& node : tree_.nodes) {
    const std::size_t below = node.below.size(), ld = padded_rows(node.columns + static_cast<int>(below));
    front = std::max(front, ld * (below + kPanel + 2));
    factor += ld * node.columns;
    for (const int child : node.children) stacked -= parts_[child].entries;
    stacked += parts_[&node - tree_.nodes.data()].entries = padded_rows(static_cast<int>(below)) * below;
    stack = std::max(stack, stacked);
  }
  // Delays make fronts larger.
  factor_.reserve(factor + factor / 2 + 2 * front);
  stack_.reserve(2 * stack);
}

Inertia Factors::factorise(const double* values, double threshold, double small) {
  entries_ = orders_ = diagonals_ = stacked_ = 0;
  Inertia all;
  for (std::size_t node = 0; node < tree_.nodes.size(); ++node) eliminate(node, values, threshold, small, all);
  return all;
}

void Factors::eliminate(std::size_t index, const double* values, double threshold, double small, Inertia& all) {
  const Node& node = tree_.nodes[index];
  int late = 0;
  for (const int child : node.children) late += parts_[child].delayed;
  Front front{};
  front.rows = late + node.columns + static_cast<int>(node.below.size());
  front.candidates = late + node.columns;
  front.ld = padded_rows(front.rows);
  const std::size_t ld = front.ld, rows = front.rows;
  // Columns of L stay where they are; the next front overwrites the others.
  factor_.reserve(entries_ + ld * (rows + kPanel + 2), entries_);
  front.entries = factor_.data() + entries_;
  front.memory = front.entries + ld * rows;
  for (std::size_t j = 0; j < rows; ++j) {
    const std::size_t from = j / kRowBlock * kRowBlock;
    std::memset(front.entries + j * ld + from, 0, (ld - from) * sizeof(double));
  }
  if (order_.size() < orders_ + rows) order_.resize(orders_ + rows + rows / 2);
  diagonal_.resize(std::max(diagonal_.size(), diagonals_ + rows));
  off_.resize(diagonal_.size());
  front.order = order_.data() + orders_;
  front.diagonal = diagonal_.data() + diagonals_;
  front.off = off_.data() + diagonals_;

  int* rest = front.order + late;
  for (int c = 0; c < node.columns; ++c) rest[c] = node.first + c;
  std::copy(node.below.begin(), node.below.end(), rest + node.columns);
  for (int e = tree_.place_starts[index]; e < tree_.place_starts[index + 1]; ++e) {
    const Place& place = tree_.places[e];
    front.entries[(late + place.column) * ld + late + place.row] += values[e];
  }
  // The blocks of the children are stacked.
  std::size_t end = stacked_;
  int before = late;
  for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
    const Part& part = parts_[*child];
    const std::vector<int>& below = tree_.nodes[*child].places;
    const int own = part.delayed, count = own + static_cast<int>(below.size());
    const std::size_t step = padded_rows(count);
    const double* block = stack_.data() + (end -= step * count);
    const int* places = below.data();
    if (late > 0) {
      places_.resize(count);
      places = places_.data();
      before -= own;
      for (int i = 0; i < own; ++i) {
        places_[i] = before + i;
        front.order[before + i] = order_[part.order + part.pivots + i];
      }
      for (std::size_t i = 0; i < below.size(); ++i) places_[own + i] = late + below[i];
    }
    kernels_.add(block, static_cast<int>(step), count, places, front.entries, front.ld);
  }
  stacked_ = end;

  const Pivots pivots = kernels_.eliminate(front, {threshold, small, node.parent < 0});
  Part& part = parts_[index];
  keep(front, pivots.count, part);
  all.negative += pivots.negative;
  all.zero += pivots.zero;
  all.delayed += part.delayed;
}

void Factors::keep(const Front& front, int pivots, Part& part) {
  const std::size_t ld = front.ld;
  part = {pivots, front.ld, front.candidates - pivots, entries_, orders_, diagonals_};
  // Zeros to the diagonal: the substitutions work on whole packs.
  for (int k = 0; k < pivots; ++k)
    for (int i = k / kRowBlock * kRowBlock; i <= k; ++i) front.entries[k * ld + i] = 0.0;
  entries_ += ld * pivots;
  orders_ += front.rows;
  diagonals_ += pivots;

  const int count = front.rows - pivots;
  const std::size_t step = padded_rows(count);
  stack_.reserve(stacked_ + step * count, stacked_);
  for (int j = 0; j < count; ++j)
    std::memcpy(stack_.data() + stacked_ + j * step + j, front.entries + (pivots + j) * ld + pivots + j,
                (count - j) * sizeof(double));
  stacked_ += step * count;
}

void Factors::solve(double* x) {
  all_.resize(pattern_.n);
  for (int k = 0; k < pattern_.n; ++k) all_[k] = x[tree_.order[k]];
  for (const Part& part : parts_) vector_.reserve(part.ld);
  for (std::size_t node = 0; node < parts_.size(); ++node) {
    const Part& part = parts_[node];
    const int* order = order_.data() + part.order;
    const int rows = part.pivots + part.delayed + static_cast<int>(tree_.nodes[node].below.size());
    double* v = vector_.data();
    for (int i = 0; i < rows; ++i) v[i] = all_[order[i]];
    for (int i = rows; i < part.ld; ++i) v[i] = 0.0;
    kernels_.forward(factor_.data() + part.entries, part.ld, part.pivots, v);
    for (int i = 0; i < rows; ++i) all_[order[i]] = v[i];
  }
  for (std::size_t node = parts_.size(); node-- > 0;) {
    const Part& part = parts_[node];
    const int* order = order_.data() + part.order;
    const double *diagonal = diagonal_.data() + part.diagonal, *off = off_.data() + part.diagonal;
    const int rows = part.pivots + part.delayed + static_cast<int>(tree_.nodes[node].below.size());
    double* v = vector_.data();
    for (int i = 0; i < rows; ++i) v[i] = all_[order[i]];
    for (int i = rows; i < part.ld; ++i) v[i] = 0.0;
    for (int k = 0; k < part.pivots; ++k)
      if (off[k] != 0.0) {
        const double x1 = v[k], x2 = v[k + 1];
        v[k] = diagonal[k] * x1 + off[k] * x2;
        v[k + 1] = off[k] * x1 + diagonal[k + 1] * x2;
        ++k;
      } else {
        v[k] *= diagonal[k];
      }
    kernels_.backward(factor_.data() + part.entries, part.ld, part.pivots, v);
    for (int k = 0; k < part.pivots; ++k) all_[order[k]] = v[k];
  }
  for (int k = 0; k < pattern_.n; ++k) x[tree_.order[k]] = all_[k];
}

}  // namespace robotraj::native::ldl
