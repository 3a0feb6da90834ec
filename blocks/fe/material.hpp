#pragma once

#include <optional>
#include <string>
#include <titop/graph/error.hpp>
#include <vector>

namespace titop {

/// Isotropic, linear elastic.
struct Material {
  double E = 0;                   ///< Young's modulus [Pa]
  std::optional<double> nu = {};  ///< Poisson's ratio, -1 < nu <= 0.5; G = E / (2 (1 + nu))
  std::optional<double> G = {};   ///< shear modulus [Pa]; give either nu or G
  double rho = 0;                 ///< density [kg/m^3]
};

/// G, or E / (2 (1 + nu)). [Pa]
double shear_modulus(const Material& material);

/// nu, or E / (2 G) - 1.
double poisson_ratio(const Material& material);

/// Adds `bad_value`: E or rho not positive and finite, both or neither of nu and G, nu of -1 or
/// less or above 0.5, G not positive. `owner`: "beam".
void add_mistakes(const Material& material, const std::string& owner,
                  std::vector<Mistake>& mistakes);

}  // namespace titop
