#include "core/events/bytes/wrapping_counter.hpp"

#include <span>
#include <vector>

#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

struct Outcome {
  std::vector<std::int64_t> times;
  std::int64_t steps_back = 0, wrong_words = 0;
};

/// Of a counter of 10 bits of 10 ms: 10.24 s.
Outcome count(const std::vector<std::uint32_t>& words) {
  WrappingCounter counter(10, 10'000);
  Outcome outcome;
  for (std::size_t i = 0; i < words.size(); ++i) outcome.times.push_back(counter.update(words[i], i));
  Faults faults("test", false);
  counter.report(faults);
  for (const auto& [kind, fault] : faults.all()) {
    (kind.starts_with("steps back") ? outcome.steps_back : outcome.wrong_words) += fault.count;
  }
  return outcome;
}

/// first, first + step, ..., below `end`.
std::vector<std::uint32_t> words(std::uint32_t first, std::uint32_t end, std::uint32_t step = 1) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t word = first; word < end; word += step) result.push_back(word);
  return result;
}

std::vector<std::uint32_t> operator+(std::vector<std::uint32_t> a, const std::vector<std::uint32_t>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

void check_fine(const Outcome& outcome) {
  CHECK(outcome.steps_back == 0);
  CHECK(outcome.wrong_words == 0);
}

}  // namespace

TEST_CASE("A counter is unwrapped at the end of its range, also if it begins near it") {
  for (const std::uint32_t first : {0u, 500u, 1000u, 1023u}) {
    const Outcome outcome = count(words(first, 1024) + words(0, 1024) + words(0, 10));
    check_fine(outcome);
    CHECK(outcome.times.back() == 2 * 1024 + 9);
    CHECK(std::ssize(outcome.times) == outcome.times.back() - first + 1);
  }
}

TEST_CASE("A counter may step back a little, at the end of its range, too") {
  const Outcome outcome = count({1020, 1023, 1022, 0, 1023, 1, 0, 2});
  check_fine(outcome);
  CHECK(outcome.times == std::vector<std::int64_t>{1020, 1023, 1022, 1024, 1023, 1025, 1024, 1026});
  CHECK(count({0, 1023, 1}).times == std::vector<std::int64_t>{0, -1, 1});
}

TEST_CASE("A counter wraps over a gap where it ran for as long") {
  const Outcome short_gap = count(words(900, 1000) + words(30, 40));
  check_fine(short_gap);
  CHECK(short_gap.times.back() == 1024 + 39);
  const Outcome long_gap = count(words(700, 900) + words(70, 80));
  check_fine(long_gap);
  CHECK(long_gap.times.back() == 1024 + 79);
  check_fine(count(words(0, 1024, 60) + words(40, 1024, 60)));  // events are that rare
  CHECK(count(words(0, 1024, 60) + words(40, 1024, 60)).times.back() == 1024 + 1000);
}

TEST_CASE("Gaps within the range are no fault") {
  const Outcome outcome = count({5, 6, 500, 501, 502, 503, 1000, 1001, 1023, 0});
  check_fine(outcome);
  CHECK(outcome.times.back() == 1024);
}

TEST_CASE("Words left over from before do not make everything after them late") {
  for (const std::uint32_t stale : {100u, 550u, 900u, 990u}) {
    CAPTURE(stale);
    const Outcome outcome = count(words(stale, stale + 3) + words(0, 300));
    CHECK(outcome.steps_back == 1);
    CHECK(outcome.wrong_words == 0);
    CHECK(outcome.times.back() == 299);
  }
}

TEST_CASE("A counter that restarts in the middle is a fault, and its times are taken as they are") {
  const Outcome outcome = count(words(0, 1024) + words(0, 500) + words(0, 200));
  CHECK(outcome.steps_back == 1);
  CHECK(outcome.times.back() == 1024 + 199);
}

TEST_CASE("Wrong words are recovered from, wherever they point") {
  for (const std::uint32_t at : {3u, 200u, 500u, 700u, 900u, 1021u}) {
    for (std::uint32_t wrong = 0; wrong < 1024; wrong += 31) {
      std::vector<std::uint32_t> all = words(0, 1024) + words(0, 100);
      if (std::abs(static_cast<int>(wrong) - static_cast<int>(at)) <= 25 || at + 1024 - wrong <= 25 ||
          wrong + 1024 - at <= 25) {
        continue;  // no jump
      }
      CAPTURE(at, wrong);
      all[at] = wrong;
      const Outcome outcome = count(all);
      CHECK(outcome.steps_back + outcome.wrong_words == 1);
      CHECK(outcome.times.at(at + 1) == at + 1);
      CHECK(outcome.times.back() == 1024 + 99);
    }
  }
}

TEST_CASE("Two wrong words, one after the other, are recovered from") {
  std::vector<std::uint32_t> all = words(0, 1000);
  all[300] = 900;
  all[301] = 20;
  CHECK(count(all).times.back() == 999);
}

TEST_CASE("Rare words are not taken for a return from a jump when the counter has wrapped") {
  const Outcome outcome = count(words(0, 1024, 30) + words(6, 1024, 30) + words(12, 1024, 30));
  check_fine(outcome);
  CHECK(outcome.times.back() == 2 * 1024 + 12 + 33 * 30);
}

TEST_CASE("Faults of a counter have their place, and are errors in strict mode") {
  WrappingCounter counter(12, 4096);
  counter.update(2000, 16);
  counter.update(0, 18);
  Faults strict("cut.raw", true);
  CHECK_THROWS_WITH(counter.report(strict), Catch::Matchers::StartsWith("cut.raw: byte 18: steps back") &&
                                                Catch::Matchers::ContainsSubstring("restarted"));
}
