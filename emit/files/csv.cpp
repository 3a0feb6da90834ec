#include <fmt/format.h>

#include <titop/emit/files/files.hpp>
#include <titop/emit/text/csv.hpp>
#include <titop/emit/text/write_file.hpp>

namespace titop {

void write_csv(const System& system, std::span<const double> omega,
               const std::filesystem::path& file) {
  std::string text = "rad_per_s";
  for (const std::string& out : system.outputs())
    for (const std::string& in : system.inputs())
      for (const char* part : {"re", "im"})
        text += fmt::format(",{}", emit::csv_field(fmt::format("{}({}/{})", part, out, in)));
  text += "\n";
  const std::vector<Eigen::MatrixXcd> response = system.frequency_response(omega);
  for (std::size_t k = 0; k < omega.size(); ++k) {
    text += fmt::format("{}", omega[k]);
    for (Eigen::Index i = 0; i < response[k].rows(); ++i)
      for (Eigen::Index j = 0; j < response[k].cols(); ++j)
        text += fmt::format(",{},{}", response[k](i, j).real(), response[k](i, j).imag());
    text += "\n";
  }
  emit::write_file(file, text);
}

}  // namespace titop
