// Does not compile, with a sentence: an option that is an enumeration, without names.
#include "core/plugin/options.hpp"

enum class Loss { none, huber };

void declare(evbench::OptionSet& set, Loss& loss) { set.add("loss", loss, "robust loss"); }
