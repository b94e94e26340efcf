#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/support/error.hpp"

namespace evbench {

/// What went wrong with some of many; what() is the last of the messages.
class SeveralErrors : public InputError {
 public:
  SeveralErrors(std::vector<std::string> others, const std::string& last)
      : InputError(last), others_(std::move(others)) {}
  const std::vector<std::string>& others() const { return others_; }

 private:
  std::vector<std::string> others_;
};

/// Tells it when the others are done. Nothing where there are no messages.
inline void throw_together(std::vector<std::string> messages) {
  if (messages.empty()) return;
  const std::string last = std::move(messages.back());
  messages.pop_back();
  throw SeveralErrors(std::move(messages), last);
}

}  // namespace evbench
