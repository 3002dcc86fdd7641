// SPDX-License-Identifier: Apache-2.0
#include "viewer/page_assets.h"

#include <algorithm>

#include "tests/ltm/expect_status.h"

namespace engram::viewer {
namespace {

using ::testing::HasSubstr;

TEST(PageAssets, HaveAPageAtTheRoot) {
  const auto plain = page_response({}, "/");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->status, 200);
  EXPECT_EQ(plain->type, "text/html; charset=utf-8");
  EXPECT_THAT(plain->body, HasSubstr("<!doctype html>"));
  const auto zipped = page_response({.accept_encoding = "gzip, deflate, br"}, "/");
  ASSERT_TRUE(zipped);
  EXPECT_EQ(unzipped(std::as_bytes(std::span(zipped->body))), plain->body);
}

TEST(PageAssets, AreATableAndNoFolder) {
  for (const char* path : {"", "/index.html/..", "/../page_assets.cpp", "/assets", "/assets/",
                           "/assets/../index.html", "//", "/etc/passwd", "/%2e%2e/", "index.html"})
    EXPECT_FALSE(page_response({}, path)) << path;
}

TEST(PageAssets, AreAskedForOnceIfTheirNamesTellTheirContent) {
  for (const PageAsset& asset : page_assets()) {
    const auto again = page_response({.if_none_match = std::string(asset.etag)}, asset.path);
    ASSERT_TRUE(again);
    EXPECT_EQ(again->status, asset.is_immutable ? 304 : 200) << asset.path;
    EXPECT_EQ(again->body.empty(), asset.is_immutable);
    EXPECT_FALSE(unzipped(asset.gzipped).empty()) << asset.path;
  }
}

}  // namespace
}  // namespace engram::viewer
