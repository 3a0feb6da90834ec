#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

/// Pieces of C++ text.
namespace titop::emit {

/// A double that reads back to the last bit, with a point or an exponent: "1.0", "6.02e+23".
/// Throws not_finite.
std::string number(double x);

/// "text" with quotes and escapes.
std::string quoted(std::string_view text);

/// One identifier per name, all different: "U(3)" is U_3, "z1.stretch" z1_stretch, "NULL" NULL_.
std::vector<std::string> identifiers(const std::vector<std::string>& names);

/// "{a, b, c}" broken into lines of at most 100 columns, the later ones indented by `indent`.
std::string list(const std::vector<std::string>& items, int indent);
std::string list(const Eigen::VectorXd& values, int indent);

/// The text with every @KEY@ replaced by its value.
std::string filled(std::string_view text,
                   const std::vector<std::pair<std::string_view, std::string>>& values);

}  // namespace titop::emit
