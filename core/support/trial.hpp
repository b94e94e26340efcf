#pragma once

#include <functional>
#include <string>

namespace evbench {

/// Calls `work` in a copy of this process and says what kills that: "" when `work` returns or throws, "Segmentation
/// fault" for instance, "CPU time limit exceeded" after `most_seconds` of processor time, or "Time limit exceeded"
/// after ten times as long by the clock. For libraries that crash on broken input. What the copy writes to the console
/// is dropped; of the threads, only this one is copied, so `work` must not wait for another one. A request to end
/// (core/support/interruption.hpp) ends the copy, too, and throws here.
std::string trial(const std::function<void()>& work, unsigned most_seconds);

}  // namespace evbench
