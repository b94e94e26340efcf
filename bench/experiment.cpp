#include "bench/experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <climits>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <vector>

#include "core/events/formats.hpp"
#include "core/io/file_content.hpp"
#include "core/io/path.hpp"
#include "core/io/spool.hpp"
#include "core/plugin/write_options.hpp"
#include "core/support/interruption.hpp"
#include "core/support/json.hpp"
#include "core/support/json_reason.hpp"
#include "eval/old_names.hpp"
#include "eval/protocols.hpp"

namespace evbench {
namespace {

/// The top level of a config file.
struct ExperimentOptions {
  std::string schema;
  std::string name;
  std::string description;
  std::int64_t seed = 1;
  double trajectory_rate = 100.0;
  Json plugins = Json::array();
  Json source, frontend, backend, backends;
  PipelineOptions pipeline;
  ScoreOptions evaluation;

  void declare(OptionSet& set) {
    set.add("name", name, "name of the experiment: its folder below --out; by default the config's file name");
    set.add("description", description, "purpose of the experiment");
    set.add("seed", seed, "seed of all random numbers").range(0);
    set.add("trajectory_rate", trajectory_rate,
            "rate at which final trajectories are sampled for scoring and writing [Hz]; 0: the back-end's own poses")
        .range(0.0, 1e5);
    set.add("plugins", plugins, "libraries with plugins: a list of paths");
    set.add("source", source, "the sequence: {\"type\": NAME, options}; see evbench list").required();
    set.add("frontend", frontend, "the front-end: {\"type\": NAME, options}").required();
    set.add("backend", backend, "one run: {\"type\": NAME, \"label\": TEXT, options}");
    set.add("backends", backends,
            "a comparison: a list of back-ends; they get identical tracks unless the front-end uses their feedback");
    set.group("pipeline", pipeline, "how front-end and back-end are coupled");
    set.group("evaluation", evaluation, "evaluation protocol: how trajectories are scored");
    set.add("$schema", schema, "path of the JSON Schema for editors (evbench describe config --schema)");
  }
};

/// The schema of the key `part` of `value`; null if there is none.
const Json* schema_below(const Json* schema, const Json& value, const std::string& part) {
  if (schema == nullptr) return nullptr;
  if (const auto choices = schema->find("anyOf"); choices != schema->end() && value.contains("type")) {  // a plugin
    const auto chosen = std::ranges::find_if(*choices, [&](const Json& choice) {
      return choice.value(Json::json_pointer("/properties/type/const"), Json()) == value["type"];
    });
    schema = chosen == choices->end() ? nullptr : &*chosen;
  }
  if (schema == nullptr) return nullptr;
  if (schema->contains("items")) return &schema->at("items");
  const auto properties = schema->find("properties");
  return properties != schema->end() && properties->contains(part) ? &properties->at(part) : nullptr;
}

/// Applies KEY=VALUE. The schema determines which values are text, and the default of a list of which one item is set.
void set_value(Json& config, const std::string& assignment, const Json& of_config,
               const std::string& origin = "--set") {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError(fmt::format("{} {}: expected KEY=VALUE", origin, assignment));
  }
  Json* target = &config;
  const Json* schema = &of_config;
  std::istringstream path(assignment.substr(0, equals));
  for (std::string part; std::getline(path, part, '.');) {
    if (target->is_null() && schema != nullptr && schema->contains("items") && schema->contains("default")) {
      *target = schema->at("default");
    }
    schema = schema_below(schema, *target, part);
    if (target->is_array()) {
      const bool number = !part.empty() && part.size() < 7 &&
                          std::ranges::all_of(part, [](unsigned char c) { return std::isdigit(c) != 0; });
      const std::size_t index = number ? std::stoul(part) : target->size();
      if (index >= target->size()) {
        throw InputError(
            fmt::format("{} {}: \"{}\" is not a position in a list of {}", origin, assignment, part, target->size()));
      }
      target = &(*target)[index];
    } else if (target->is_object() || target->is_null()) {
      target = &(*target)[part];
    } else {
      throw InputError(fmt::format("{} {}: the key before \"{}\" is a value, not an object", origin, assignment, part));
    }
  }
  const std::string text = assignment.substr(equals + 1);
  const bool is_text = schema != nullptr && schema->value("type", Json()) == "string";
  const Json value = is_text ? Json() : try_parse_json(text);
  *target = is_text || value.is_discarded() ? Json(text) : value;
}

/// Whether overrides name a protocol: it then replaces the config's options of protocols, not those of the overrides.
bool name_protocol(const std::vector<std::string>& overrides) {
  return std::ranges::any_of(overrides,
                             [](const std::string& text) { return text.starts_with("evaluation.protocol="); });
}

/// Whether an error is caused by an override: it names its place or one below, the list around it, or an unknown key
/// there.
bool is_about(const std::string& error, const std::string& path, const std::string& assignment) {
  const std::string key = assignment.substr(0, assignment.find('='));
  const std::size_t dot = key.rfind('.');
  const std::string last = key.substr(dot == std::string::npos ? 0 : dot + 1);
  const auto at = [&](const std::string& place, const char* behind) {
    return error.starts_with(fmt::format("{}: {}{}", path, place, behind));
  };
  const std::string parent = dot == std::string::npos ? path : fmt::format("{}: {}", path, key.substr(0, dot));
  const bool in_list = dot != std::string::npos && last.find_first_not_of("0123456789") == std::string::npos;
  return at(key, ": ") || at(key, ".") || (in_list && at(key.substr(0, dot), ": ")) ||
         error.starts_with(fmt::format("{}: unknown key \"{}\"", parent, last)) ||
         error.starts_with(fmt::format("{}: unknown key \"{}\"", path, key.substr(0, key.find('.'))));
}

/// Calls `read`. An error caused by an override names it.
template <class Read>
auto naming_overrides(const std::string& path, const std::vector<std::string>& overrides, const Read& read,
                      const std::string& origin = "--set") {
  try {
    return read();
  } catch (const Interrupted&) {
    throw;
  } catch (const InputError& error) {
    for (const std::string& assignment : overrides) {
      if (!is_about(error.what(), path, assignment)) continue;
      throw InputError(fmt::format("{} (from {} {})", error.what(), origin, assignment));
    }
    throw;
  }
}

Json parse_config(const std::string& path, const std::vector<std::string>& overrides, const Json& schema) {
  Json json = read_json(path);
  for (const std::string& assignment : overrides) set_value(json, assignment, schema);
  rename_old_keys(json);
  return json;
}

/// The base of relative paths in a config: its folder; for one from a pipe the working folder.
std::string folder_of(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::filesystem::current_path().string();
  return std::filesystem::absolute(path).parent_path().string();
}

/// The key "plugins", with relative paths resolved from the config's folder.
std::vector<std::string> plugin_paths(const Json& list, const std::string& path) {
  const auto is_path = [](const Json& item) { return item.is_string() && !item.get<std::string>().empty(); };
  if (!list.is_array() || !std::ranges::all_of(list, is_path)) {
    throw InputError(fmt::format("{}: plugins: expected a list of paths, found {}", path, dump_json(list)));
  }
  std::vector<std::string> paths;
  for (const Json& item : list) paths.push_back(anchored_path(item.get<std::string>(), folder_of(path)));
  return paths;
}

/// Reads "type" from a plugin's object and checks the rest as the plugin's options.
template <class Interface>
PluginConfig plugin(Json json, const std::string& place, const std::string& folder, const Plugins& plugins) {
  if (!json.is_object() || !json.contains("type") || !json["type"].is_string()) {
    throw InputError(
        fmt::format("{}: expected an object with \"type\": the name of a {}", place, PluginKind<Interface>::name));
  }
  PluginConfig result;
  result.type = json["type"].get<std::string>();
  result.place = place;
  json.erase("type");
  result.options = plugins.of<Interface>().find(result.type, place + ".type").resolve(json, place, folder);
  return result;
}

/// The libraries of a job's plugins, however they were loaded. They are written to the run's config.
std::vector<std::string> libraries_of(const Job& job, const Plugins& plugins) {
  return {plugins.of<Source>().find(job.source.type, job.source.place).origin,
          plugins.of<FrontEnd>().find(job.frontend.type, job.frontend.place).origin,
          plugins.of<BackEnd>().find(job.backend.type, job.backend.place).origin};
}

/// The back-ends by label.
std::vector<std::pair<std::string, PluginConfig>> backends(const ExperimentOptions& options, const std::string& path,
                                                           const Plugins& plugins) {
  if (options.backend.is_null() == options.backends.is_null()) {
    throw InputError(fmt::format(
        "{}: {}; expected either \"backend\" (one run) or \"backends\" (a comparison; \"backends.0\" is its first one)",
        path, options.backend.is_null() ? "there is no back-end" : "there are \"backend\" and \"backends\""));
  }
  const bool single = !options.backend.is_null();
  const Json list = single ? Json::array({options.backend}) : options.backends;
  if (!list.is_array() || list.empty()) {
    throw InputError(fmt::format("{}: backends: expected a list of at least one back-end", path));
  }
  std::vector<std::pair<std::string, PluginConfig>> result;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string place = single ? path + ": backend" : fmt::format("{}: backends.{}", path, i);
    Json json = list[i];
    std::string label;
    if (json.is_object() && json.contains("label")) {
      if (!json["label"].is_string() || json["label"].get<std::string>().empty()) {
        throw InputError(fmt::format("{}.label: expected text", place));
      }
      label = json["label"].get<std::string>();
      json.erase("label");
    }
    PluginConfig config = plugin<BackEnd>(std::move(json), place, folder_of(path), plugins);
    result.emplace_back(label.empty() ? config.type : label, std::move(config));
  }
  return result;
}

void check_name(const std::string& name, const std::string& path) {
  const bool fine = !name.empty() && name.front() != '.' && std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.' || c == '+';
  });
  if (!fine) {
    throw InputError(
        fmt::format("{}: name: \"{}\" can't name a folder; expected letters, digits, _ - . +", path, name));
  }
  if (name.size() > NAME_MAX) {
    throw InputError(fmt::format("{}: name: \"{:.40}...\" has {} characters; expected at most {}, as it names a folder",
                                 path, name, name.size(), NAME_MAX));
  }
}

/// Reads a parsed config.
Experiment read_config(const Json& json, const std::string& path, const Plugins& plugins) {
  const auto options = read_options<ExperimentOptions>(json, path);
  Experiment experiment;
  experiment.name = options.name.empty() ? std::filesystem::path(path).stem().string() : options.name;
  experiment.description = options.description;
  check_name(experiment.name, path);

  RunConfig run;
  run.experiment = experiment.name;
  run.evaluation = options.evaluation;
  run.job.seed = static_cast<std::uint64_t>(options.seed);
  run.job.trajectory_rate = options.trajectory_rate;
  run.job.pipeline = options.pipeline;
  run.job.folder = folder_of(path);
  run.job.source = plugin<Source>(options.source, path + ": source", run.job.folder, plugins);
  run.job.frontend = plugin<FrontEnd>(options.frontend, path + ": frontend", run.job.folder, plugins);
  for (auto& [label, backend] : backends(options, path, plugins)) {
    run.label = label;
    if (!options.backends.is_null()) run.position = experiment.runs.size();
    run.job.backend = std::move(backend);
    run.plugins = plugin_paths(options.plugins, path);
    for (const std::string& library : libraries_of(run.job, plugins)) {
      const bool named = std::ranges::find(run.plugins, library) != run.plugins.end();
      if (library != kBuiltIn && !named) run.plugins.push_back(library);
    }
    for (const RunConfig& other : experiment.runs) {
      if (other.label == run.label) {
        throw InputError(
            fmt::format("{}: two back-ends are labelled \"{}\"; give each a \"label\" of its own", path, label));
      }
    }
    experiment.runs.push_back(run);
  }
  return experiment;
}

/// Whether a file or folder is a recording of events, not JSON.
bool is_recording(const std::string& path) {
  std::error_code none;
  const bool is_file = std::filesystem::is_regular_file(path, none);  // a pipe can be read only once
  if (!is_file && !std::filesystem::is_directory(path, none)) return false;
  const int first = is_file ? (std::ifstream(path) >> std::ws).peek() : 0;
  if (first == '{' || first == '/') return false;  // an object, or a comment before it
  try {
    const auto reader = open_events(path, {});
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace

Json RunConfig::resolved() const {
  Json labelled = job.backend.with_type();
  labelled["label"] = label;
  return {{"name", experiment},
          {"seed", job.seed},
          {"trajectory_rate", job.trajectory_rate},
          {"plugins", plugins},
          {"source", job.source.with_type()},
          {"frontend", job.frontend.with_type()},
          {"backend", labelled},
          {"pipeline", write_options(job.pipeline)},
          {"evaluation", write_options(evaluation)}};
}

Json read_json(const std::string& path) {
  std::error_code none;
  if (is_recording(path)) {
    throw InputError(
        fmt::format("{0}: is a recording of events, no config; evbench new-config {0} writes one for it", path));
  }
  if (std::filesystem::is_directory(path, none)) {
    throw InputError(fmt::format("{}: is a folder; expected a JSON config", path));
  }
  if (path != "-" && !std::filesystem::exists(path, none)) throw InputError(fmt::format("{}: no such file", path));
  const std::optional<std::string> text = file_content(seekable_path(path));
  if (!text) throw InputError(fmt::format("{}: can't be read; expected a JSON config", path));
  std::vector<std::set<std::string>> keys;  // of the open objects: of two equal keys the parser would drop the first
  const auto take = [&](int, Json::parse_event_t event, const Json& parsed) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second) {
      throw InputError(fmt::format("{}: an object has the key {} twice; expected it once", path, dump_json(parsed)));
    }
    return true;
  };
  try {
    return Json::parse(*text, take, true, true);  // comments allowed
  } catch (const Json::exception& error) {        // also for numbers out of range
    throw InputError(fmt::format("{}: is not JSON: {}", path, json_reason(error)));
  }
}

ConfigFile::ConfigFile(const std::string& path, const Plugins& plugins) : ConfigFile(path, read_json(path), plugins) {}

ConfigFile::ConfigFile(std::string path, Json config, const Plugins& plugins)
    : path_(std::move(path)), config_(std::move(config)), schema_(experiment_schema(plugins)), plugins_(plugins) {}

Experiment ConfigFile::experiment(const std::vector<std::string>& overrides, const std::string& origin) const {
  Json config = config_;
  if (name_protocol(overrides) && config.is_object() && config.contains("evaluation")) {
    forget_protocol(config["evaluation"]);
  }
  for (const std::string& assignment : overrides) set_value(config, assignment, schema_, origin);
  std::vector<std::string> remarks = rename_old_keys(config);
  if (config.is_object() && config.contains("evaluation")) fill_in_protocol(config["evaluation"]);
  Experiment experiment = naming_overrides(
      path_, overrides, [&] { return read_config(config, path_, plugins_); }, origin);
  experiment.remarks = std::move(remarks);
  return experiment;
}

Experiment read_experiment(const std::string& path, const std::vector<std::string>& overrides, const Plugins& plugins) {
  return ConfigFile(path, plugins).experiment(overrides);
}

std::vector<std::string> read_plugin_paths(const std::string& path, const std::vector<std::string>& overrides) {
  const Json json = parse_config(path, overrides, Json());  // plugins are not loaded yet
  if (!json.is_object() || !json.contains("plugins")) return {};
  std::vector<std::string> paths = plugin_paths(json["plugins"], path);
  for (std::string& library : paths) library = resolve_path(library, folder_of(path));
  return paths;
}

std::vector<std::string> unknown_plugins(const std::string& path, const std::vector<std::string>& overrides,
                                         const Plugins& plugins) {
  const Json json = parse_config(path, overrides, Json());
  std::vector<std::string> unknown;
  const auto check_part = [&]<class Interface>(const Registry<Interface>& registry, const Json& part) {
    const Json type = part.is_object() ? part.value("type", Json()) : Json();
    const std::string name = type.is_string() ? type.get<std::string>() : "";
    if (!name.empty() && !registry.entries().contains(name)) {
      unknown.push_back(fmt::format("{} {}", PluginKind<Interface>::name, name));
    }
  };
  const auto part = [&](const char* key) { return json.is_object() ? json.value(key, Json()) : Json(); };
  check_part(plugins.of<Source>(), part("source"));
  check_part(plugins.of<FrontEnd>(), part("frontend"));
  check_part(plugins.of<BackEnd>(), part("backend"));
  for (const Json& backend : part("backends")) check_part(plugins.of<BackEnd>(), backend);
  return unknown;
}

ScoreOptions read_evaluation(const std::string& path, const Json& otherwise, const std::vector<std::string>& overrides,
                             const std::string& place) {
  Json json = {{"evaluation", otherwise}};
  ScoreOptions defaults;
  OptionSet set;
  defaults.declare(set);
  const Json schema = {{"properties", {{"evaluation", set.schema()}}}};
  if (!path.empty()) {
    const Json file = read_json(path);
    if (!file.is_object()) throw InputError(fmt::format("{}: expected a config with an \"evaluation\"", path));
    json["evaluation"] = file.value("evaluation", Json::object());
  }
  if (name_protocol(overrides)) forget_protocol(json["evaluation"]);
  for (const std::string& assignment : overrides) {
    if (!assignment.starts_with("evaluation.") && !assignment.starts_with("evaluation=")) {
      throw InputError(
          fmt::format("--set {}: expected evaluation.KEY=VALUE: scoring again uses only the protocol", assignment));
    }
    set_value(json, assignment, schema);
  }
  fill_in_protocol(json["evaluation"]);
  const std::string file = path.empty() ? place : path;
  return naming_overrides(file, overrides,
                          [&] { return read_options<ScoreOptions>(json["evaluation"], file + ": evaluation"); });
}

std::unique_ptr<Source> read_source(const std::string& path, const Plugins& plugins,
                                    const std::vector<std::string>& overrides) {
  const Json json = parse_config(path, overrides, experiment_schema(plugins));
  if (!json.is_object() || !json.contains("source")) {
    throw InputError(fmt::format("{}: expected a config with a \"source\"", path));
  }
  const Json seed = json.value("seed", Json(1));
  if (!seed.is_number_integer() || seed < 0)
    throw InputError(fmt::format("{}: seed: expected a whole number from 0 on", path));
  Job job;
  job.folder = folder_of(path);
  job.seed = seed.get<std::uint64_t>();
  return naming_overrides(path, overrides, [&] {
    job.source = plugin<Source>(json["source"], path + ": source", job.folder, plugins);
    return make_source(job, plugins);
  });
}

std::string describe_experiment() {
  ExperimentOptions options;
  OptionSet set;
  options.declare(set);
  return set.describe();
}

Json experiment_schema(const Plugins& plugins) {
  const auto choices = []<class Interface>(const Registry<Interface>& registry, bool labelled) {
    Json any = Json::array();
    for (const auto& [name, entry] : registry.entries()) {
      Json schema = entry.schema();
      Json properties = {{"type", {{"const", name}}}};
      if (labelled) properties["label"] = {{"type", "string"}, {"minLength", 1}, {"description", "its name in tables"}};
      properties.update(schema["properties"]);
      schema["properties"] = properties;
      schema["required"].push_back("type");
      schema["description"] = entry.text;
      any.push_back(schema);
    }
    return Json{{"anyOf", any}};
  };
  ExperimentOptions options;
  OptionSet set;
  options.declare(set);
  Json schema = set.schema();
  schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  schema["title"] = "evbench config";
  schema["properties"]["name"]["pattern"] = "^([A-Za-z0-9_+-][A-Za-z0-9_.+-]*)?$";
  schema["oneOf"] = {{{"required", {"backend"}}}, {{"required", {"backends"}}}};
  schema["properties"]["plugins"]["type"] = "array";
  schema["properties"]["plugins"]["items"] = {{"type", "string"}};
  schema["properties"]["source"] = choices(plugins.of<Source>(), false);
  schema["properties"]["frontend"] = choices(plugins.of<FrontEnd>(), false);
  schema["properties"]["backend"] = choices(plugins.of<BackEnd>(), true);
  schema["properties"]["backends"] = {
      {"type", "array"}, {"minItems", 1}, {"items", choices(plugins.of<BackEnd>(), true)}};
  return schema;
}

}  // namespace evbench
