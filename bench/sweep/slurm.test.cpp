#include <cstdio>

#include "bench/testing/sweeps.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// A cluster on this host for the lifetime of this object, and shell commands for it.
class Cluster {
 public:
  explicit Cluster(const TemporaryFolder& folder) : folder_(folder) {
    started_ = shell("'" EVBENCH_SOURCE "/bench/slurm/one_host_cluster.sh' start cluster").exit_code == 0;
  }
  ~Cluster() { shell("'" EVBENCH_SOURCE "/bench/slurm/one_host_cluster.sh' stop cluster"); }
  Cluster(const Cluster&) = delete;
  Cluster& operator=(const Cluster&) = delete;

  bool started() const { return started_; }

  Outcome shell(const std::string& command) const {
    return testing::shell(folder_, "export SLURM_CONF='" + folder_.file("cluster/slurm.conf") + "'; " + command);
  }

 private:
  const TemporaryFolder& folder_;
  bool started_ = false;
};

bool has_slurm() { return std::system("command -v slurmctld slurmd sbatch > /dev/null 2>&1 && [ $(id -u) = 0 ]") == 0; }

}  // namespace

TEST_CASE("A sweep by Slurm has the same bytes, although a task is killed and a node goes down", "[cluster]") {
  if (!has_slurm()) {
    std::printf("SKIPPED: Slurm is not installed (slurm-wlm), or this is not root\n");
    return;
  }
  const TemporaryFolder folder;
  Json config = short_config();
  config["backend"]["batch_duration"] = 0.05;
  folder.write("c.json", dump_json(config));
  const std::string sweep = "\"$evbench\" sweep c.json --vary seed=1..8 ";
  REQUIRE(testing::shell(folder, sweep + "--quiet --out here").exit_code == 0);

  const Cluster cluster(folder);
  REQUIRE(cluster.started());
  const Outcome refused = cluster.shell(sweep + "--out there --executor slurm --partition none");
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, ContainsSubstring("Slurm refuses") && ContainsSubstring("invalid partition specified: none"));

  const Outcome submitted =
      cluster.shell(sweep + "--out there --executor slurm -j 3 --timeout 100 --setup 'export X=1'");
  REQUIRE(submitted.exit_code == 0);
  CHECK_THAT(submitted.out, ContainsSubstring("8 runs in 8 tasks"));
  const std::string wait_for_run =
      "for i in $(seq 200); do squeue -h -t R | grep -q . && ls there/short/*.evbench.lock > /dev/null 2>&1 && break;"
      "sleep 0.05; done; ";
  // The process of a task; its run ends with it.
  const Outcome killed = cluster.shell(wait_for_run + "pkill -9 -o -f '[e]vbench task " + folder.path() + "'");
  CHECK(killed.exit_code == 0);
  // Slurm moves its tasks to the other node after two minutes.
  const Outcome down = cluster.shell(
      wait_for_run +
      "node=$(squeue -h -t R -o %N | head -1); scontrol update nodename=$node state=down reason=test;"
      "sleep 1; for job in $(squeue -h -t PD -r -o %i); do scontrol update jobid=$job starttime=now 2> /dev/null; done;"
      "for i in $(seq 600); do squeue -h | grep -q . || break; sleep 0.1; done; squeue -h | wc -l");
  CHECK(down.out == "0\n");
  CHECK_THAT(read_file(folder.file("there/short/status.txt")), ContainsSubstring(" of 8 done, 0 failed, 0 running, "));
  CHECK_THAT(read_file(folder.file("there/short/table.md")),
             ContainsSubstring("| ATE [m] |") || ContainsSubstring("ATE [m]"));

  const Outcome again = cluster.shell("scontrol update nodename=node1,node2 state=resume; " + sweep +
                                      "--out there --executor slurm --wait");
  CHECK(again.exit_code == 0);
  auto there = results_of(folder.file("there/short"));
  there.erase("status.txt");
  there.erase("table.md");
  CHECK(difference(results_of(folder.file("here/short")), there) == "");
}
