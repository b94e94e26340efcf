#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace evbench {

struct DownloadOptions {
  std::string sha256;                            ///< expected; empty: unknown
  std::uint64_t limit = std::uint64_t{1} << 40;  ///< [bytes] that the file may have at most
  int attempts = 5;                              ///< of getting on after the connection broke
  std::chrono::milliseconds pause{2000};         ///< between them
  /// Bytes that are there, and of how many where the server says so.
  std::function<void(std::uint64_t, std::optional<std::uint64_t>)> progress;
};

/// Fetches a file by HTTP(S). It is `path`.part until it is complete and its checksum is right; a download that broke
/// off goes on where it stopped, also in a later call: by Range, and If-Range with the server's entity tag or else its
/// time of the last change, kept in `path`.part.version. A file that has changed meanwhile, or of which the server says
/// neither, is fetched from its beginning. Servers without Range are fine.
///
/// Throws InputError, naming the address, for what the server refuses (404, ...), a connection that broke too often and
/// an Interruption (what is there stays), a file that is too big, one with another checksum, and a web page in the
/// place of the file (these are removed).
void download(const std::string& url, const std::string& path, const DownloadOptions& options = {});

/// How many bytes a file has, as the server says without sending it; nothing where it doesn't say. Throws InputError
/// where it can't be asked.
std::optional<std::uint64_t> remote_size(const std::string& url);

}  // namespace evbench
