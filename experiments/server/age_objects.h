// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/memory/commit.h"

namespace engram::experiments {

/// The three objects of the paper's timings (Peller-Konrad et al., section "Performance").
enum class AgeObject { kSimple, kModerate, kComplex };

[[nodiscard]] const char* to_string(AgeObject object);

/// Makes a commit of `batch` objects, each of an entity of its own. They contain `made_ns`, the
/// time on the machine's steady clock at which they were made.
[[nodiscard]] ltm::Commit make_commit(AgeObject object, int batch, Time time, int64_t made_ns);

/// Returns the `made_ns` of make_commit; the smallest one of a commit.
[[nodiscard]] int64_t made_ns(const ltm::Commit& commit);
[[nodiscard]] int64_t made_ns(const idf::Data& data);

[[nodiscard]] int64_t steady_ns();

}  // namespace engram::experiments
