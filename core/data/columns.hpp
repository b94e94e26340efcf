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

/// A quantity that columns hold: its name, and regular expressions of the names that files have for it, in lower case
/// with _ between words.
struct Quantity {
  const char* name;
  const char* aliases;
  const char* preferred = nullptr;  ///< of several columns that fit, those that fit this, too, count; none: all do
};

/// Time, as it is called in every file. A message's own stamp goes before the time at which it arrived.
inline constexpr Quantity kTime{"t", "(.*_)?(t|ts|times?|stamps?|timestamps?)", "(.*_)?header_(time)?stamp"};

/// What the columns of a text file hold.
class Columns {
 public:
  /// By their names, e.g. "#timestamp [ns], p_RS_R_x [m], q_RS_w []": between blanks, commas or semicolons, with units
  /// in brackets or behind _. Names that fit no quantity are of columns that are not read. A time may be two columns,
  /// "sec" and "nsec" with the same words before them.
  Columns(std::string_view names, std::span<const Quantity> quantities);

  /// "\"box_x\" and \"drone_x\", either of which may be px": names that fit one quantity, so that nothing tells which
  /// one is meant; empty: there are none.
  const std::string& ambiguity() const { return ambiguity_; }

  std::size_t size() const { return quantities_.size(); }
  std::optional<std::size_t> find(std::string_view quantity) const;

  /// Those of several quantities, in their order; empty unless all are there.
  std::vector<std::size_t> find_all(std::span<const Quantity> quantities) const;

  TimeUnit time_unit() const { return time_unit_; }                        ///< what the time's name says
  std::optional<std::size_t> nanoseconds() const { return nanoseconds_; }  ///< beside a time in whole seconds

  /// The columns of these quantities get these quantities from left to right.
  Columns in_order(std::span<const Quantity> quantities) const;

  /// "t px py pz qx qy qz qw -": a dash for what is not read.
  std::string text() const;

  /// Others follow, that are not read.
  Columns followed_to(std::size_t size) const;

 private:
  std::vector<std::string> quantities_;  ///< by column; empty: not read
  TimeUnit time_unit_ = TimeUnit::unsaid;
  std::optional<std::size_t> nanoseconds_;
  std::string ambiguity_;
};

/// The columns as the file names them: in the comment before the present record, where `complete` says that they are
/// all there, one for each column; or in the record itself, none of whose columns is a number: the reader goes on to
/// the next one. Throws when names in a record are not complete, saying what is `expected`, and when complete names are
/// ambiguous.
std::optional<Columns> read_names(TextReader& reader, std::span<const Quantity> quantities,
                                  const std::function<bool(const Columns&)>& complete, const std::string& expected);

/// For columns that are known otherwise: goes on to the next record where the present one is a line of names.
void pass_over_names(TextReader& reader);

/// The time of a record [s].
class TimeColumn {
 public:
  /// In the unit that is asked for, that the columns' names say, or the usual one of the present record's time, in this
  /// order; where nothing tells it, in the file's own, and unit() is unsaid.
  TimeColumn(const TextReader& reader, const Columns& columns, TimeUnit asked);

  /// Throws InputError, and says what the unit can be told by, where it is unsaid.
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

/// A sentence part: "the time is 1403636580838555, too late for seconds; expected its unit, ...".
std::string unknown_time_unit(double time);

}  // namespace evbench
