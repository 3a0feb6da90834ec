#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "raw.hpp"

/// OUTPUT2 as the Nastran manual describes it, in every byte order and word size.
namespace fe_test {

struct Op2Style {
  bool big_endian = false;
  bool long_words = false;  ///< words of 8 bytes
};

class Op2Writer {
 public:
  explicit Op2Writer(Op2Style style) : style_(style) {}
  std::string bytes;

  std::string integer(std::int64_t value) const {
    return style_.long_words ? raw(value) : raw(static_cast<std::int32_t>(value));
  }
  std::string real(double value) const {
    return style_.long_words ? raw(value) : raw(static_cast<float>(value));
  }
  std::string wide(double value) const { return raw(value); }
  std::string integers(const std::vector<std::int64_t>& values) const {
    std::string all;
    for (const std::int64_t v : values) all += integer(v);
    return all;
  }

  /// Records behind the header.
  void table(const std::string& name, const std::vector<std::string>& records) {
    start(name, {101, 0, 0, 0, 0, 0, 0});
    int part = -3;
    for (const std::string& record : records) {
      marker(part--), marker(1), marker(0);
      data(record);
    }
    marker(part), marker(1), marker(0), marker(0);
  }
  /// Real, of this type; strings of nonzero values.
  void matrix(const std::string& name, const Eigen::MatrixXd& M, int type) {
    start(name, {101, M.cols(), M.rows(), 2, type, M.rows(), 10000});
    int part = -3;
    for (Eigen::Index j = 0; j < M.cols(); ++j) {
      marker(part--), marker(1), marker(1);
      for (Eigen::Index i = 0; i < M.rows(); ++i) {
        const Eigen::Index first = i;
        std::string values;
        for (; i < M.rows() && M(i, j) != 0; ++i)
          values += type == 2 ? wide(M(i, j)) : real(M(i, j));
        if (values.empty()) continue;
        marker(static_cast<std::int64_t>(values.size() / word()));
        record(integer(first + 1) + values);
      }
    }
    marker(part), marker(1), marker(0), marker(0);
  }
  void end() { marker(0); }
  /// Date and label of PARAM,POST,-1.
  void label() {
    marker(3), record(integers({9, 8, 22}));
    marker(7), record(std::string(7 * word(), ' '));
    marker(2), record(std::string(2 * word(), ' '));
    marker(-1), marker(0);
  }
  void marker(std::int64_t value) { record(integer(value)); }
  void record(const std::string& content) {
    const std::string length = raw(static_cast<std::int32_t>(content.size()));
    bytes += length + content + length;
  }

 private:
  void data(const std::string& content) {
    marker(static_cast<std::int64_t>(content.size() / word()));
    record(content);
  }
  void start(const std::string& name, const std::vector<std::int64_t>& trailer) {
    std::string padded;  // four characters to a word
    for (std::size_t i = 0; i < 2; ++i) {
      std::string part = name.size() > 4 * i ? name.substr(4 * i, 4) : std::string();
      part.resize(word(), ' ');
      padded += part;
    }
    data(padded);
    marker(-1);
    data(integers(trailer));
    marker(-2), marker(1), marker(0);
    data(padded);
  }
  std::size_t word() const { return style_.long_words ? 8 : 4; }
  template <class T>
  std::string raw(T value) const {
    return fe_test::raw(value, style_.big_endian);
  }

  Op2Style style_;
};

}  // namespace fe_test
