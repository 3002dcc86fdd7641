// SPDX-License-Identifier: Apache-2.0
#include "viewer/page_assets.h"

#include <zlib.h>

#include <algorithm>

#include "ltm/core/buffer.h"

namespace engram::viewer {

namespace {

/// Whether a header lists a word: "gzip, deflate, br", without "gzip;q=0".
bool takes_gzip(std::string_view accepted) {
  const size_t at = accepted.find("gzip");
  return at != std::string_view::npos && !accepted.substr(at + 4).starts_with(";q=0");
}

}  // namespace

std::string unzipped(std::span<const std::byte> gzipped) {
  z_stream stream{};
  constexpr int kGzip = 16 + MAX_WBITS;
  ENGRAM_CHECK(inflateInit2(&stream, kGzip) == Z_OK, "zlib does not begin");
  // zlib takes what it only reads by a pointer to change.
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(gzipped.data()));
  stream.avail_in = static_cast<uInt>(gzipped.size());
  std::string text;
  int state = Z_OK;
  while (state == Z_OK) {
    constexpr size_t kStep = 64 << 10;
    const size_t before = text.size();
    text.resize(before + kStep);
    stream.next_out = reinterpret_cast<Bytef*>(text.data() + before);
    stream.avail_out = kStep;
    state = inflate(&stream, Z_NO_FLUSH);
    text.resize(before + kStep - stream.avail_out);
  }
  inflateEnd(&stream);
  ENGRAM_CHECK(state == Z_STREAM_END, "an embedded file of the page does not unzip: {}", state);
  return text;
}

std::optional<HttpResponse> page_response(const HttpRequest& request, std::string_view path) {
  const auto assets = page_assets();
  const auto asset = std::ranges::find(assets, path, &PageAsset::path);
  if (asset == assets.end()) return std::nullopt;
  HttpResponse response{.type = std::string(asset->type)};
  response.headers = {
      {"ETag", std::string(asset->etag)},
      {"Cache-Control", asset->is_immutable ? "private, max-age=31536000, immutable" : "no-store"},
      {"Vary", "Accept-Encoding"}};
  if (asset->is_immutable && request.if_none_match == asset->etag) {
    response.status = 304;
  } else if (takes_gzip(request.accept_encoding)) {
    response.headers.emplace_back("Content-Encoding", "gzip");
    response.body = as_text(asset->gzipped);
  } else {
    response.body = unzipped(asset->gzipped);
  }
  return response;
}

}  // namespace engram::viewer
