#pragma once

namespace evbench {

/// Exit codes of the program. After a signal it is 128 + the signal, as in a shell (130: Ctrl-C).
enum ExitCode : int {
  kExitDone = 0,
  kExitBadInput = 2,    ///< a command line, config or file that can't be used
  kExitFailed = 3,      ///< a run or a check failed; the others were done
  kExitNotWritten = 4,  ///< an output can't be written (disk full, not writable), or there is not enough memory
};

}  // namespace evbench
