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
  int attempts = 5;                              ///< to resume after the connection broke
  std::chrono::milliseconds pause{2000};         ///< between them
  /// Gets the number of bytes that are there, and the total where the server gives it.
  std::function<void(std::uint64_t, std::optional<std::uint64_t>)> progress;
};

/// Fetches a file by HTTP(S). Its name is `path`.part until it is complete and its checksum is right. A download that
/// broke off is resumed, also in a later call, by Range and If-Range with the server's entity tag or else its time of
/// the last change, kept in `path`.part.version. A file that has changed meanwhile, or without tag and time, is fetched
/// from its beginning. Servers without Range are supported.
///
/// Throws InputError, naming the address. After a refusal by the server (404, ...), a connection that broke too often
/// or an Interruption, the part file stays. A file that is too big, has another checksum, or is a web page instead of
/// the file, is removed.
void download(const std::string& url, const std::string& path, const DownloadOptions& options = {});

/// The size of a file in bytes, from the server without sending the file; none where the server does not give it.
/// Throws InputError where the request fails.
std::optional<std::uint64_t> remote_size(const std::string& url);

}  // namespace evbench
