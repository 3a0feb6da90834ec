#include <fmt/format.h>

#include <fstream>
#include <titop/graph/error.hpp>
#include <titop/graph/support/mat_file.hpp>

#ifdef TITOP_MATIO
#include <matio.h>

#include <array>
#include <memory>
#include <system_error>
#endif

namespace titop::detail {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& found,
                         const char* hint) {
  throw Error(Code::bad_file, fmt::format("{}: {}", path.filename().string(), found), hint);
}

}  // namespace

#ifdef TITOP_MATIO

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

struct Close {
  void operator()(mat_t* file) const { Mat_Close(file); }
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using File = std::unique_ptr<mat_t, Close>;
using Variable = std::unique_ptr<matvar_t, Close>;

constexpr std::size_t kMostEntries = 25'000'000;

/// Number of variables, by their lengths in the file: libmatio passes over one that ends early.
/// Other versions, of which HDF5 is one, begin with other texts.
std::size_t count_variables(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) refuse(path, "cannot be opened", "check the path");
  std::string head(128, ' ');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  if (!head.starts_with("MATLAB 5.0") || !stream)
    refuse(path, "no MAT-file of version 5",
           "write it by save -v6 or -v7 (MATLAB: save('FILE.mat', 'K', 'M', '-v7'))");
  const auto size = static_cast<std::size_t>(std::filesystem::file_size(path));
  std::size_t count = 0, at = head.size();
  const bool little = head[126] == 'I';
  for (; at + 8 <= size; ++count) {
    std::array<unsigned char, 8> tag{};
    stream.seekg(static_cast<std::streamoff>(at));
    stream.read(reinterpret_cast<char*>(tag.data()), 8);
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | tag.at(little ? 7 - i : 4 + i);
    at += 8 + length;
  }
  if (at != size || !stream)
    refuse(path, fmt::format("variable {} ends early", count),
           "let the program that wrote it run to its end");
  return count;
}

std::string unread(const matvar_t& v) {
  if (v.class_type != MAT_C_DOUBLE && v.class_type != MAT_C_SINGLE && v.class_type != MAT_C_SPARSE)
    return "is no matrix of floating-point numbers: write double(...) of it";
  if (v.rank != 2) return fmt::format("has {} dimensions, a matrix has two", v.rank);
  if (v.isComplex != 0) return "is complex: write its real part";
  if (v.dims[0] == 0 || v.dims[1] == 0) return "is empty";
  if (v.dims[1] > kMostEntries / v.dims[0]) return "has more than 25 million entries";
  return {};
}

template <class Number>
MatrixXd dense(const matvar_t& v) {
  using Matrix = Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>;
  return Eigen::Map<const Matrix>(static_cast<const Number*>(v.data), static_cast<Index>(v.dims[0]),
                                  static_cast<Index>(v.dims[1]))
      .template cast<double>();
}

/// Compressed columns. Throws for indices that the matrix does not have.
MatrixXd sparse(const std::filesystem::path& path, const matvar_t& v) {
  const auto& s = *static_cast<const mat_sparse_t*>(v.data);
  const auto bad = [&] {
    refuse(path, fmt::format("{}: broken indices", v.name), "write it again");
  };
  if (s.njc != v.dims[1] + 1 || v.data_type != MAT_T_DOUBLE) bad();
  MatrixXd result = MatrixXd::Zero(static_cast<Index>(v.dims[0]), static_cast<Index>(v.dims[1]));
  for (std::size_t j = 0; j < v.dims[1]; ++j)
    for (std::size_t k = s.jc[j]; k < s.jc[j + 1]; ++k) {
      if (k >= s.nir || k >= s.ndata || s.ir[k] >= v.dims[0]) bad();
      result(static_cast<Index>(s.ir[k]), static_cast<Index>(j)) =
          static_cast<const double*>(s.data)[k];
    }
  return result;
}

MatMatrix read_variable(const std::filesystem::path& path, mat_t* file, matvar_t& v) {
  MatMatrix result{v.name ? v.name : "", {}, v.class_type == MAT_C_SINGLE, unread(v)};
  if (!result.unread.empty()) return result;
  if (Mat_VarReadDataAll(file, &v) != 0 || v.data == nullptr)
    refuse(path, fmt::format("the data of {} end early", result.name),
           "let the program that wrote it run to its end");
  if (v.class_type == MAT_C_SPARSE)
    result.value = sparse(path, v);
  else
    result.value = result.single ? dense<float>(v) : dense<double>(v);
  if (!result.value.allFinite())
    refuse(path, fmt::format("{} has an entry that is no finite number", result.name),
           "write finite numbers");
  return result;
}

using MatSizes = std::array<std::size_t, 2>;

Variable text_variable(const std::string& text) {
  MatSizes dims = {text.empty() ? 0U : 1U, text.size()};
  return Variable(Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UINT8, 2, dims.data(),
                                const_cast<char*>(text.data()), 0));
}

Variable cell_variable(const MatTexts& list) {
  MatSizes dims = {list.texts.size(), 1};
  Variable cell(
      Mat_VarCreate(list.name.c_str(), MAT_C_CELL, MAT_T_CELL, 2, dims.data(), nullptr, 0));
  for (int i = 0; const std::string& text : list.texts)
    if (cell) Mat_VarSetCell(cell.get(), i++, text_variable(text).release());
  return cell;
}

Variable matrix_variable(const MatMatrix& m) {
  MatSizes dims = {static_cast<std::size_t>(m.value.rows()),
                   static_cast<std::size_t>(m.value.cols())};
  return Variable(Mat_VarCreate(m.name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims.data(),
                                const_cast<double*>(m.value.data()), 0));
}

}  // namespace

std::vector<MatMatrix> read_mat_file(const std::filesystem::path& path) {
  const std::size_t count = count_variables(path);
  const File file(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  if (!file) refuse(path, "cannot be read", "write it again");
  std::vector<MatMatrix> all;
  while (const Variable v{Mat_VarReadNextInfo(file.get())})
    all.push_back(read_variable(path, file.get(), *v));
  if (all.size() != count)
    refuse(path, fmt::format("variable {} of {} cannot be read", all.size() + 1, count),
           "write it again, as a matrix");
  return all;
}

void write_mat_file(const std::filesystem::path& path, const std::vector<MatMatrix>& matrices,
                    const std::vector<MatTexts>& texts) {
  const std::filesystem::path part = path.string() + ".part";
  File file(Mat_CreateVer(part.c_str(), "MATLAB 5.0 MAT-file, written by titop", MAT_FT_MAT5));
  bool done = file != nullptr;
  const auto write = [&](const Variable& v) {
    done = done && v && Mat_VarWrite(file.get(), v.get(), MAT_COMPRESSION_NONE) == 0;
  };
  for (const MatMatrix& m : matrices) write(matrix_variable(m));
  for (const MatTexts& t : texts) write(cell_variable(t));
  done = done && Mat_Close(file.release()) == 0;
  std::error_code failed;
  if (done) std::filesystem::rename(part, path, failed);
  if (!done || failed) refuse(path, "cannot be written", "check the path and the disk");
}

#else

namespace {

constexpr const char* kWithout =
    "install libmatio (Debian package libmatio-dev) and build titop again; or write_matlab for "
    "models, and OP4 or DMIG for matrices";

}  // namespace

std::vector<MatMatrix> read_mat_file(const std::filesystem::path& path) {
  refuse(path, "this titop was built without libmatio, which reads MAT-files", kWithout);
}

void write_mat_file(const std::filesystem::path& path, const std::vector<MatMatrix>&,
                    const std::vector<MatTexts>&) {
  refuse(path, "this titop was built without libmatio, which writes MAT-files", kWithout);
}

#endif

}  // namespace titop::detail
