#include <fmt/format.h>

#include <cmath>
#include <map>
#include <titop/blocks/fe/modal_csv.hpp>
#include <titop/blocks/fe/scaled.hpp>
#include <titop/blocks/fe/text_file.hpp>

namespace titop::fe {

namespace {

using Fields = std::vector<std::string_view>;

class ModalReader {
 public:
  explicit ModalReader(const TextFile& file) : file_(file) {
    for (const TextLine& line : lines_of(file)) {
      const std::string_view text = trim(line.text.substr(0, line.text.find('#')));
      if (!text.empty()) read(line.number, comma_fields(text));
    }
    require_line_end(file, mistakes_);
    if (D_P_rows_ != 6) mistake(0, fmt::format("{} lines D_P", D_P_rows_), "six, row by row");
    mistakes_.finish();
  }

  ModalData data() const {
    ModalData d = data_;
    const auto n = static_cast<Eigen::Index>(modes_.size());
    d.omega.resize(n), d.xi.resize(n), d.L_P.resize(n, 6);
    for (ModalChild& child : d.children) child.Phi_C.resize(6, n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const std::vector<double>& mode = modes_[static_cast<std::size_t>(k)];
      d.omega(k) = mode[0];
      d.xi(k) = mode[1];
      for (Eigen::Index i = 0; i < 6; ++i) d.L_P(k, i) = mode[static_cast<std::size_t>(2 + i)];
      for (std::size_t c = 0; c < d.children.size(); ++c)
        for (std::size_t i = 0; i < 6; ++i)
          d.children[c].Phi_C(static_cast<Eigen::Index>(i), k) = mode[8 + 6 * c + i];
    }
    d.D_P.diagonal().head<3>().array() += at_P_;
    return scaled(std::move(d), units_);
  }

 private:
  void mistake(int line, const std::string& found, const std::string& expected) {
    mistakes_.add(bad_line(file_, line, found, expected));
  }

  void require_first(int line, std::string_view word) {
    const auto [at, is_new] = first_.insert({std::string(word), line});
    if (!is_new)
      mistake(line, fmt::format("{} again", word),
              fmt::format("{} once: line {} has it", word, at->second));
  }

  /// The `count` numbers after the first `skip` fields; empty, with a mistake noted, if their
  /// number differs. `subject`: all fields expected after the keyword.
  std::vector<double> numbers(int line, const Fields& fields, std::size_t skip, std::size_t count,
                              const std::string& subject) {
    if (fields.size() != skip + count) {
      mistake(line, fmt::format("{} fields behind {}", fields.size() - 1, fields[0]),
              fmt::format("{}: {}", skip + count - 1, subject));
      return {};
    }
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i)
      if (!parse(fields[skip + i], values[i])) {
        mistake(line, fmt::format("'{}' as field {}", fields[skip + i], skip + i + 1),
                "a finite number");
        return {};
      }
    return values;
  }

  void read(int line, const Fields& fields) {
    const std::string_view word = fields[0];
    if (word == "units" || word == "digits" || word == "at P") require_first(line, word);
    if (word == "units") return read_units(line, fields);
    if (word == "digits") return read_digits(line, fields);
    if (word == "at P") return read_one(line, fields, at_P_);
    if (word == "D_P") return read_D_P(line, fields);
    if (word == "child") return read_child(line, fields);
    if (word == "mode") return read_mode(line, fields);
    if (word == "modal mass") return read_modal_mass(line, fields);
    mistake(line, fmt::format("'{}'", word), "units, digits, D_P, at P, child, mode or modal mass");
  }

  void read_units(int line, const Fields& fields) {
    const auto values = numbers(line, fields, 1, 3, "units of length, mass and time");
    if (values.empty()) return;
    units_ = {values[0], values[1], values[2]};
    for (const double v : values)
      if (!(v > 0)) return mistake(line, fmt::format("a unit of {}", v), "a positive number");
  }

  void read_one(int line, const Fields& fields, double& value) {
    const auto values = numbers(line, fields, 1, 1, "a number");
    if (values.empty()) return;
    if (values[0] < 0) return mistake(line, fmt::format("{}", values[0]), "a number of 0 or more");
    value = values[0];
  }

  void read_digits(int line, const Fields& fields) {
    read_one(line, fields, data_.digits);
    if (data_.digits == 0)
      mistake(line, "0", "a number of digits above 0: how many the data carry");
  }

  void read_D_P(int line, const Fields& fields) {
    const auto values = numbers(line, fields, 1, 6, "one row of the mass matrix about P");
    if (++D_P_rows_ > 6 || values.empty()) return;
    for (std::size_t i = 0; i < 6; ++i)
      data_.D_P(D_P_rows_ - 1, static_cast<Eigen::Index>(i)) = values[i];
  }

  void read_child(int line, const Fields& fields) {
    if (!modes_.empty()) return mistake(line, "a child behind a mode", "children before modes");
    if (fields.size() < 2 || fields[1].empty()) return mistake(line, "no name", "the child's name");
    const auto values = numbers(line, fields, 2, 3, "its name and x, y, z from P");
    if (values.empty()) return;
    require_first(line, fmt::format("child {}", fields[1]));
    data_.children.push_back(
        {std::string(fields[1]), Vector3d(values[0], values[1], values[2]), {}});
  }

  void read_mode(int line, const Fields& fields) {
    auto values = numbers(
        line, fields, 1, 8 + 6 * data_.children.size(),
        fmt::format("omega, damping ratio, 6 of L_P, 6 of Phi for each child ({} before this line)",
                    data_.children.size()));
    if (!values.empty()) modes_.push_back(std::move(values));
  }

  void read_modal_mass(int line, const Fields& fields) {
    const auto values = numbers(line, fields, 1, 1, "a number");
    if (values.empty()) return;
    if (modes_.empty() || !(values[0] > 0))
      return mistake(line, fmt::format("a modal mass of {}", values[0]),
                     "a positive number behind a mode");
    require_first(line, fmt::format("modal mass of mode {}", modes_.size()));
    for (std::size_t i = 2; i < modes_.back().size(); ++i) modes_.back()[i] /= std::sqrt(values[0]);
  }

  const TextFile& file_;
  FileMistakes mistakes_;
  std::map<std::string, int> first_;  ///< lines of entries that are allowed once
  ModalData data_;
  DataUnits units_;
  double at_P_ = 0;
  int D_P_rows_ = 0;
  std::vector<std::vector<double>> modes_;  ///< omega, xi, L_P, Phi of each child
};

}  // namespace

ModalData read_modal_csv(const std::filesystem::path& path) {
  const TextFile file = read_text(path);
  require_text(file);
  return ModalReader(file).data();
}

namespace {

void require_sizes(const ModalData& data) {
  const Eigen::Index n = data.omega.size();
  const auto check = [n](const std::string& subject, Eigen::Index rows, Eigen::Index columns,
                         Eigen::Index rows_wanted, Eigen::Index columns_wanted) {
    if (rows != rows_wanted || columns != columns_wanted)
      throw Error(Code::size, fmt::format("{} of modal data is {} x {}", subject, rows, columns),
                  fmt::format("with {} modes it is {} x {}", n, rows_wanted, columns_wanted));
  };
  check("xi", data.xi.size(), 1, n, 1);
  check("L_P", data.L_P.rows(), data.L_P.cols(), n, 6);
  for (const ModalChild& c : data.children)
    check("Phi_C of child " + c.name, c.Phi_C.rows(), c.Phi_C.cols(), 6, n);
}

/// No field or line separators, and no blanks at the ends, which the reader trims.
void require_writable(const std::string& name) {
  if (!name.empty() && name.find_first_of(",#\r\n") == std::string::npos && trim(name) == name)
    return;
  throw Error(Code::bad_value, fmt::format("'{}' cannot be a child's name in modal data", name),
              "give one without comma, #, line ends, and blanks at its ends");
}

}  // namespace

std::string modal_csv(const ModalData& data) {
  require_sizes(data);
  for (const ModalChild& c : data.children) require_writable(c.name);
  if (!data.lines.empty())
    throw Error(Code::bad_value,
                fmt::format("line {} cannot be written to a table of modes", data.lines[0].name),
                "write a diagram of the body: write_diagram(diagram_of_body(data), file)");
  std::string text = fmt::format("digits, {}\n", data.digits);
  for (int i = 0; i < 6; ++i) {
    text += "D_P";
    for (int j = 0; j < 6; ++j) text += fmt::format(", {}", data.D_P(i, j));
    text += "\n";
  }
  for (const ModalChild& c : data.children)
    text += fmt::format("child, {}, {}, {}, {}\n", c.name, c.PC.x(), c.PC.y(), c.PC.z());
  for (Eigen::Index k = 0; k < data.omega.size(); ++k) {
    text += fmt::format("mode, {}, {}", data.omega(k), data.xi(k));
    for (Eigen::Index i = 0; i < 6; ++i) text += fmt::format(", {}", data.L_P(k, i));
    for (const ModalChild& c : data.children)
      for (Eigen::Index i = 0; i < 6; ++i) text += fmt::format(", {}", c.Phi_C(i, k));
    text += "\n";
  }
  return text;
}

}  // namespace titop::fe
