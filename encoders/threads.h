// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace engram::encoders {

/// Sets how many threads networks compute with, in the whole process. Matrix products of the BLAS
/// stay on one: the networks' own threads come on top of them. Values below 1 count as 1.
void set_threads(int threads);

}  // namespace engram::encoders
