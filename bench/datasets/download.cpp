#include "bench/datasets/download.hpp"

#include <curl/curl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

#include "core/io/atomic_file.hpp"
#include "core/io/file_handle.hpp"
#include "core/io/sha256.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

namespace fs = std::filesystem;

/// The version of a file on the server, for If-Range: its entity tag, or else the time of its last change. Empty where
/// the server gives neither, or nothing has been fetched.
std::string version_path(const std::string& part) { return part + ".version"; }
std::string version_of(const std::string& part) {
  std::string version;
  std::getline(std::ifstream(version_path(part)) >> std::ws, version);
  return version;
}

void remove_part(const std::string& part) {
  std::error_code ignored;
  fs::remove(part, ignored);
  fs::remove(version_path(part), ignored);
}

void initialise_curl() {
  static const CURLcode initialised = curl_global_init(CURL_GLOBAL_DEFAULT);
  if (initialised != CURLE_OK) throw InputError("libcurl can't be initialised");
}

/// The options of every request.
void set_manners(CURL* curl, const std::string& url) {
  constexpr long kConnectSeconds = 30, kSilentSeconds = 60;
  curl_easy_setopt(curl, CURLOPT_URL, url.c_str());
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_FOLLOWLOCATION, 1L);
  curl_easy_setopt(curl, CURLOPT_MAXREDIRS, 5L);
  curl_easy_setopt(curl, CURLOPT_FAILONERROR, 1L);
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT, kConnectSeconds);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_LIMIT, 1L);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_TIME, kSilentSeconds);
  curl_easy_setopt(curl, CURLOPT_USERAGENT, "evbench");
  // Called about once a second, also while no data come. A result other than 0 ends the transfer.
  curl_easy_setopt(
      curl, CURLOPT_XFERINFOFUNCTION, +[](void*, curl_off_t, curl_off_t, curl_off_t, curl_off_t) -> int {
        return Interruption::is_requested() ? 1 : 0;
      });
  curl_easy_setopt(curl, CURLOPT_NOPROGRESS, 0L);
}

/// One request, from where the part file ends.
class Transfer {
 public:
  Transfer(const std::string& url, const std::string& part, const DownloadOptions& options);

  enum class End { complete, broken_off, other_file };  ///< other_file: the part file is of another file
  /// Throws InputError for errors that another attempt would not change.
  End perform();
  std::string header(const char* name) const;  ///< of the last answer; empty: it has none
  /// The error.
  const char* message() const { return error_[0] != '\0' ? error_ : curl_easy_strerror(code_); }
  std::uint64_t bytes() const { return have_; }

 private:
  static std::size_t on_body(char* data, std::size_t size, std::size_t count, void* self);
  bool begin();
  bool body(const char* data, std::size_t size);
  long status() const;

  const std::string& url_;
  const std::string& part_;
  const DownloadOptions& options_;
  std::uint64_t have_ = 0;  ///< [bytes]
  std::optional<std::uint64_t> total_;
  std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> curl_{curl_easy_init(), curl_easy_cleanup};
  std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)> headers_{nullptr, curl_slist_free_all};
  FileHandle file_;
  CURLcode code_ = CURLE_OK;
  char error_[CURL_ERROR_SIZE] = {};
  std::exception_ptr failure_;  ///< of a callback
  bool fits_ = true;            ///< whether the answer continues the part file
};

Transfer::Transfer(const std::string& url, const std::string& part, const DownloadOptions& options)
    : url_(url), part_(part), options_(options) {
  CURL* const curl = curl_.get();
  set_manners(curl, url_);
  curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, error_);
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, on_body);
  curl_easy_setopt(curl, CURLOPT_WRITEDATA, this);
  const std::string version = version_of(part_);
  std::error_code none;
  const std::uintmax_t size = fs::file_size(part_, none);
  if (none || size == 0 || version.empty()) return;  // it might be another file
  have_ = size;
  // Not RESUME_FROM: libcurl would refuse an answer with the whole file instead of the rest.
  curl_easy_setopt(curl, CURLOPT_RANGE, fmt::format("{}-", have_).c_str());
  headers_.reset(curl_slist_append(nullptr, ("If-Range: " + version).c_str()));
  curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers_.get());
}

long Transfer::status() const {
  long status = 0;
  curl_easy_getinfo(curl_.get(), CURLINFO_RESPONSE_CODE, &status);
  return status;
}

std::string Transfer::header(const char* name) const {
  curl_header* found = nullptr;
  return curl_easy_header(curl_.get(), name, 0, CURLH_HEADER, -1, &found) == CURLHE_OK ? found->value : "";
}

Transfer::End Transfer::perform() {
  constexpr long kRangeNotSatisfiable = 416, kServerError = 500;
  code_ = curl_easy_perform(curl_.get());
  if (failure_) std::rethrow_exception(failure_);
  check_interruption();
  if (code_ == CURLE_OK && !file_) begin();  // a file without bytes
  if (file_ && std::fclose(file_.release()) != 0) {
    throw OutputError(fmt::format("{}: can't be written (disk full?)", part_));
  }
  // The file is complete, or another one.
  if (status() == kRangeNotSatisfiable) fits_ = header("Content-Range") == fmt::format("bytes */{}", have_);
  if (!fits_) return End::other_file;
  if (code_ == CURLE_OK || status() == kRangeNotSatisfiable) return End::complete;
  if (code_ == CURLE_HTTP_RETURNED_ERROR && status() < kServerError) {
    throw InputError(fmt::format("{}: the server answers {}; has the file moved?", url_, status()));
  }
  if (code_ == CURLE_COULDNT_RESOLVE_HOST || code_ == CURLE_COULDNT_RESOLVE_PROXY) {
    throw InputError(fmt::format("{}: {}; is there a network?", url_, message()));
  }
  return End::broken_off;
}

/// Checks that the answer begins with the file's first byte, or with the one that follows the part file.
bool Transfer::begin() {
  constexpr long kPartialContent = 206;
  if (status() != kPartialContent) have_ = 0;
  fits_ = have_ == 0 || header("Content-Range").starts_with(fmt::format("bytes {}-", have_));
  if (!fits_) return false;
  curl_off_t left = -1;
  curl_easy_getinfo(curl_.get(), CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &left);
  if (left >= 0) total_ = have_ + static_cast<std::uint64_t>(left);
  file_.reset(std::fopen(part_.c_str(), have_ == 0 ? "wb" : "ab"));
  if (!file_) throw OutputError(fmt::format("{}: can't be written: {}", part_, std::strerror(errno)));
  // After the old bytes are gone. A weak tag can't be used with If-Range (RFC 9110, 13.1.5).
  const std::string tag = header("ETag");
  if (have_ == 0) write_file(version_path(part_), tag.empty() || tag.starts_with("W/") ? header("Last-Modified") : tag);
  return true;
}

bool Transfer::body(const char* data, std::size_t size) {
  if (!file_ && !begin()) return false;
  if (total_.value_or(0) > options_.limit || have_ + size > options_.limit) {
    remove_part(part_);
    throw InputError(fmt::format("{}: is bigger than the catalogue allows; removed", url_));
  }
  if (std::fwrite(data, 1, size, file_.get()) != size) {
    throw OutputError(fmt::format("{}: can't be written (disk full?)", part_));
  }
  have_ += size;
  if (options_.progress) options_.progress(have_, total_);
  return true;
}

std::size_t Transfer::on_body(char* data, std::size_t size, std::size_t count, void* self) {
  auto* const transfer = static_cast<Transfer*>(self);
  try {
    return transfer->body(data, size * count) ? size * count : 0;
  } catch (...) {  // exceptions must not pass through libcurl, which is C
    transfer->failure_ = std::current_exception();
    return 0;
  }
}

/// Whether the answer is a web page ("not found", "log in", "accept our terms") instead of the file. `type`: the
/// server's content type.
bool is_web_page(const std::string& path, const std::string& type) {
  std::string head(256, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  head.erase(0, head.find_first_not_of(" \t\r\n"));
  std::ranges::transform(head, head.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return head.starts_with("<!doctype html") || head.starts_with("<html") ||
         (head.starts_with("<") && type.starts_with("text/html"));
}

void check_content(const std::string& url, const std::string& part, const std::string& type,
                   const std::string& expected_sha256) {
  const bool is_page = is_web_page(part, type);
  const std::string found = is_page || expected_sha256.empty() ? expected_sha256 : sha256_file(part);
  if (!is_page && found == expected_sha256) return;
  remove_part(part);
  if (is_page) {
    throw InputError(fmt::format("{}: the server answers with a web page, not the file; has it moved?", url));
  }
  throw InputError(fmt::format("{}: has the SHA-256 {}; expected {}: removed", url, found, expected_sha256));
}

}  // namespace

void download(const std::string& url, const std::string& path, const DownloadOptions& options) {
  initialise_curl();
  const std::string part = path + ".part";
  for (int attempt = 1;; ++attempt) {
    Transfer transfer(url, part, options);
    const Transfer::End end = transfer.perform();
    if (end == Transfer::End::complete) {
      check_content(url, part, transfer.header("Content-Type"), options.sha256);
      break;
    }
    if (end == Transfer::End::other_file) remove_part(part);
    if (attempt >= options.attempts) {
      throw InputError(fmt::format("{}: the download broke off after {} bytes ({}); the same command {}", url,
                                   transfer.bytes(), transfer.message(),
                                   version_of(part).empty()
                                       ? "begins anew, as the server doesn't say which version it has"
                                       : "goes on from there"));
    }
    if (end == Transfer::End::broken_off) std::this_thread::sleep_for(options.pause);
  }
  std::error_code error;
  fs::rename(part, path, error);
  if (error) throw OutputError(fmt::format("{}: can't be written: {}", path, error.message()));
  remove_part(part);
}

std::optional<std::uint64_t> remote_size(const std::string& url) {
  initialise_curl();
  const std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> curl(curl_easy_init(), curl_easy_cleanup);
  set_manners(curl.get(), url);
  curl_easy_setopt(curl.get(), CURLOPT_NOBODY, 1L);
  const CURLcode code = curl_easy_perform(curl.get());
  check_interruption();
  if (code == CURLE_HTTP_RETURNED_ERROR) return std::nullopt;
  if (code != CURLE_OK) throw InputError(fmt::format("{}: {}", url, curl_easy_strerror(code)));
  curl_off_t size = -1;
  curl_easy_getinfo(curl.get(), CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &size);
  return size < 0 ? std::nullopt : std::optional(static_cast<std::uint64_t>(size));
}

}  // namespace evbench
