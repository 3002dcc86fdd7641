// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/memory/commit.h"

namespace engram::experiments {

/// The three objects of the paper's timings (Peller-Konrad et al., section "Performance").
enum class AgeObject { kSimple, kModerate, kComplex };

[[nodiscard]] const char* to_string(AgeObject object);

/// A commit of so many of them, each of an entity of its own. They carry `made_ns`: when that was
/// by the machine's steady clock.
[[nodiscard]] ltm::Commit make_commit(AgeObject object, int batch, Time time, int64_t made_ns);

/// What make_commit was told; the smallest of a commit.
[[nodiscard]] int64_t made_ns(const ltm::Commit& commit);
[[nodiscard]] int64_t made_ns(const idf::Data& data);

[[nodiscard]] int64_t steady_ns();

}  // namespace engram::experiments
