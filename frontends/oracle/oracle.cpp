#include "frontends/oracle/oracle.hpp"

#include <fmt/format.h>

#include "core/plugin/registration.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

const Registration<FrontEnd, Oracle> registration("oracle", "the tracks that a simulated source knows");

}  // namespace

Oracle::Oracle(const Options&, const FrontEndContext& context) {
  const auto tracks = context.source.true_tracks();
  if (!tracks) {
    throw InputError(
        fmt::format("{}: oracle needs a source that knows its true tracks (simulation); expected another front-end "
                    "(recorded) for this one",
                    context.place));
  }
  player_ = TrackPlayer(*tracks);
}

}  // namespace evbench
