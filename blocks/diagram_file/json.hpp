#pragma once

#include <Eigen/Core>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <titop/graph/error.hpp>
#include <vector>

/// Common to the writer and the reader of diagram files.
namespace titop::diagram_file {

using Json = nlohmann::ordered_json;

/// More scalars than a signal in a file may have: a gain of n has n x n numbers.
inline constexpr int kMostScalars = 4096;

/// A matrix as a list of its rows, a vector as a list.
Json rows(const Eigen::MatrixXd& M);
Json list(const Eigen::VectorXd& v);

/// A place in a diagram file, with its path for messages: "blocks[3].mass". Unexpected content
/// throws bad_file with that path.
class JsonPlace {
 public:
  JsonPlace(const Json& json, std::string file) : json_(&json), file_(std::move(file)) {}

  bool has(const char* key) const { return json_->is_object() && json_->contains(key); }
  /// The value of this key, which must be there.
  JsonPlace at(const char* key) const;
  JsonPlace item(std::size_t index) const;
  std::size_t size() const;  ///< of a list
  /// Refuses keys that are none of these.
  void only(std::initializer_list<const char*> keys) const;

  double number() const;
  int integer() const;
  int signal_size() const;  ///< an integer from 1 to kMostScalars
  bool yes() const;
  std::string text() const;
  Eigen::VectorXd vector(Eigen::Index size = -1) const;                   ///< -1: any size
  Eigen::MatrixXd matrix(Eigen::Index rows, Eigen::Index columns) const;  ///< -1: any

  bool is_number() const { return json_->is_number(); }
  std::vector<std::string> keys() const;  ///< of an object, in the file's order
  std::string where() const;              ///< "cart.json: blocks[3]"
  [[noreturn]] void refuse(const std::string& expected) const;
  /// Rethrows the mistakes in the numbers of `name`, with this place.
  [[noreturn]] void rethrow(const Error& error, const std::string& name) const;

 private:
  JsonPlace(const Json& json, std::string file, std::string path)
      : json_(&json), file_(std::move(file)), path_(std::move(path)) {}

  const Json* json_;
  std::string file_, path_;
};

}  // namespace titop::diagram_file
