#include <titop/blocks/fe/mat.hpp>
#include <titop/blocks/fe/op4_build.hpp>
#include <titop/graph/support/mat_file.hpp>

namespace titop::fe {

std::vector<Op4Matrix> read_mat(const std::filesystem::path& path) {
  std::vector<Op4Matrix> all;
  for (titop::detail::MatMatrix& m : titop::detail::read_mat_file(path))
    all.push_back({.name = detail::capitals(m.name),
                   .form = 0,
                   .value = std::move(m.value),
                   .digits = m.single ? 7.0 : 15.0,
                   .unread = std::move(m.unread)});
  return all;
}

}  // namespace titop::fe
