// The only file on the double-precision side, which libpinocchio already holds compiled.
#include "graph.hpp"

#include <pinocchio/serialization.hpp>

namespace robotraj {

Model read_model(const std::string& text) {
  pinocchio::Model numeric;
  pinocchio::serialization::loadFromString(numeric, text);
  return numeric.cast<SX>();
}

}  // namespace robotraj
