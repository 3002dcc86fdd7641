// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace engram::cli {

/// Lets OpenMP's threads sleep where they wait, unless the environment says otherwise: starts the
/// program over with OMP_WAIT_POLICY=passive, because OpenMP reads it before main().
///
/// Threads that spin starve each other as soon as another process wants a core: training beside
/// two compilers took 2 to 6 times as long.
void rest_waiting_threads(char** argv);

}  // namespace engram::cli
