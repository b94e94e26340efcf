#include "core/data/columns.hpp"

#include <array>

#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

constexpr std::array kQuantities{kTime, Quantity{"x", "(.*_)?x"}, Quantity{"y", "(.*_)?y"}};

Columns columns(const std::string& names) { return {names, kQuantities}; }

}  // namespace

TEST_CASE("Columns are identified by their names, with any separator and in any case") {
  CHECK(columns("t x y").text() == "t x y");
  CHECK(columns("# Timestamp, Pos X [m], foo, Y").text() == "t x - y");
  CHECK(columns("\"y\";\"x\";\"time\"").text() == "y x t");
}

TEST_CASE("Columns that match the same quantity are quoted, and a message's own stamp is preferred to other times") {
  CHECK(columns("a_x b_x y t").ambiguity() == "\"a_x\" and \"b_x\", either of which may be x");
  CHECK(columns("time, stamp, x, y").ambiguity() == "\"time\" and \"stamp\", either of which may be t");
  CHECK(columns("t_s,t_ns,x,y").ambiguity() == "\"t_s\" and \"t_ns\", either of which may be t");
  CHECK(columns("x y t").ambiguity().empty());
  const Columns topic = columns("%time,field.header.seq,field.header.stamp,field.x,field.y");
  CHECK(topic.text() == "- - t x y");
  CHECK(topic.ambiguity().empty());
  CHECK(columns("a.header.stamp,b.header.stamp,x,y").ambiguity() ==
        "\"a.header.stamp\" and \"b.header.stamp\", either of which may be t");
}

TEST_CASE("A time may be two columns, seconds and nanoseconds") {
  for (const char* names : {"sec,nsec,x,y", "t [s],header.stamp.secs,header.stamp.nsecs,x,y",
                            "stamp.nanosec,stamp.sec,x,y", "sec [s], nsec [ns], x, y"}) {
    CAPTURE(names);
    const Columns both = columns(names);
    CHECK(both.ambiguity().empty());
    CHECK(both.nanoseconds());
    CHECK(both.time_unit() == TimeUnit::seconds);
  }
  CHECK_FALSE(columns("sec,x,y").nanoseconds());
  CHECK_FALSE(columns("t_sec,stamp_nsec,x,y").ambiguity().empty());
}

TEST_CASE("The name of a time column gives its unit, in brackets or after it") {
  CHECK(columns("#timestamp [ns],x,y").time_unit() == TimeUnit::nanoseconds);
  CHECK(columns("# time [us] x y").time_unit() == TimeUnit::microseconds);
  CHECK(columns("x y t_ms").time_unit() == TimeUnit::milliseconds);
  CHECK(columns("x y t_\xC2\xB5s").time_unit() == TimeUnit::microseconds);
  CHECK(columns("t[\xCE\xBCs] x y").time_unit() == TimeUnit::microseconds);
  CHECK(columns("t(sec) x y").time_unit() == TimeUnit::seconds);
  CHECK(columns("t x y").time_unit() == TimeUnit::unsaid);
}

TEST_CASE("Times without a unit are seconds, nanoseconds if no other unit is possible, or unknown") {
  CHECK(usual_time_unit(0.0) == TimeUnit::seconds);
  CHECK(usual_time_unit(1.4e9) == TimeUnit::seconds);
  CHECK(usual_time_unit(1403636579763555584.0) == TimeUnit::nanoseconds);
  CHECK_FALSE(usual_time_unit(1403636579763555.0));
}

TEST_CASE("Times outside a range are reported with the unit in which they would be about in it") {
  CHECK(times_outside(50'000, 5'260'000, 0, 6, "unit") ==
        "go from 50000 to 5260000 s; in microseconds (unit: us) they would go from 0.05 to 5.26 s");
  CHECK(times_outside(2000, 4000, 0, 6, "unit") ==
        "go from 2000 to 4000 s; in milliseconds (unit: ms) they would go from 2 to 4 s");
  CHECK(times_outside(10, 20, 0, 6, "unit") == "go from 10 to 20 s");
}

TEST_CASE("A unit is found if times meet a range in exactly one unit") {
  CHECK(unit_that_meets(1.4e15, 1.4e15 + 1e7, 1.4e9, 1.4e9 + 5.0) == TimeUnit::microseconds);
  CHECK(unit_that_meets(1.4e12, 1.4e12 + 1e4, 1.4e9 + 9.0, 1.4e9 + 50.0) == TimeUnit::milliseconds);
  CHECK_FALSE(unit_that_meets(1.4e15, 1.4e15 + 1e7, 0.0, 60.0));
  CHECK_FALSE(unit_that_meets(1e11, 2e11, 50.0, 1e6));  // microseconds, or nanoseconds
}

TEST_CASE("Very long names match no quantity, and very many names are read") {
  constexpr std::array quantities{kTime, Quantity{"x", "(.*_)?x"}};
  std::string one, many;
  for (int i = 0; i < 30'000; ++i) {
    one += "a_";
    many += "a ";
  }
  CHECK_FALSE(Columns(one + "x", quantities).find("x"));
  CHECK(Columns(many + "x", quantities).find("x") == 30'000);
}
