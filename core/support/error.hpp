#pragma once

#include <stdexcept>

namespace evbench {

/// Bad input from outside: a file, a config, a command line. The message is one sentence that a user can act on:
/// where (file and line, or place in the JSON), what was found, what was expected. Caught once, in `main`.
/// Numerical failure is not an error but a `Status` in the results.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Nothing is wrong with the input, but what was to be written can't be: a full disk, a folder that is missing or not
/// writable. The program's exit code then is another one (README.md).
class OutputError : public InputError {
 public:
  using InputError::InputError;
};

}  // namespace evbench
