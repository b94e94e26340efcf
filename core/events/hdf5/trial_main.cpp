// evbench-hdf5-trial FILE events TOPIC COLUMNS, or FILE datasets NAME...: waits for a line, reads these parts of an
// HDF5 file as trial.hpp says, and answers with a line, whatever the file is like. No answer: the HDF5 library crashed
// or took too long.
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include "core/events/hdf5/file.hpp"
#include "core/events/hdf5/reader.hpp"

namespace {

void exercise(evbench::EventReader& reader) {
  constexpr std::int64_t kPlaces = 8;
  const std::int64_t start = reader.info().start.value_or(0), end = reader.info().end.value_or(0);
  std::vector<evbench::Event> events;
  for (std::int64_t i = 0; i <= kPlaces; ++i) {
    reader.seek(start + (end / kPlaces - start / kPlaces) * i);
    reader.read(events);
  }
  reader.ground_truth();
  reader.calibration();
}

}  // namespace

int main(int argc, char** argv) {
  constexpr rlim_t kMostSeconds = 10;
  const rlimit no_core{0, 0}, processor{kMostSeconds, kMostSeconds + 1};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::setrlimit(RLIMIT_CPU, &processor);
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() < 3 || std::getchar() == EOF) return 2;
  try {
    if (words[1] == "events" && words.size() == 4) {
      exercise(*evbench::open_hdf5(words[0], {.topic = words[2], .columns = words[3]}));
    } else {
      const evbench::hdf5::File file(words[0]);
      for (const std::string& name : std::span(words).subspan(2)) {
        file.dataset(name).read_all();
      }
    }
  } catch (const std::exception&) {  // the reader reports it
  }
  std::puts("");
  std::fflush(stdout);
  ::_exit(0);  // skips the library's own cleanup, which may crash, too
}
