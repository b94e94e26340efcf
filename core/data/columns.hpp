#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/data/time_unit.hpp"
#include "core/io/text_reader.hpp"

namespace evbench {

/// A quantity that a column can contain: its name, and a regular expression of the column names that files use for it,
/// in lower case with _ between words.
struct Quantity {
  const char* name;
  const char* aliases;
  const char* preferred = nullptr;  ///< if several columns match, only those that match this count; none: all count
};

/// The time, as files name it. A message's own stamp is preferred to its arrival time.
inline constexpr Quantity kTime{"t", "(.*_)?(t|ts|times?|stamps?|timestamps?)", "(.*_)?header_(time)?stamp"};

/// The quantities in the columns of a text file.
class Columns {
 public:
  /// Identifies the columns by their names, e.g. "#timestamp [ns], p_RS_R_x [m], q_RS_w []": separated by blanks,
  /// commas or semicolons, with units in brackets or after _. Columns whose names match no quantity are not read. A
  /// time may be two columns, "sec" and "nsec" with the same prefix.
  Columns(std::string_view names, std::span<const Quantity> quantities);

  /// "\"box_x\" and \"drone_x\", either of which may be px": names that match the same quantity; empty: unambiguous.
  const std::string& ambiguity() const { return ambiguity_; }

  std::size_t size() const { return quantities_.size(); }
  std::optional<std::size_t> find(std::string_view quantity) const;

  /// The columns of several quantities, in their order; empty unless all exist.
  std::vector<std::size_t> find_all(std::span<const Quantity> quantities) const;

  TimeUnit time_unit() const { return time_unit_; }                        ///< from the name of the time column
  std::optional<std::size_t> nanoseconds() const { return nanoseconds_; }  ///< of a time in whole seconds

  /// A copy in which the columns of these quantities contain them in the given order, from left to right.
  Columns in_order(std::span<const Quantity> quantities) const;

  /// "t px py pz qx qy qz qw -": a dash for a column that is not read.
  std::string text() const;

  /// A copy with further columns that are not read, `size` in all.
  Columns followed_to(std::size_t size) const;

 private:
  std::vector<std::string> quantities_;  ///< by column; empty: not read
  TimeUnit time_unit_ = TimeUnit::unsaid;
  std::optional<std::size_t> nanoseconds_;
  std::string ambiguity_;
};

/// Reads the column names of a file: from the comment before the current record, if it has one name per column and
/// `complete` accepts them; or from the record itself, if none of its columns is a number (the reader then advances to
/// the next record). Throws when the names in a record are not complete, with the `expected` ones, and when complete
/// names are ambiguous.
std::optional<Columns> read_names(TextReader& reader, std::span<const Quantity> quantities,
                                  const std::function<bool(const Columns&)>& complete, const std::string& expected);

/// Skips the current record if it is a line of names, for columns that are known from elsewhere.
void pass_over_names(TextReader& reader);

/// Reads the time of a record [s].
class TimeColumn {
 public:
  /// The unit is, in this order: `asked`, the one in the column's name, or the usual one for the current record's time.
  /// If none applies, times keep the file's unit and unit() is unsaid.
  TimeColumn(const TextReader& reader, const Columns& columns, TimeUnit asked);

  /// Throws InputError with the ways to give the unit, if it is unsaid.
  void expect_unit(const TextReader& reader) const;

  double read(const TextReader& reader) const { return count(reader) / per_second(unit_); }
  TimeUnit unit() const { return unit_; }
  bool is_guessed() const { return guessed_; }  ///< the unit is the usual one, or unsaid

 private:
  std::size_t column_;
  std::optional<std::size_t> nanoseconds_;
  TimeUnit unit_;
  bool guessed_;

  double count(const TextReader& reader) const;
};

/// A phrase for messages: "the time is 1403636580838555, too late for seconds; expected its unit, ...".
std::string unknown_time_unit(double time);

}  // namespace evbench
