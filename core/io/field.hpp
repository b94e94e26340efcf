#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace evbench {

/// A value in a JSON or YAML file from outside, with its place. Missing values and values of the wrong type throw an
/// InputError with file and keys: "cam_to_cam.yaml: intrinsics: has no cam0; ...".
class Field {
 public:
  static Field read_json(const std::string& path);
  static Field read_yaml(const std::string& path);

  bool has(const std::string& key) const { return value_->is_object() && value_->contains(key); }
  Field at(const std::string& key) const;
  Field at(std::size_t index) const;

  bool is_map() const { return value_->is_object(); }
  std::vector<std::string> keys() const;  ///< of a map; else empty

  double number() const;                                 ///< finite
  std::vector<double> numbers() const;                   ///< a list
  std::vector<double> numbers(std::size_t count) const;  ///< a list of that length
  std::string text() const;

  const std::string& place() const { return place_; }  ///< file and keys

  /// Throws an InputError that begins with the place.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  using Json = nlohmann::json;
  Field(std::shared_ptr<const Json> file, const Json* value, std::string place)
      : file_(std::move(file)), value_(value), place_(std::move(place)) {}

  std::shared_ptr<const Json> file_;
  const Json* value_;
  std::string place_;  ///< file and key
};

}  // namespace evbench
