// Must not compile: an option of an unsupported type.
#include "core/plugin/options.hpp"

void declare(evbench::OptionSet& set, unsigned& count) { set.add("count", count, "how many"); }
