#include <fmt/format.h>

#include <algorithm>
#include <titop/blocks/diagram_file/json.hpp>
#include <titop/graph/error.hpp>

namespace titop::diagram_file {

using Eigen::Index;

Json rows(const Eigen::MatrixXd& M) {
  Json result = Json::array();
  for (Index i = 0; i < M.rows(); ++i) result.push_back(list(M.row(i)));
  return result;
}

Json list(const Eigen::VectorXd& v) {
  Json result = Json::array();
  for (const double x : v) result.push_back(x);
  return result;
}

namespace {

/// Lists in lists in lists: dump() would go down as deep on the stack.
bool is_deep(const Json& json, int levels) {
  if (!json.is_structured()) return false;
  return levels == 0 || std::any_of(json.begin(), json.end(),
                                    [&](const Json& item) { return is_deep(item, levels - 1); });
}

}  // namespace

std::string JsonPlace::where() const {
  return fmt::format("{}: {}", file_, path_.empty() ? "the whole" : path_);
}

void JsonPlace::rethrow(const Error& error, const std::string& name) const {
  std::vector<Mistake> mistakes = error.mistakes();
  for (Mistake& m : mistakes)
    if (m.code != Code::bad_file) m.message = fmt::format("{}, {}: {}", where(), name, m.message);
  throw Error(std::move(mistakes));
}

void JsonPlace::refuse(const std::string& expected) const {
  std::string found = is_deep(*json_, 20)
                          ? "lists too deep to print"
                          : json_->dump(-1, ' ', false, Json::error_handler_t::replace);
  if (found.size() > 60) found = found.substr(0, 57) + "...";
  throw Error(Code::bad_file, fmt::format("{}: found {}, expected {}", where(), found, expected),
              {});
}

JsonPlace JsonPlace::at(const char* key) const {
  if (!has(key)) refuse(fmt::format("an object with \"{}\"", key));
  return {(*json_)[key], file_, path_ + (path_.empty() ? "" : ".") + key};
}

JsonPlace JsonPlace::item(std::size_t index) const {
  return {(*json_)[index], file_, fmt::format("{}[{}]", path_, index)};
}

std::size_t JsonPlace::size() const {
  if (!json_->is_array()) refuse("a list");
  return json_->size();
}

std::vector<std::string> JsonPlace::keys() const {
  if (!json_->is_object()) refuse("an object");
  std::vector<std::string> result;
  for (const auto& [key, value] : json_->items()) result.push_back(key);
  return result;
}

void JsonPlace::only(std::initializer_list<const char*> allowed) const {
  for (const std::string& key : keys())
    if (std::find(allowed.begin(), allowed.end(), key) == allowed.end()) {
      std::string all;
      for (const char* k : allowed) all += (all.empty() ? "" : ", ") + std::string(k);
      refuse(fmt::format("no \"{}\" among {}", key, all));
    }
}

double JsonPlace::number() const {
  if (!json_->is_number()) refuse("a number");
  return json_->get<double>();
}

int JsonPlace::integer() const {
  if (!json_->is_number_integer() || json_->get<std::int64_t>() < -1'000'000'000 ||
      json_->get<std::int64_t>() > 1'000'000'000)
    refuse("an integer");
  return json_->get<int>();
}

int JsonPlace::signal_size() const {
  const int size = integer();
  if (size < 1) refuse("a size of 1 or more");
  if (size > kMostScalars) refuse(fmt::format("a size up to {}", kMostScalars));
  return size;
}

bool JsonPlace::yes() const {
  if (!json_->is_boolean()) refuse("true or false");
  return json_->get<bool>();
}

std::string JsonPlace::text() const {
  if (!json_->is_string()) refuse("a text");
  return json_->get<std::string>();
}

Eigen::VectorXd JsonPlace::vector(Index count) const {
  if (!json_->is_array() || (count >= 0 && static_cast<Index>(json_->size()) != count))
    refuse(count < 0 ? "a list of numbers" : fmt::format("a list of {} numbers", count));
  Eigen::VectorXd v(static_cast<Index>(json_->size()));
  for (Index i = 0; i < v.size(); ++i) v(i) = item(static_cast<std::size_t>(i)).number();
  return v;
}

Eigen::MatrixXd JsonPlace::matrix(Index row_count, Index columns) const {
  if (!json_->is_array() || (row_count >= 0 && static_cast<Index>(json_->size()) != row_count))
    refuse(row_count < 0 ? "a list of rows" : fmt::format("a list of {} rows", row_count));
  const auto n = static_cast<Index>(json_->size());
  Eigen::MatrixXd M(n, std::max<Index>(columns, 0));
  for (Index i = 0; i < n; ++i) {
    const Eigen::VectorXd row = item(static_cast<std::size_t>(i)).vector(columns);
    if (i == 0 && columns < 0) M.resize(n, columns = row.size());
    M.row(i) = row;
  }
  return M;
}

}  // namespace titop::diagram_file
