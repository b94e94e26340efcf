#pragma once

#include <string>

#include "bench/experiment.hpp"
#include "core/plugin/registration.hpp"

namespace evbench::testing {

/// The plugins that are built in.
inline const Plugins& known_plugins() {
  static const Plugins plugins = registered_plugins();
  return plugins;
}

/// What determines a run's trajectory.
inline JobIdentity identity_of(const RunConfig& run) {
  Digests digests;
  return identify(run.job, *make_source(run.job, known_plugins()), known_plugins(), digests);
}

inline std::string key_of(const RunConfig& run) { return identity_of(run).key; }

}  // namespace evbench::testing
