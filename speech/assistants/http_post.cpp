// SPDX-License-Identifier: Apache-2.0
#include "speech/assistants/http_post.h"

#include <curl/curl.h>

#include <memory>
#include <mutex>

namespace engram::speech {

namespace {

struct Receiving {
  std::string body;
  size_t max_bytes = 0;
  bool is_too_long = false;
  const std::stop_token& stop;
};

size_t receive(char* data, size_t size, size_t count, void* to) {
  auto& receiving = *static_cast<Receiving*>(to);
  const size_t bytes = size * count;
  if (receiving.body.size() + bytes > receiving.max_bytes) {
    receiving.is_too_long = true;
    return 0;
  }
  receiving.body.append(data, bytes);
  return bytes;
}

int look_at_stop(void* to, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return static_cast<Receiving*>(to)->stop.stop_requested() ? 1 : 0;
}

struct Headers {
  curl_slist* list = nullptr;

  Headers() = default;
  Headers(const Headers&) = delete;
  Headers& operator=(const Headers&) = delete;
  ~Headers() { curl_slist_free_all(list); }

  void add(const std::string& line) { list = curl_slist_append(list, line.c_str()); }
};

}  // namespace

Result<HttpReply> post(const HttpPost& request, const std::stop_token& stop) {
  if (!request.url.starts_with("http://") && !request.url.starts_with("https://"))
    return invalid_argument("'{}': needs a URL of http or https", request.url);
  static std::once_flag once;
  std::call_once(once, [] { curl_global_init(CURL_GLOBAL_DEFAULT); });
  const std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> curl(curl_easy_init(),
                                                                 &curl_easy_cleanup);
  if (curl == nullptr) return unavailable("'{}': libcurl cannot begin", request.url);
  Receiving receiving{{}, request.max_reply_bytes, false, stop};
  Headers headers;
  headers.add("Content-Type: application/json");
  if (!request.bearer_token.empty()) headers.add("Authorization: Bearer " + request.bearer_token);
  const auto set = [&curl](CURLoption option, auto value) {
    curl_easy_setopt(curl.get(), option, value);
  };
  set(CURLOPT_URL, request.url.c_str());
  set(CURLOPT_PROTOCOLS_STR, "http,https");
  set(CURLOPT_NOPROXY, "localhost,127.0.0.1,::1");
  set(CURLOPT_NOSIGNAL, 1L);
  set(CURLOPT_HTTPHEADER, headers.list);
  set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(request.json.size()));
  set(CURLOPT_POSTFIELDS, request.json.c_str());
  set(CURLOPT_TIMEOUT_MS, static_cast<long>(request.timeout / std::chrono::milliseconds(1)));
  set(CURLOPT_CONNECTTIMEOUT, 10L);
  set(CURLOPT_WRITEFUNCTION, &receive);
  set(CURLOPT_WRITEDATA, static_cast<void*>(&receiving));
  set(CURLOPT_NOPROGRESS, 0L);
  set(CURLOPT_XFERINFOFUNCTION, &look_at_stop);
  set(CURLOPT_XFERINFODATA, static_cast<void*>(&receiving));
  const CURLcode code = curl_easy_perform(curl.get());
  if (receiving.is_too_long)
    return resource_exhausted("'{}': the reply has more than {} bytes", request.url,
                              request.max_reply_bytes);
  if (code == CURLE_ABORTED_BY_CALLBACK) return cancelled("'{}': told to stop", request.url);
  if (code != CURLE_OK) return unavailable("'{}': {}", request.url, curl_easy_strerror(code));
  long status = 0;
  curl_easy_getinfo(curl.get(), CURLINFO_RESPONSE_CODE, &status);
  return HttpReply{static_cast<int>(status), std::move(receiving.body)};
}

}  // namespace engram::speech
