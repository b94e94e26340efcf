#pragma once

namespace evbench {

/// What the program returns; after a signal that asked it to end 128 + the signal, as a shell has it (130: Ctrl-C).
enum ExitCode : int {
  kExitDone = 0,
  kExitBadInput = 2,    ///< a command line, config or file that can't be used; also for one that CLI11 refuses
  kExitFailed = 3,      ///< a run or a check failed; the others were done
  kExitNotWritten = 4,  ///< what was to be written can't be (disk full, not writable), or the memory is not enough
};

}  // namespace evbench
