#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/support/error.hpp"

namespace evbench {

/// Errors of several items of a list; what() is the last message.
class SeveralErrors : public InputError {
 public:
  SeveralErrors(std::vector<std::string> others, const std::string& last)
      : InputError(last), others_(std::move(others)) {}
  const std::vector<std::string>& others() const { return others_; }

 private:
  std::vector<std::string> others_;
};

/// Throws the messages as one error; does nothing if there are none. Called when the other items are done.
inline void throw_together(std::vector<std::string> messages) {
  if (messages.empty()) return;
  const std::string last = std::move(messages.back());
  messages.pop_back();
  throw SeveralErrors(std::move(messages), last);
}

}  // namespace evbench
