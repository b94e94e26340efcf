#include "eval/sweep_record.hpp"

#include <fmt/format.h>

#include "core/support/error.hpp"
#include "eval/json_file.hpp"
#include "eval/record_reader.hpp"

namespace evbench {
namespace {

SweepRecordRun read_run(const RecordReader& json) {
  SweepRecordRun run{json.text("key"), json.text("label"), {}};
  const Json& axes = json.at("axes");
  if (!axes.is_object()) json.fail("axes", "an object, a value for each axis");
  const RecordReader values(axes, json.place() + ".axes");
  for (const auto& [name, value] : axes.items()) run.axes.emplace_back(name, values.text(name.c_str()));
  return run;
}

}  // namespace

SweepRecord read_sweep_record(const std::string& path) try {
  const Json file = read_json_file(path);
  const RecordReader json(file, path);
  SweepRecord plan{json.text("name"), {}};
  if (json.at("runs").is_null()) json.fail("runs", "the runs that the sweep plans");
  for (const RecordReader& run : json.list("runs")) plan.runs.push_back(read_run(run));
  return plan;
} catch (const InputError& error) {
  throw InputError(fmt::format("{}; the sweep's command writes it again, and runs are found without it", error.what()));
}

}  // namespace evbench
