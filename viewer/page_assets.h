// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "viewer/http_message.h"

namespace engram::viewer {

/// A file of the page, as the build embedded it (viewer/embed_page.py).
struct PageAsset {
  std::string_view path;  ///< "/", "/assets/index-1f2e.js"
  std::string_view type;
  std::string_view etag;  ///< In quotes.
  std::span<const std::byte> gzipped;
  bool is_immutable = false;  ///< Its name tells its content.
};

/// All files of the page. Nothing else is ever served, so no path leads out of it.
[[nodiscard]] std::span<const PageAsset> page_assets();

/// The file at a path; nothing if there is none. It is sent gzipped if the browser takes that.
[[nodiscard]] std::optional<HttpResponse> page_response(const HttpRequest& request,
                                                        std::string_view path);

/// The plain bytes of a gzipped file that the build made (checked).
[[nodiscard]] std::string unzipped(std::span<const std::byte> gzipped);

}  // namespace engram::viewer
