#pragma once

#include <string>

#include "bench/experiment.hpp"
#include "core/plugin/registration.hpp"

namespace evbench::testing {

/// The built-in plugins.
inline const Plugins& known_plugins() {
  static const Plugins plugins = registered_plugins();
  return plugins;
}

/// Identity of a run: all that determines its trajectory.
inline JobIdentity identity_of(const RunConfig& run) {
  Digests digests;
  return identify(run.job, *make_source(run.job, known_plugins()), known_plugins(), digests);
}

inline std::string key_of(const RunConfig& run) { return identity_of(run).key; }

}  // namespace evbench::testing
