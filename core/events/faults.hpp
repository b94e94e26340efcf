#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

namespace evbench {

/// What is wrong with a recording. In strict mode the first fault is an InputError. Otherwise faults are counted, the
/// data they concern is skipped, and the faults are reported to the user.
class Faults {
 public:
  /// `file`: for messages.
  Faults(std::string file, bool strict) : file_(std::move(file)), strict_(strict) {}

  /// `kind`: what, e.g. "events outside the sensor"; `where`: the first one's place, e.g. "byte 1234".
  void add(const std::string& kind, const std::string& where, std::int64_t count = 1);

  struct Fault {
    std::int64_t count = 0;
    std::string first;  ///< place of the first one
  };
  const std::map<std::string, Fault>& all() const { return faults_; }
  bool empty() const { return faults_.empty(); }
  void clear() { faults_.clear(); }

 private:
  std::string file_;
  bool strict_;
  std::map<std::string, Fault> faults_;
};

}  // namespace evbench
