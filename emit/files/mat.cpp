#include <titop/emit/files/files.hpp>
#include <titop/graph/support/mat_file.hpp>

namespace titop {

namespace {

void write_mat(const StateSpace& m, const std::vector<std::string>& warnings,
               const std::filesystem::path& file) {
  detail::write_mat_file(
      file, {{"A", m.A}, {"B", m.B}, {"C", m.C}, {"D", m.D}},
      {{"states", m.states}, {"inputs", m.inputs}, {"outputs", m.outputs}, {"warnings", warnings}});
}

}  // namespace

void write_mat(const StateSpace& model, const std::filesystem::path& file) {
  write_mat(model, {}, file);
}

void write_mat(const System& system, const std::filesystem::path& file) {
  write_mat(system.state_space(), dense_warnings(system), file);
}

}  // namespace titop
