#pragma once

#include <string>

namespace evbench {

/// Opens a file for reading; "-" is the standard input. Returns -1 with errno on failure. Waits until a pipe has data;
/// after a second a message on the standard error says so. A signal ends the waiting (EINTR).
int open_to_read(const std::string& path);

}  // namespace evbench
