// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace engram::encoders {

/// Sets the number of threads of the networks in the whole process. Values below 1 count as 1.
/// Matrix products of the BLAS use one thread, because its threads would add to those of the
/// networks.
void set_threads(int threads);

}  // namespace engram::encoders
