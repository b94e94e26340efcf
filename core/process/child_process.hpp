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

/// A process of ours has failed: it could not be started, ended, kept silent or said what can't be understood. From
/// ChildProcess, what() is a predicate ("ended with exit code 3"); from Dialogue, a whole sentence.
class ProcessError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A program that runs beside this one and is spoken with in lines: one is told on its standard input, one is awaited
/// on its standard output. It has a process group of its own, inherits no open file but the standard ones, and is
/// killed with all of its group when this object ends. Not to be shared between threads.
class ChildProcess {
 public:
  /// Starts `words` (a program, searched in PATH when its name has no slash, and its arguments) in `folder`. Throws
  /// ProcessError when that can't be done.
  ChildProcess(const std::vector<std::string>& words, const std::string& folder);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Writes a line (its newline included) and returns the one that answers (without). Both directions and the standard
  /// error are served at the same time, so that neither side waits for the other one in vain. Throws ProcessError when
  /// there is no answer within `timeout` seconds, when the process ends or closes a stream instead, when it wrote
  /// before it was asked, and for a line of more than `longest` bytes; what check_interruption() throws when the
  /// program is asked to end.
  std::string exchange(std::string_view line, double timeout, std::size_t longest = kLongest);
  static constexpr std::size_t kLongest = std::size_t{256} << 20;

  /// Tells it that nothing more comes and waits until it ends, for `grace` seconds at most, unless the program is
  /// asked to end.
  void close(double grace) noexcept;

  /// Kills it and its group, at once.
  void kill() noexcept;

  /// The last lines of what it wrote on its standard error.
  const LineTail& errors() const { return errors_; }

 private:
  /// A pipe's end.
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
  Descriptor input_, output_, error_;  ///< our ends: of its standard input, output and error
  std::string received_;               ///< of its standard output, not yet handed on
  std::size_t searched_ = 0;           ///< of `received_`: no newline before
  bool ended_ = false;                 ///< not reaped before the object ends, so that its number stays its own
  int status_ = 0;                     ///< as waitpid's, once ended
  LineTail errors_;
};

}  // namespace evbench
