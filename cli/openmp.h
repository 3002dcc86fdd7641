// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace engram::cli {

/// Lets OpenMP's threads spin only shortly where they wait, unless the environment says otherwise:
/// starts the program over with GOMP_SPINCOUNT set, because OpenMP reads it before main().
///
/// By default they spin for milliseconds and starve each other as soon as another process wants a
/// core; sleeping at once costs as much on an idle machine. Source: docs/learning.md.
void rest_waiting_threads(char** argv);

}  // namespace engram::cli
