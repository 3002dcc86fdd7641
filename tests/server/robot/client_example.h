// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ltm/core/status.h"

/// What docs/server.md shows, section "From C++".
engram::Status remember_a_cup(const std::string& endpoint);
