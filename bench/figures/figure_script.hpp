#pragma once

#include <string_view>

namespace evbench {

/// bench/figures/figure.py, as it was when the program was built; bench/figures/embed.cmake makes it part of the
/// program. "@DATA@" in it is replaced by the figure's data.
std::string_view figure_script();

}  // namespace evbench
