#pragma once

#include <sys/types.h>

#include <vector>

namespace evbench {

/// The living descendants of a process; a parent comes before its children.
std::vector<pid_t> descendants(pid_t process);

/// Resident memory of a process and all of its descendants [MiB]; shared memory counts for each.
double resident_mib(pid_t process);

/// Ends a process and all of its descendants by SIGKILL, whatever their process groups and sessions. Does not wait for
/// the process itself.
void kill_tree(pid_t process);

}  // namespace evbench
