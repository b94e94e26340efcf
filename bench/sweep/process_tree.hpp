#pragma once

#include <sys/types.h>

#include <vector>

namespace evbench {

/// What a process has started, and what that has started, as far as it is alive; a parent stands before its children.
std::vector<pid_t> descendants(pid_t process);

/// Resident memory of a process and all of its descendants [MiB]; what they share counts for each.
double resident_mib(pid_t process);

/// Ends a process and all of its descendants by SIGKILL, in whatever groups and sessions they are. The process itself
/// is not waited for.
void kill_tree(pid_t process);

}  // namespace evbench
