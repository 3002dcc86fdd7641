// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ltm/forgetting/forget_options.h"
#include "viewer/request_target.h"

namespace engram::viewer {

/// What a store is asked to forget, as the page's form says it or as a configuration does.
struct ForgetPolicyText {
  std::string config;  ///< YAML that `engram forget --config` takes.
  ltm::ForgetOptions options;
};

/// Reads a policy from the parameters `config`, a YAML text, or `match`, `older_than`,
/// `unread_for`, `keep`, `fade_after` with `fade_psnr`, `max_bytes` and `newest`.
/// Errors: kInvalidArgument naming the parameter, and of a configuration the line and the key.
/// Source: docs/viewer_protocol.md.
Result<ForgetPolicyText> read_forget_policy(const RequestTarget& target);

}  // namespace engram::viewer
