#include "core/events/faults.hpp"

#include <fmt/format.h>

#include "core/support/error.hpp"

namespace evbench {

void Faults::add(const std::string& kind, const std::string& where, std::int64_t count) {
  if (strict_) throw InputError(fmt::format("{}: {}: {}", file_, where, kind));
  Fault& fault = faults_[kind];
  if (fault.count == 0) fault.first = where;
  fault.count += count;
}

}  // namespace evbench
