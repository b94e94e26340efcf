#pragma once

#include <string>

namespace evbench {

/// Opens a file to be read, "-" being the standard input; -1 with errno where that fails. A pipe is waited for until
/// there is something in it, with a word on the standard error after a second: nobody should sit before a silent
/// terminal. A signal ends the waiting (EINTR).
int open_to_read(const std::string& path);

}  // namespace evbench
