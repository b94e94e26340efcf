#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/support/json.hpp"
#include "eval/run_record.hpp"

namespace evbench::report {

/// All that the page shows of these runs (bench/report/page/src/data.ts, Payload), scored by `protocol`: a name, or
/// empty for their own. `command`: the one that asks for it.
Json payload(std::span<RunRecord> runs, const std::string& protocol, const std::string& command);

/// A page that needs no other file: the template with these data.
std::string page(const Json& payload);

/// bench/report/page/report.html, with @DATA@ where the data belong.
std::string_view page_template();

}  // namespace evbench::report
