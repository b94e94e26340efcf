#include "core/io/text_reader.hpp"

#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

namespace {

/// The records of a text, columns joined by "|".
std::vector<std::string> records(const std::string& text) {
  const testing::TemporaryFolder folder;
  TextReader reader(folder.write("a.txt", text));
  std::vector<std::string> result;
  while (reader.next()) {
    std::string joined;
    for (const std::string_view column : reader.columns()) joined += std::string(column) + "|";
    result.push_back(joined);
  }
  return result;
}

using Records = std::vector<std::string>;

}  // namespace

TEST_CASE("Records are split at blanks, and comments and blank lines are skipped") {
  CHECK(records("1 2\n\n# no\n  \t\n\t 3 \t 4 \n% no\n") == Records{"1|2|", "3|4|"});
  CHECK(records("").empty());
}

TEST_CASE("Records are split at commas and semicolons with optional blanks, and may end with one") {
  CHECK(records("1,2\n3, 4\n5 ;6\n7;8;\n") == Records{"1|2|", "3|4|", "5|6|", "7|8|"});
  CHECK(records("1,,2\n,3\n") == Records{"1||2|", "|3|"});
}

TEST_CASE("A byte order mark is skipped") {
  CHECK(records("\xEF\xBB\xBF"
                "1 2\n") == Records{"1|2|"});
}

TEST_CASE("The comment directly before a record is available") {
  const testing::TemporaryFolder folder;
  TextReader reader(folder.write("a.txt", "# far\n# near\n1 2\n3 4\n# cut off\n\n5 6\n"));
  std::string comments;
  while (reader.next()) comments += "[" + reader.comment() + "]";
  CHECK(comments == "[# near][][]");
  CHECK(reader.columns().empty());
}

TEST_CASE("Windows line ends and a last line without a line end are read") {
  CHECK(records("1 2\r\n3 4") == Records{"1|2|", "3|4|"});
}

TEST_CASE("Lines that cross the reader's buffer are read completely") {
  std::string text;
  Records expected;
  for (int i = 0; i < 200; ++i) {
    const std::string line(4999 + static_cast<std::size_t>(i), static_cast<char>('a' + i % 26));
    text += line + "\n";
    expected.push_back(line + "|");
  }
  CHECK(records(text) == expected);
}

TEST_CASE("Errors name the file, the line, the value found and the expected one") {
  const testing::TemporaryFolder folder;
  TextReader reader(folder.write("a.txt", "# head\n1 2.5x 9223372036854775808\n"));
  REQUIRE(reader.next());
  CHECK(reader.place() == folder.file("a.txt") + ":2");
  CHECK_THROWS_WITH(reader.expect_columns(2, "a b"), ContainsSubstring("a.txt:2: has 3 columns; expected 2 (a b)"));
  CHECK_THROWS_WITH(reader.number(1, "the time"), ContainsSubstring("the time is \"2.5x\"; expected a finite number"));
  CHECK_THROWS_WITH(reader.integer(2, "the id"), ContainsSubstring("expected an integer"));
  CHECK(reader.integer(0, "the id") == 1);
}

TEST_CASE("A file that is no text file is refused") {
  const testing::TemporaryFolder folder;
  CHECK_THROWS_WITH(TextReader(folder.file("none")), ContainsSubstring("none: no such file"));
  CHECK_THROWS_WITH(TextReader(folder.path()), ContainsSubstring("is a folder"));
  CHECK_THROWS_WITH(records(std::string("1 2\n3 \0 4\n", 10)), ContainsSubstring("a.txt:2: has a NUL byte"));
  CHECK_THROWS_WITH(records(std::string(70000, '1')), ContainsSubstring("longer than 64 KiB"));
}
