#include "chains.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "product_rows.hpp"

namespace robotraj::native {

namespace {

[[noreturn]] void refuse(std::int64_t column) {
  throw std::invalid_argument("column " + std::to_string(column) + " is read outside its stage");
}

/// Position of a column of y in its stage.
inline std::size_t inside(std::int64_t column, std::int64_t first, std::size_t width) {
  const auto at = static_cast<std::size_t>(column - first);
  if (at >= width) refuse(column);
  return at;
}

/// Refuses stages that do not fit the columns of y.
void check(const Runs& runs, std::size_t columns) {
  const std::vector<std::int64_t>& starts = runs.starts;
  if (starts.empty() || starts.front() < 0 || !std::is_sorted(starts.begin(), starts.end()) ||
      static_cast<std::size_t>(starts.back()) > columns)
    throw std::invalid_argument("the starts of the stages do not ascend within the columns");
}

/// Nonzeros of one place by the output they belong to.
std::vector<std::vector<std::size_t>> by_output(const Chain& chain) {
  std::vector<std::vector<std::size_t>> result(chain.outputs);
  for (std::size_t k = 0; k < chain.jacobian.size(); ++k) result[chain.jacobian.rows[k]].push_back(k);
  return result;
}

}  // namespace

void Chain::check() const {
  const auto need = [](bool fits, const char* what) {
    if (!fits) throw std::invalid_argument(std::string("a chain's ") + what + " do not fit its places");
  };
  const auto within = [&](const std::vector<std::int32_t>& indices, std::size_t end) {
    return std::all_of(indices.begin(), indices.end(),
                       [&](std::int32_t i) { return i >= 0 && static_cast<std::size_t>(i) < end; });
  };
  need(scatter.columns() == outputs * count, "scattered outputs");
  need(reads.rows() == inputs * count && gather.rows() == inputs * count, "gathered inputs");
  need(stages.size() == count, "stages");
  need(within(jacobian.rows, outputs) && within(jacobian.columns, inputs), "entries of the Jacobian");
  need(within(hessian.rows, inputs) && within(hessian.columns, inputs), "entries of the Hessian");
  need(jacobian.rows.size() == jacobian.columns.size() && hessian.rows.size() == hessian.columns.size(), "patterns");
}

Combined<Csr> jacobian_chain(const Csr& linear, const std::vector<const Chain*>& chains, const Slots& slots,
                             const Runs& runs) {
  for (const Chain* chain : chains)
    if (chain->scatter.rows() != linear.rows()) throw std::invalid_argument("a chain writes other rows");
  if (runs.rows.size() != linear.rows()) throw std::invalid_argument("every row needs its stage");
  check(runs, linear.columns());
  std::vector<std::vector<std::vector<std::size_t>>> outputs;
  for (const Chain* chain : chains) outputs.push_back(by_output(*chain));
  std::vector<ProductRows> parts;
  for (const Chain* chain : chains) parts.emplace_back(chain->jacobian.size() * chain->count);
  Pattern pattern;
  Numbers constant;
  std::vector<std::vector<ChainProduct>> products(chains.size());
  std::vector<char> present;
  std::vector<std::int32_t> number;
  const Csr& x = slots.expressions;
  for (std::size_t row = 0; row < linear.rows(); ++row) {
    const std::int64_t stage = runs.rows[row], first = runs.starts.at(stage);
    const auto width = static_cast<std::size_t>(runs.starts.at(stage + 1) - first);
    present.assign(width, 0);
    number.resize(width);
    for (auto i = linear.starts()[row]; i < linear.starts()[row + 1]; ++i)
      present[inside(linear.indices()[i], first, width)] = 1;
    for (std::size_t b = 0; b < chains.size(); ++b) {
      const Chain& chain = *chains[b];
      products[b].clear();
      for (auto s = chain.scatter.starts()[row]; s < chain.scatter.starts()[row + 1]; ++s) {
        const std::size_t place = chain.scatter.indices()[s] / chain.outputs;
        for (const std::size_t k : outputs[b][chain.scatter.indices()[s] % chain.outputs]) {
          const std::size_t input = place * chain.inputs + chain.jacobian.columns[k];
          const auto source = static_cast<std::int32_t>(place * chain.jacobian.size() + k);
          for (auto g = chain.reads.starts()[input]; g < chain.reads.starts()[input + 1]; ++g) {
            const double factor = chain.scatter.data()[s] * chain.reads.data()[g];
            const auto slot = static_cast<std::size_t>(slots.base.at(chain.reads.indices()[g]) + stage);
            if (slot >= x.rows()) throw std::invalid_argument("a row reads a column in a stage in which it is not");
            for (auto i = x.starts()[slot]; i < x.starts()[slot + 1]; ++i) {
              const std::size_t at = inside(x.indices()[i], first, width);
              present[at] = 1;
              products[b].push_back({static_cast<std::int32_t>(at), source, factor * x.data()[i]});
            }
          }
        }
      }
    }
    std::int32_t many = 0;
    for (std::size_t at = 0; at < width; ++at) {
      if (!present[at]) continue;
      number[at] = many++;
      pattern.add(static_cast<std::int64_t>(row), first + static_cast<std::int64_t>(at));
    }
    const std::size_t begin = constant.size();
    constant.resize(begin + many, 0.0);
    for (auto i = linear.starts()[row]; i < linear.starts()[row + 1]; ++i)
      constant[begin + number[linear.indices()[i] - first]] += linear.data()[i];
    for (std::size_t b = 0; b < chains.size(); ++b) {
      for (ChainProduct& product : products[b]) product.at = number[product.at];
      parts[b].append(products[b], many);
    }
  }
  Combined<Csr> combined{std::move(pattern), std::move(constant), {}};
  for (ProductRows& part : parts) combined.parts.push_back(part.matrix());
  return combined;
}

namespace {

/// One product of G' H G, the same in all stages of equal reads: of entries i and j that place `place` of the stage
/// reads.
struct Step {
  std::int32_t at, place, nonzero, i, j;
  bool twice;
};

/// Columns that the places of one block in one stage read.
struct Reading {
  std::vector<std::int32_t> local;  // positions in the stage
  Numbers factors;
  std::vector<std::size_t> apart;  // places behind the first

  void read(const Chain& chain, const std::vector<std::size_t>& places, std::int64_t first, std::size_t width) {
    local.assign({static_cast<std::int32_t>(places.size()), static_cast<std::int32_t>(width)});
    factors.clear();
    apart.clear();
    const Csr& g = chain.gather;
    for (const std::size_t place : places) {
      const std::size_t begin = place * chain.inputs, end = begin + chain.inputs;
      for (std::size_t input = begin; input < end; ++input) {
        local.push_back(g.starts()[input + 1] - g.starts()[input]);
        for (auto i = g.starts()[input]; i < g.starts()[input + 1]; ++i)
          local.push_back(static_cast<std::int32_t>(inside(g.indices()[i], first, width)));
      }
      factors.insert(factors.end(), g.data() + g.starts()[begin], g.data() + g.starts()[end]);
      apart.push_back(place - places.front());
    }
  }
};

/// Products of one block in one stage, `at` being row * width + column; marks the entries that occur.
std::vector<Step> steps_of(const Chain& chain, const std::vector<std::size_t>& places, std::int64_t first,
                           std::size_t width, std::vector<std::int32_t>& number) {
  std::vector<Step> steps;
  const Csr& g = chain.gather;
  for (std::size_t e = 0; e < places.size(); ++e) {
    const auto begin = g.starts()[places[e] * chain.inputs];
    for (std::size_t k = 0; k < chain.hessian.size(); ++k) {
      const std::size_t a = places[e] * chain.inputs + chain.hessian.rows[k];
      const std::size_t c = places[e] * chain.inputs + chain.hessian.columns[k];
      for (auto i = g.starts()[a]; i < g.starts()[a + 1]; ++i) {
        const auto row = static_cast<std::size_t>(g.indices()[i] - first);
        for (auto j = g.starts()[c]; j < g.starts()[c + 1]; ++j) {
          const auto column = static_cast<std::size_t>(g.indices()[j] - first);
          // An entry beside the diagonal stands for two: one falls in the upper triangle, or both on the diagonal.
          if (a == c && row > column) continue;
          const std::size_t at = std::min(row, column) * width + std::max(row, column);
          number[at] = 0;
          steps.push_back({static_cast<std::int32_t>(at), static_cast<std::int32_t>(e), static_cast<std::int32_t>(k),
                           i - begin, j - begin, a != c && row == column});
        }
      }
    }
  }
  return steps;
}

}  // namespace

Combined<Stacked> hessian_chain(const std::vector<const Chain*>& chains, const Runs& runs) {
  for (const Chain* chain : chains) check(runs, chain->gather.columns());
  const std::size_t stages = runs.starts.size() - 1;
  // Places of every block by stage.
  std::vector<std::vector<std::vector<std::size_t>>> places(chains.size());
  for (std::size_t b = 0; b < chains.size(); ++b) {
    places[b].resize(stages);
    for (std::size_t e = 0; e < chains[b]->count; ++e) places[b].at(chains[b]->stages[e]).push_back(e);
  }
  std::vector<Stacking> parts;
  for (const Chain* chain : chains) parts.emplace_back(chain->hessian.size() * chain->count);
  Pattern pattern;
  std::vector<std::int32_t> number;
  // Most stages read like the one before: then the products are the same, in the same order, and most often by the same
  // factors.
  std::vector<Reading> known(chains.size()), own(chains.size());
  std::vector<std::vector<Step>> steps(chains.size());
  std::vector<std::pair<std::int32_t, std::int32_t>> entries;
  std::vector<ChainProduct> products;
  for (std::size_t stage = 0; stage < stages; ++stage) {
    const std::int64_t first = runs.starts[stage];
    const auto width = static_cast<std::size_t>(runs.starts[stage + 1] - first);
    bool alike = stage > 0;
    for (std::size_t b = 0; b < chains.size(); ++b) {
      own[b].read(*chains[b], places[b][stage], first, width);
      alike = alike && own[b].local == known[b].local;
    }
    if (!alike) {
      number.assign(width * width, -1);
      for (std::size_t b = 0; b < chains.size(); ++b)
        steps[b] = steps_of(*chains[b], places[b][stage], first, width, number);
      entries.clear();
      for (std::size_t at = 0; at < number.size(); ++at) {
        if (number[at] < 0) continue;
        number[at] = static_cast<std::int32_t>(entries.size());
        entries.emplace_back(at / width, at % width);
      }
      // They ascend by source already.
      for (std::size_t b = 0; b < chains.size(); ++b) {
        for (Step& step : steps[b]) step.at = number[step.at];
        std::stable_sort(steps[b].begin(), steps[b].end(), [](const Step& x, const Step& y) { return x.at < y.at; });
      }
    }
    for (const auto& [row, column] : entries) pattern.add(first + row, first + column);
    for (std::size_t b = 0; b < chains.size(); ++b) {
      const Chain& chain = *chains[b];
      const std::vector<std::size_t>& here = places[b][stage];
      const std::size_t nonzeros = chain.hessian.size();
      if (alike && own[b].factors == known[b].factors && own[b].apart == known[b].apart) {
        const std::size_t moved = here.empty() ? 0 : here.front() - places[b][stage - 1].front();
        if (parts[b].repeat(static_cast<std::ptrdiff_t>(moved * nonzeros))) continue;
      }
      products.clear();
      products.reserve(steps[b].size());
      for (const Step& step : steps[b]) {
        const std::size_t place = here[step.place];
        const double* g = chain.gather.data() + chain.gather.starts()[place * chain.inputs];
        const double factor = g[step.i] * g[step.j];
        products.push_back(
            {step.at, static_cast<std::int32_t>(place * nonzeros) + step.nonzero, step.twice ? 2.0 * factor : factor});
      }
      ProductRows rows(nonzeros * chain.count);
      rows.append_sorted(products, entries.size());
      parts[b].append(rows.matrix());
    }
    std::swap(known, own);
  }
  Combined<Stacked> combined{std::move(pattern), {}, {}};
  for (Stacking& part : parts) combined.parts.push_back(part.stacked());
  return combined;
}

}  // namespace robotraj::native
