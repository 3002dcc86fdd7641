// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>

#include "speech/sights/sight_examples.h"

// Private to this room: includes LibTorch.

namespace engram::speech {

/// Trains the layers until the time is over. Fills steps, seconds and loss of the report.
/// Errors: kCancelled.
Status fit_sights(SightLayers& layers, const SightBatch& learned, const LearnSightsOptions& options,
                  SightsReport& report, const ProgressSink& progress, const std::stop_token& stop);

/// Measures on images that are held out how well things are seen, and chooses the probability from
/// which on they are told to be in sight: the one with the best mean, the harmonic one, of what is
/// found and of what is found rightly.
void measure_sights(SightLayers& layers, const SightBatch& held_out, SightsReport& report);

}  // namespace engram::speech
