#include "core/data/problem.hpp"

#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

namespace {

// The records are deliberately in an unusual order.
const std::string kProblem =
    "OBS 0.5 1 10 20 0.7\n"
    "LM 1 4 5 6\n"
    "STATE 1 1.0 0 0 0 1 1 2 3 0.1 0.2 0.3 0.4 0.5 0.6\n"
    "QC 1 2 3 4 5 6\n"
    "LM 0 1 2 3\n"
    "STATE 0 0.0 0 0 0 1 0 0 0 0 0 0 0 0 0\n"
    "# a comment\n"
    "OBS 0.25 1 11 21 0.7\n"
    "OBS 0.25 0 12 22 0.7\n"
    "OBS 1.5 0 13 23 0.7\n"
    "CAM 200 201 120 90\n"
    "PRIORPOSE 0 0 0 0 1 0 0 0 1 2 3 4 5 6\n"
    "PRIORVEL 1 1 2 3 4 5 6 1 2 3 4 5 6\n"
    "LMPRIOR 0 1 2 3 0.5\n"
    "LMPRIOR 1 4 5 6 0.5\n";

Problem problem(const std::string& content) {
  const testing::TemporaryFolder folder;
  return read_problem(folder.write("problem.txt", content));
}

std::string without(const std::string& record) {
  std::string text = kProblem;
  const std::size_t at = text.find(record);
  REQUIRE(at != std::string::npos);
  return text.erase(at, text.find('\n', at) + 1 - at);
}

}  // namespace

TEST_CASE("A problem is read with its records in any order") {
  const Problem p = problem(kProblem);
  CHECK(p.camera.fy == 201.0);
  CHECK(p.qc[5] == 6.0);
  REQUIRE(p.states.size() == 2);
  CHECK(p.states[1].t == 1.0);
  CHECK(p.states[1].T.p == Vector3(1, 2, 3));
  CHECK(p.states[1].velocity[0] == 0.1);
  CHECK(p.landmarks == std::vector<Vector3>{{1, 2, 3}, {4, 5, 6}});
  REQUIRE(p.observations.size() == 4);
  CHECK(p.observations[0].landmark == 1);
  CHECK(p.observations[0].pixel == Vector2(10, 20));
  CHECK(p.pose_priors.at(0).sigma[5] == 6.0);
  CHECK(p.velocity_priors.at(0).velocity[3] == 4.0);
  CHECK(p.landmark_priors.at(1).sigma == 0.5);
}

TEST_CASE("A prepared problem has only usable observations, sorted, and no priors of unusable landmarks") {
  const Problem p = prepare(problem(kProblem));
  REQUIRE(p.observations.size() == 2);
  CHECK(p.observations[0].t == 0.25);
  CHECK(p.observations[0].landmark == 1);
  CHECK(p.observations[1].t == 0.5);
  REQUIRE(p.landmark_priors.size() == 1);
  CHECK(p.landmark_priors[0].landmark == 1);
  CHECK(p.landmarks.size() == 2);
}

TEST_CASE("A problem reads back exactly as written") {
  const testing::TemporaryFolder folder;
  const Problem p = problem(kProblem);
  write_file(folder.file("p.txt"), format_problem(p));
  CHECK(format_problem(read_problem(folder.file("p.txt"))) == format_problem(p));
}

TEST_CASE("An observation of a problem may have a covariance") {
  const Problem p = problem(kProblem + "OBS 0.5 1 3 4 0.5 -0.2 0.3\n");
  CHECK(p.observations.back().noise == PixelNoise(0.5, -0.2, 0.3));
  CHECK(format_problem(p).find("OBS 0.5 1 3 4 0.5 -0.2 0.3\n") != std::string::npos);
  CHECK_THROWS_WITH(problem(kProblem + "OBS 0.5 1 3 4 0.5 0.6 0.3\n"),
                    ContainsSubstring("problem.txt:16: the covariance xx xy yy is not positive definite"));
}

TEST_CASE("A damaged problem is refused with its line and fault") {
  CHECK_THROWS_AS(problem(""), InputError);
  CHECK_THROWS_WITH(problem(without("CAM")), ContainsSubstring("has no CAM record"));
  CHECK_THROWS_WITH(problem(without("QC")), ContainsSubstring("has no QC record"));
  CHECK_THROWS_WITH(problem(kProblem + "CAM 1 1 1 1\n"), ContainsSubstring("problem.txt:16: a second CAM"));
  CHECK_THROWS_WITH(problem(kProblem + "QC 1 1 1 1 1 1\n"), ContainsSubstring("problem.txt:16: a second QC"));
  CHECK_THROWS_WITH(problem(kProblem + "LM 1 0 0 0\n"), ContainsSubstring("problem.txt:16: a second LM 1"));
  CHECK_THROWS_WITH(problem(kProblem + "LM 3 0 0 0\n"),
                    ContainsSubstring("problem.txt:16") && ContainsSubstring("no LM 2"));
  CHECK_THROWS_WITH(problem(kProblem + "LM -1 0 0 0\n"), ContainsSubstring("the index is -1"));
  CHECK_THROWS_WITH(problem(without("STATE 0")), ContainsSubstring("no STATE 0"));
  CHECK_THROWS_WITH(problem(kProblem + "STATE 1 2 0 0 0 1 0 0 0 0 0 0 0 0 0\n"), ContainsSubstring("a second STATE 1"));
  CHECK_THROWS_WITH(problem(kProblem + "STATE 2 1 0 0 0 1 0 0 0 0 0 0 0 0 0\n"),
                    ContainsSubstring("problem.txt:16") && ContainsSubstring("strictly increasing"));
  CHECK_THROWS_WITH(problem(kProblem + "STATE 2 2 0 0 0 2 0 0 0 0 0 0 0 0 0\n"), ContainsSubstring("has norm 2"));
  CHECK_THROWS_WITH(problem(kProblem + "OBS 0.5 2 1 1 1\n"),
                    ContainsSubstring("problem.txt:16: landmark 2 does not exist"));
  CHECK_THROWS_WITH(problem(kProblem + "OBS 0.5 1 1 1 0\n"),
                    ContainsSubstring("problem.txt:16: sigma is 0; expected > 0"));
  CHECK_THROWS_WITH(problem(kProblem + "OBS 0.5 1 1 1\n"), ContainsSubstring("has 5 columns; expected 6"));
  CHECK_THROWS_WITH(problem(kProblem + "OBS nan 1 1 1 1\n"), ContainsSubstring("nan"));
  CHECK_THROWS_WITH(problem(kProblem + "PRIORVEL 2 0 0 0 0 0 0 1 1 1 1 1 1\n"),
                    ContainsSubstring("state 2 does not exist"));
  CHECK_THROWS_WITH(problem(kProblem + "LMPRIOR 9 0 0 0 1\n"), ContainsSubstring("landmark 9 does not exist"));
  CHECK_THROWS_WITH(problem(kProblem + "POSE 1\n"), ContainsSubstring("unknown record \"POSE\""));
}

TEST_CASE("The small and medium problems read whole") {
  const auto small = testing::problem_file("small.txt.gz");
  const auto medium = testing::problem_file("medium.txt.gz");
  if (!small || !medium) return;
  const Problem p = read_problem(*small);
  CHECK(p.observations.size() == 14541);
  CHECK(prepare(p).observations.size() == 14540);
  const Problem q = prepare(read_problem(*medium));
  CHECK(q.observations.size() == 132837);
  CHECK(q.states.size() == 601);
}
