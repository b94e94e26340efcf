#pragma once

#include <sys/types.h>

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/process/line_tail.hpp"

namespace evbench {

/// Failure of a child process: it can't be started, ended early, did not answer in time, or answered wrongly. what() is
/// a predicate from ChildProcess ("ended with exit code 3") and a whole sentence from Dialogue.
class ProcessError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A child process that communicates by lines: each line written to its standard input is answered by one line on its
/// standard output. It runs in its own process group, inherits only the standard streams, and is killed with its whole
/// group when this object is destroyed. Not for use from several threads.
class ChildProcess {
 public:
  /// Starts `words` (a program, searched in PATH when its name has no slash, and its arguments) in `folder`. Throws
  /// ProcessError when it can't be started.
  ChildProcess(const std::vector<std::string>& words, const std::string& folder);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Writes a line (with its newline) and returns the answer (without). Input, output and standard error are served at
  /// the same time, so no deadlock is possible. Throws ProcessError when there is no answer within `timeout` seconds,
  /// when the process ends or closes a stream, when it wrote before it was asked, and for a line of more than `longest`
  /// bytes. Throws what check_interruption() throws when the program is asked to end.
  std::string exchange(std::string_view line, double timeout, std::size_t longest = kLongest);
  static constexpr std::size_t kLongest = std::size_t{256} << 20;

  /// Closes its standard input and waits for its end, for at most `grace` seconds. Does not wait when the program is
  /// asked to end.
  void close(double grace) noexcept;

  /// Kills it and its group at once.
  void kill() noexcept;

  /// The last lines of its standard error.
  const LineTail& errors() const { return errors_; }

 private:
  /// One end of a pipe.
  class Descriptor {
   public:
    ~Descriptor() { close(); }
    void close() noexcept;
    void take(int number);  ///< above the standard ones, closed on exec
    int number() const { return number_; }
    bool is_open() const { return number_ >= 0; }

   private:
    int number_ = -1;
  };
  static void make_pipe(Descriptor& read_end, Descriptor& write_end);

  void spawn(const std::vector<std::string>& words, const std::string& folder, const Descriptor (&ends)[3]);
  void serve(std::string_view& unsent, int milliseconds);
  void write_some(std::string_view& unsent);
  void read_answer();
  void read_errors();
  std::optional<std::string> take_line(std::size_t longest);
  bool has_ended();
  [[noreturn]] void fail_ended(const char* otherwise);

  pid_t id_ = -1;
  Descriptor input_, output_, error_;  ///< our ends of its standard input, output and error
  std::string received_;               ///< from its standard output, not yet returned
  std::size_t searched_ = 0;           ///< `received_` has no newline before this position
  bool ended_ = false;                 ///< reaped only by the destructor, so that the process id stays valid
  int status_ = 0;                     ///< as waitpid's, once ended
  LineTail errors_;
};

}  // namespace evbench
