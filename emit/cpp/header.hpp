#pragma once

#include <string>
#include <titop/emit/cpp/form.hpp>

namespace titop::emit {

/// Names and sizes of the model.
struct Naming {
  std::string diagram, name;  ///< as the user wrote it; as the namespace
  std::vector<std::string> states, inputs, outputs;
  double sample_time = 0;  ///< 0: no step
};

/// The text of NAME.hpp.
std::string header_text(const Naming& names, const ModelForm& form);

/// Multiplications of derivative + output (+ step) as stored.
long long products(const ModelForm& form);

}  // namespace titop::emit
