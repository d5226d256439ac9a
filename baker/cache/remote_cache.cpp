// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cache/remote_cache.hpp"

#include <curl/curl.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstring>
#include <new>

namespace spm::baker {
namespace {

constexpr long good = 200, missing = 404, gone = 410, success_end = 300;
constexpr long slowest = 50'000;  ///< bytes a second; slower for the whole time-out is too slow
constexpr std::size_t most_bytes = std::size_t{2} << 30U;  ///< no entry is as large
constexpr long most_redirections = 3;

using Handle = std::unique_ptr<CURL, decltype(&curl_easy_cleanup)>;
using UrlParts = std::unique_ptr<CURLU, decltype(&curl_url_cleanup)>;

/// What a request came to; the status is 0 where there was no answer.
struct Answer {
  long status = 0;
  std::string body;
  std::string problem;
};

std::size_t take(const char* bytes, std::size_t size, std::size_t count, void* target) {
  auto& body = *static_cast<std::string*>(target);
  const std::size_t length = size * count;
  if (body.size() + length > most_bytes) return 0;  // curl then ends the transfer
  body.append(bytes, length);
  return length;
}

std::size_t give(char* target, std::size_t size, std::size_t count, void* source) {
  auto& rest = *static_cast<std::string_view*>(source);
  const std::size_t length = std::min(size * count, rest.size());
  std::memcpy(target, rest.data(), length);
  rest.remove_prefix(length);
  return length;
}

bool has_part(CURLU* url, CURLUPart part) {
  char* text = nullptr;
  const bool found = curl_url_get(url, part, &text, 0) == CURLUE_OK && *text != '\0';
  curl_free(text);
  return found;
}

Result<void> check_url(const std::string& url) {
  const UrlParts parts(curl_url(), &curl_url_cleanup);
  const bool http = url.starts_with("http://") || url.starts_with("https://");
  if (!parts || !http || curl_url_set(parts.get(), CURLUPART_URL, url.c_str(), 0) != CURLUE_OK ||
      has_part(parts.get(), CURLUPART_QUERY) || has_part(parts.get(), CURLUPART_FRAGMENT)) {
    return fail(ExitCode::usage,
                "--remote-cache: '" + url +
                    "' is no address of a folder; give one such as http://host:8080/spm");
  }
  if (has_part(parts.get(), CURLUPART_USER) || has_part(parts.get(), CURLUPART_PASSWORD)) {
    return fail(ExitCode::usage,
                std::string("--remote-cache: the address holds a name or a password, which others "
                            "could read; give a token in ") +
                    remote_token_variable);
  }
  return {};
}

/// A handle for one request; null where there is no memory.
Handle handle_for(const std::string& url, const RemoteOptions& options) {
  Handle handle(curl_easy_init(), &curl_easy_cleanup);
  CURL* const curl = handle.get();
  if (curl == nullptr) return handle;
  curl_easy_setopt(curl, CURLOPT_URL, url.c_str());
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_REDIR_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_FOLLOWLOCATION, 1L);
  curl_easy_setopt(curl, CURLOPT_MAXREDIRS, most_redirections);
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT, options.timeout_seconds);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_LIMIT, slowest);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_TIME, options.timeout_seconds);
  curl_easy_setopt(curl, CURLOPT_USERAGENT, "spm-bake/" SPM_VERSION);
  if (!options.token.empty()) {
    // Unlike a header of our own, it is never sent on to another host.
    curl_easy_setopt(curl, CURLOPT_HTTPAUTH, CURLAUTH_BEARER);
    curl_easy_setopt(curl, CURLOPT_XOAUTH2_BEARER, options.token.c_str());
  }
  return handle;
}

Answer perform(CURL* curl) {
  Answer answer;
  if (curl == nullptr) {
    answer.problem = "there is no memory for a connection";
    return answer;
  }
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, &take);
  curl_easy_setopt(curl, CURLOPT_WRITEDATA, &answer.body);
  const CURLcode code = curl_easy_perform(curl);
  if (code != CURLE_OK) {
    answer.problem = curl_easy_strerror(code);
    return answer;
  }
  curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &answer.status);
  return answer;
}

tl::unexpected<Error> unusable(const std::string& url, const Answer& answer, const char* what) {
  std::string cause = answer.problem;
  if (answer.status == 401 || answer.status == 403) {
    cause = "it wants another token (HTTP status " + std::to_string(answer.status) + "); set " +
            remote_token_variable;
  } else if (answer.status != 0) {
    cause = "it answers with HTTP status " + std::to_string(answer.status);
  }
  return fail(ExitCode::file_or_device,
              url + ": the remote cache cannot be " + what + ", and is left alone: " + cause);
}

}  // namespace

Result<RemoteCache> RemoteCache::open(RemoteOptions options) {
  static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
  if (ready != CURLE_OK) return fail(ExitCode::internal, "libcurl cannot be used here");
  if (const Result<void> checked = check_url(options.url); !checked) {
    return tl::make_unexpected(checked.error());
  }
  const bool printable = std::all_of(options.token.begin(), options.token.end(),
                                     [](char letter) { return letter > ' ' && letter <= '~'; });
  if (!printable) {
    return fail(ExitCode::usage, std::string(remote_token_variable) +
                                     ": holds blanks or control characters; give the token alone");
  }
  while (options.url.ends_with('/')) options.url.pop_back();
  void* const page =
      ::mmap(nullptr, sizeof(LeftAlone), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (page == MAP_FAILED) return fail(ExitCode::internal, "there is no shared memory");
  const auto release = [](LeftAlone* flags) { ::munmap(flags, sizeof(LeftAlone)); };
  return RemoteCache(std::move(options), std::shared_ptr<LeftAlone>(new (page) LeftAlone, release));
}

std::string RemoteCache::url_of(const std::string& digest) const {
  return options_.url + "/" + digest;
}

Result<std::optional<std::string>> RemoteCache::get(const std::string& digest) const {
  if (left_alone_->reading) return std::optional<std::string>();
  const std::string url = url_of(digest);
  Answer answer = perform(handle_for(url, options_).get());
  if (answer.status == good) return std::optional<std::string>(std::move(answer.body));
  if (answer.status == missing || answer.status == gone) return std::optional<std::string>();
  if (left_alone_->reading.exchange(true)) return std::optional<std::string>();
  left_alone_->writing = true;
  return unusable(url, answer, "read");
}

Result<bool> RemoteCache::has(const std::string& digest) const {
  if (left_alone_->reading) return false;
  const std::string url = url_of(digest);
  const Handle handle = handle_for(url, options_);
  if (handle) curl_easy_setopt(handle.get(), CURLOPT_NOBODY, 1L);
  const Answer answer = perform(handle.get());
  if (answer.status == good) return true;
  if (answer.status == missing || answer.status == gone) return false;
  if (left_alone_->reading.exchange(true)) return false;
  left_alone_->writing = true;
  return unusable(url, answer, "read");
}

Result<void> RemoteCache::put(const std::string& digest, std::string_view bytes) const {
  if (left_alone_->writing) return {};
  const std::string url = url_of(digest);
  const Handle handle = handle_for(url, options_);
  if (handle) {
    curl_easy_setopt(handle.get(), CURLOPT_UPLOAD, 1L);
    curl_easy_setopt(handle.get(), CURLOPT_INFILESIZE_LARGE, static_cast<curl_off_t>(bytes.size()));
    curl_easy_setopt(handle.get(), CURLOPT_READFUNCTION, &give);
    curl_easy_setopt(handle.get(), CURLOPT_READDATA, &bytes);
  }
  const Answer answer = perform(handle.get());
  if (answer.status >= good && answer.status < success_end) return {};
  if (left_alone_->writing.exchange(true)) return {};
  return unusable(url, answer, "written");
}

}  // namespace spm::baker
