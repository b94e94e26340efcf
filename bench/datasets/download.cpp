#include "bench/datasets/download.hpp"

#include <curl/curl.h>
#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>
#include <thread>

#include "core/io/atomic_file.hpp"
#include "core/io/sha256.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

namespace fs = std::filesystem;

constexpr long kConnectSeconds = 30, kSilentSeconds = 60;
constexpr long kPartialContent = 206, kRangeNotSatisfiable = 416;

std::uint64_t size_of(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  return error ? 0 : size;
}

/// What tells one version of a file on the server from another, for If-Range: its entity tag, or else when it was
/// changed. Empty where the server says neither, or nothing has been fetched.
std::string version_path(const std::string& part) { return part + ".version"; }
std::string version_of(const std::string& part) {
  std::string version;
  std::getline(std::ifstream(version_path(part)) >> std::ws, version);
  return version;
}

/// The value of a header line with this name (lower case).
std::optional<std::string> header_value(std::string_view line, std::string_view name) {
  const std::size_t colon = line.find(':');
  if (colon != name.size()) return std::nullopt;
  for (std::size_t i = 0; i < colon; ++i) {
    if (std::tolower(static_cast<unsigned char>(line[i])) != name[i]) return std::nullopt;
  }
  const std::size_t first = line.find_first_not_of(" \t", colon + 1), last = line.find_last_not_of(" \t\r\n");
  if (first == std::string_view::npos) return "";
  return std::string(line.substr(first, last + 1 - first));
}

/// One request, from where the part file ends.
class Transfer {
 public:
  Transfer(const std::string& url, const std::string& part, const DownloadOptions& options)
      : url_(url), part_(part), options_(options), have_(size_of(part)), curl_(curl_easy_init(), curl_easy_cleanup) {}

  struct Result {
    CURLcode code = CURLE_OK;
    long status = 0;      ///< HTTP
    std::string message;  ///< what went wrong
    std::string type;     ///< of the content, as the server says
    bool too_big = false;
    bool restart = false;  ///< the part file doesn't fit what the server has
  };
  Result perform();

 private:
  static std::size_t on_header(char* data, std::size_t size, std::size_t count, void* self) {
    static_cast<Transfer*>(self)->header(std::string_view(data, size * count));
    return size * count;
  }
  static std::size_t on_body(char* data, std::size_t size, std::size_t count, void* self) {
    auto* const transfer = static_cast<Transfer*>(self);
    try {
      return transfer->body(data, size * count) ? size * count : 0;
    } catch (...) {  // must not pass through libcurl, which is C
      transfer->failure_ = std::current_exception();
      return 0;
    }
  }
  /// Called about once a second, also while nothing comes. Ends the transfer unless 0.
  static int on_progress(void*, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
    return Interruption::is_requested() ? 1 : 0;
  }
  void set_up();
  void header(std::string_view line);
  bool body(const char* data, std::size_t size);
  bool begin();

  std::string url_, part_, etag_, last_modified_, content_range_;
  const DownloadOptions& options_;
  std::uint64_t have_;
  std::optional<std::uint64_t> total_;
  std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> curl_;
  std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)> headers_{nullptr, curl_slist_free_all};
  std::unique_ptr<std::FILE, decltype(&std::fclose)> file_{nullptr, std::fclose};
  char error_[CURL_ERROR_SIZE] = {};
  std::exception_ptr failure_;  ///< of a callback
  Result result_;
};

void Transfer::set_up() {
  CURL* const curl = curl_.get();
  curl_easy_setopt(curl, CURLOPT_URL, url_.c_str());
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_FOLLOWLOCATION, 1L);
  curl_easy_setopt(curl, CURLOPT_MAXREDIRS, 5L);
  curl_easy_setopt(curl, CURLOPT_FAILONERROR, 1L);
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT, kConnectSeconds);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_LIMIT, 1L);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_TIME, kSilentSeconds);
  curl_easy_setopt(curl, CURLOPT_USERAGENT, "evbench");
  curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, error_);
  curl_easy_setopt(curl, CURLOPT_HEADERFUNCTION, on_header);
  curl_easy_setopt(curl, CURLOPT_HEADERDATA, this);
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, on_body);
  curl_easy_setopt(curl, CURLOPT_WRITEDATA, this);
  curl_easy_setopt(curl, CURLOPT_XFERINFOFUNCTION, on_progress);
  curl_easy_setopt(curl, CURLOPT_NOPROGRESS, 0L);
  const std::string version = version_of(part_);
  if (version.empty()) have_ = 0;  // whether what the server has now is the same file can't be known
  if (have_ == 0) return;
  curl_easy_setopt(curl, CURLOPT_RANGE, fmt::format("{}-", have_).c_str());
  headers_.reset(curl_slist_append(nullptr, ("If-Range: " + version).c_str()));
  curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers_.get());
}

Transfer::Result Transfer::perform() {
  set_up();
  result_.code = curl_easy_perform(curl_.get());
  if (failure_) std::rethrow_exception(failure_);
  curl_easy_getinfo(curl_.get(), CURLINFO_RESPONSE_CODE, &result_.status);
  const char* type = nullptr;
  curl_easy_getinfo(curl_.get(), CURLINFO_CONTENT_TYPE, &type);
  result_.type = type != nullptr ? type : "";
  if (result_.code == CURLE_OK && !file_) begin();  // a file without bytes
  if (file_ && std::fclose(file_.release()) != 0)
    throw InputError(fmt::format("{}: can't be written (disk full?)", part_));
  if (result_.status == kRangeNotSatisfiable) {  // nothing is missing, or the file is another one
    if (content_range_ == fmt::format("bytes */{}", have_))
      result_.code = CURLE_OK;
    else
      result_.restart = true;
  }
  result_.message = error_[0] != '\0' ? error_ : curl_easy_strerror(result_.code);
  return result_;
}

void Transfer::header(std::string_view line) {
  if (line.starts_with("HTTP/")) etag_ = last_modified_ = content_range_ = "";  // a redirection's don't count
  if (const auto tag = header_value(line, "etag")) etag_ = *tag;
  if (const auto date = header_value(line, "last-modified")) last_modified_ = *date;
  if (const auto range = header_value(line, "content-range")) content_range_ = *range;
}

/// The answer's first byte: is it the file's first, or the one that is next?
bool Transfer::begin() {
  curl_easy_getinfo(curl_.get(), CURLINFO_RESPONSE_CODE, &result_.status);
  if (result_.status == kPartialContent) {
    if (!content_range_.starts_with(fmt::format("bytes {}-", have_))) {
      result_.restart = true;
      return false;
    }
  } else {
    have_ = 0;
  }
  curl_off_t left = -1;
  curl_easy_getinfo(curl_.get(), CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &left);
  if (left >= 0) total_ = have_ + static_cast<std::uint64_t>(left);
  file_.reset(std::fopen(part_.c_str(), have_ == 0 ? "wb" : "ab"));
  if (!file_) throw InputError(fmt::format("{}: can't be written: {}", part_, std::strerror(errno)));
  // After the old bytes are gone. A weak tag can't be used with If-Range (RFC 9110, 13.1.5).
  const bool strong = !etag_.empty() && !etag_.starts_with("W/");
  if (have_ == 0) write_file(version_path(part_), strong ? etag_ : last_modified_);
  return true;
}

bool Transfer::body(const char* data, std::size_t size) {
  if (!file_ && !begin()) return false;
  result_.too_big = total_.value_or(0) > options_.limit || have_ + size > options_.limit;
  if (result_.too_big || std::fwrite(data, 1, size, file_.get()) != size) return false;
  have_ += size;
  if (options_.progress) options_.progress(have_, total_);
  return true;
}

bool may_be_tried_again(const Transfer::Result& result) {
  switch (result.code) {
    case CURLE_COULDNT_CONNECT:
    case CURLE_PARTIAL_FILE:
    case CURLE_OPERATION_TIMEDOUT:
    case CURLE_GOT_NOTHING:
    case CURLE_SEND_ERROR:
    case CURLE_RECV_ERROR:
    case CURLE_HTTP2_STREAM: return true;
    case CURLE_HTTP_RETURNED_ERROR: return result.status >= 500;
    default: return false;
  }
}

void remove_part(const std::string& part) {
  std::error_code ignored;
  fs::remove(part, ignored);
  fs::remove(version_path(part), ignored);
}

/// A page that says "not found", "log in" or "accept our terms" in the place of the file.
bool is_web_page(const std::string& path, const std::string& type) {
  std::string head(256, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  head.erase(0, head.find_first_not_of(" \t\r\n"));
  for (char& c : head) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return head.starts_with("<!doctype html") || head.starts_with("<html") ||
         (head.starts_with("<") && type.starts_with("text/html"));
}

void check_content(const std::string& url, const std::string& part, const std::string& type,
                   const std::string& expected_sha256) {
  if (is_web_page(part, type)) {
    remove_part(part);
    throw InputError(fmt::format("{}: the server answers with a web page, not the file; has it moved?", url));
  }
  if (expected_sha256.empty()) return;
  const std::string found = sha256_file(part);
  if (found == expected_sha256) return;
  remove_part(part);
  throw InputError(fmt::format("{}: has the SHA-256 {}; expected {}: removed", url, found, expected_sha256));
}

/// Throws unless the download may go on.
void explain(const Transfer::Result& result, const std::string& url, const std::string& part, bool last) {
  check_interruption();
  if (result.too_big) {
    remove_part(part);
    throw InputError(fmt::format("{}: is bigger than the catalogue allows; removed", url));
  }
  if (result.code == CURLE_WRITE_ERROR && !result.restart) {
    throw InputError(fmt::format("{}: can't be written (disk full?)", part));
  }
  if (result.code == CURLE_HTTP_RETURNED_ERROR && !result.restart && result.status < 500) {
    throw InputError(fmt::format("{}: the server answers {}; has the file moved?", url, result.status));
  }
  if (!last && (result.restart || may_be_tried_again(result))) return;
  throw InputError(fmt::format(
      "{}: the download broke off after {} bytes ({}); the same command {}", url, size_of(part), result.message,
      version_of(part).empty() ? "begins anew, as the server doesn't say which version it has" : "goes on from there"));
}

}  // namespace

void download(const std::string& url, const std::string& path, const DownloadOptions& options) {
  static const CURLcode initialised = curl_global_init(CURL_GLOBAL_DEFAULT);
  if (initialised != CURLE_OK) throw InputError("libcurl can't be initialised");
  const std::string part = path + ".part";
  for (int attempt = 1;; ++attempt) {
    const Transfer::Result result = Transfer(url, part, options).perform();
    if (result.code == CURLE_OK && !result.restart) {
      check_content(url, part, result.type, options.sha256);
      break;
    }
    explain(result, url, part, attempt >= options.attempts);
    if (result.restart) {
      remove_part(part);
    } else {
      std::this_thread::sleep_for(options.pause);
    }
  }
  std::error_code error;
  fs::rename(part, path, error);
  if (error) throw InputError(fmt::format("{}: can't be written: {}", path, error.message()));
  remove_part(part);
}

}  // namespace evbench
