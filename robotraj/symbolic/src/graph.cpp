#include "graph.hpp"

namespace robotraj {

Matrix to_eigen(const SX& source) {
  Matrix result(source.size1(), source.size2());
  for (Eigen::Index j = 0; j < result.cols(); ++j)
    for (Eigen::Index i = 0; i < result.rows(); ++i) result(i, j) = source(i, j);
  return result;
}

SymbolicModel::SymbolicModel(Tree tree_, bool parametric_) : tree(std::move(tree_)), parametric(parametric_) {
  if (!parametric) return;
  const auto njoints = static_cast<casadi_int>(tree.joints.size());
  inertias = SX::sym("inertias", 10, njoints);
  translations = SX::sym("translations", 3, njoints);
  const Matrix parameters = to_eigen(inertias);
  for (std::size_t joint = 1; joint < tree.joints.size(); ++joint) {
    const auto column = parameters.col(static_cast<Eigen::Index>(joint));
    const SX mass = column[0];
    // A body of mass 0 has no centre; dividing by 1 instead keeps it and its derivatives finite.
    const SX divisor = mass + (mass == 0);
    const Vector3 lever(column[1] / divisor, column[2] / divisor, column[3] / divisor);
    // I_origin = I_centre - m [c]x [c]x, in the order Ixx, Ixy, Iyy, Ixz, Iyz, Izz.
    const SX x = lever[0], y = lever[1], z = lever[2];
    Eigen::Matrix<SX, 6, 1> about_centre;
    about_centre << column[4] - mass * (y * y + z * z), column[5] + mass * x * y, column[6] - mass * (x * x + z * z),
        column[7] + mass * x * z, column[8] + mass * y * z, column[9] - mass * (x * x + y * y);
    tree.joints[joint].body = Inertia(mass, lever, Inertia::Symmetric3(about_centre));
    tree.joints[joint].placement.translation() =
        to_eigen(translations(casadi::Slice(), static_cast<casadi_int>(joint)));
  }
}

Matrix Graph::input(const std::string& name, Eigen::Index rows, Eigen::Index columns) {
  input(name, SX::sym(name, rows, columns));
  return to_eigen(inputs_.back());
}

void Graph::input(const std::string& name, const SX& symbols) {
  inputs_.push_back(symbols);
  input_names_.push_back(name);
}

Vector Graph::input(const std::string& name, Eigen::Index rows) { return input(name, rows, 1).col(0); }

void Graph::output(const std::string& name, const SX& expression) {
  outputs_.push_back(SX::densify(expression));
  output_names_.push_back(name);
}

std::string Graph::serialize(const std::string& name) const {
  std::vector<SX> inputs = inputs_;
  std::vector<std::string> input_names = input_names_;
  if (symbolic_.parametric) {
    inputs.insert(inputs.end(), {symbolic_.inertias, symbolic_.translations});
    input_names.insert(input_names.end(), {"inertias", "translations"});
  }
  return casadi::Function(name, inputs, outputs_, input_names, output_names_).serialize();
}

}  // namespace robotraj
