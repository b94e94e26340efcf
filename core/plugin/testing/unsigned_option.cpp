// Does not compile, with a sentence: an option of a type that none can have.
#include "core/plugin/options.hpp"

void declare(evbench::OptionSet& set, unsigned& count) { set.add("count", count, "how many"); }
