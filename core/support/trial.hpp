#pragma once

#include <functional>
#include <string>

namespace evbench {

/// Calls `work` in a copy of this process and says what kills that: "" when `work` returns or throws, "Segmentation
/// fault" for instance, or "CPU time limit exceeded" after `most_seconds` of processor time. For libraries that crash
/// on broken input. What the copy writes to the console is dropped; of the threads, only this one is copied, and where
/// `work` waits for another one nothing is known after ten times as long: "".
std::string trial(const std::function<void()>& work, unsigned most_seconds);

}  // namespace evbench
