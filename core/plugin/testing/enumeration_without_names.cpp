// Must not compile: an enumeration option without names.
#include "core/plugin/options.hpp"

enum class Loss { none, huber };

void declare(evbench::OptionSet& set, Loss& loss) { set.add("loss", loss, "robust loss"); }
