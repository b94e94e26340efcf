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

/// A quantity that columns hold: its name, and a regular expression of the names that files have for it, in lower case
/// with _ between words.
struct Quantity {
  const char* name;
  const char* aliases;
};

/// Time, as it is called in every file.
inline constexpr Quantity kTime{"t", "(.*_)?(t|ts|times?|stamps?|timestamps?|secs?|seconds)"};

/// What the columns of a text file hold.
class Columns {
 public:
  /// By their names, e.g. "#timestamp [ns], p_RS_R_x [m], q_RS_w []": between blanks, commas or semicolons, with units
  /// in brackets or behind _. Of several names of a quantity the first one counts; other names are of columns that are
  /// not read.
  Columns(std::string_view names, std::span<const Quantity> quantities);

  std::size_t size() const { return quantities_.size(); }
  std::optional<std::size_t> find(std::string_view quantity) const;

  /// Those of several quantities, in their order; empty unless all are there.
  std::vector<std::size_t> find_all(std::span<const Quantity> quantities) const;

  TimeUnit time_unit() const { return time_unit_; }  ///< what the time's name says

  /// "t px py pz qx qy qz qw -": a dash for what is not read.
  std::string text() const;

  /// Others follow, that are not read.
  Columns followed_to(std::size_t size) const;

 private:
  std::vector<std::string> quantities_;  ///< by column; empty: not read
  TimeUnit time_unit_ = TimeUnit::unsaid;
};

/// The columns as the file names them: in the comment before the present record, where `complete` says that they are
/// all there, one for each column; or in the record itself, none of whose columns is a number: the reader goes on to
/// the next one. Throws when names in a record are not complete, saying what is `expected`.
std::optional<Columns> read_names(TextReader& reader, std::span<const Quantity> quantities,
                                  const std::function<bool(const Columns&)>& complete, const std::string& expected);

/// The time in a column [s].
class TimeColumn {
 public:
  /// In the unit that is asked for, that the column's name says, or the usual one of the present record's time, in this
  /// order. Throws where nothing tells it.
  TimeColumn(const TextReader& reader, std::size_t column, TimeUnit asked, TimeUnit named);

  double read(const TextReader& reader) const { return reader.number(column_, "the time") / per_second(unit_); }
  TimeUnit unit() const { return unit_; }

 private:
  std::size_t column_;
  TimeUnit unit_;
};

}  // namespace evbench
