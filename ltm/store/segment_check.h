// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ltm/store/link_check.h"
#include "ltm/store/manifest.h"
#include "ltm/store/store_check.h"

namespace engram::ltm {

inline constexpr const char* kAdviceRecover = "'engram recover STORE -o COPY' saves what is whole";

/// Makes a fault about `file` whose advice is to recover the store.
[[nodiscard]] Finding fault(std::string file, std::string object, std::string what);

/// Compares a published file with the manifest. Returns no findings if they agree.
[[nodiscard]] std::vector<Finding> check_file(const std::filesystem::path& store,
                                              const std::string& file, uint64_t bytes,
                                              uint64_t checksum);

/// Reads a whole segment and compares it with its entry in `manifest`. Adds counts and findings to
/// `report`, and links to `links`.
/// Errors: kCancelled.
Status check_segment(const std::filesystem::path& store, const Manifest& manifest,
                     const SegmentInfo& segment, const CheckOptions& options,
                     const std::stop_token& stop, CheckReport& report, LinkCheck& links);

}  // namespace engram::ltm
