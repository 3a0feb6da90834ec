#include <fmt/format.h>

#include <cmath>
#include <titop/blocks/fe/material.hpp>

namespace titop {

double shear_modulus(const Material& m) { return m.G ? *m.G : m.E / (2 * (1 + *m.nu)); }

double poisson_ratio(const Material& m) { return m.nu ? *m.nu : m.E / (2 * *m.G) - 1; }

void add_mistakes(const Material& material, const std::string& owner,
                  std::vector<Mistake>& mistakes) {
  const auto add = [&](std::string message, std::string hint) {
    mistakes.push_back({Code::bad_value, std::move(message), {}, std::move(hint)});
  };
  const auto positive = [&](double value, const char* subject) {
    if (!(value > 0) || !std::isfinite(value))
      add(fmt::format("{} of the {} is {}, not a positive number", subject, owner, value),
          "its material must give it, in SI units");
  };
  positive(material.E, "material.E");
  positive(material.rho, "material.rho");
  if (material.nu.has_value() == material.G.has_value())
    add(fmt::format("material of the {} has {} of nu and G", owner,
                    material.nu ? "both" : "neither"),
        "give one of them: either follows from the other and E");
  else if (const auto nu = material.nu; nu && !(*nu > -1 && *nu <= 0.5))
    add(fmt::format("material.nu of the {} is {}, not above -1 and up to 0.5", owner, *nu),
        "Poisson's ratio is a fraction, 0.33 of aluminium");
  else
    positive(shear_modulus(material), "shear modulus");
}

}  // namespace titop
