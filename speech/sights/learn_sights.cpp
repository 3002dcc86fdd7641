// SPDX-License-Identifier: Apache-2.0
#include "speech/sights/learn_sights.h"

#include "encoders/threads.h"
#include "speech/sights/sight_examples.h"
#include "speech/sights/sight_file.h"
#include "speech/sights/sight_fit.h"

namespace engram::speech {

Status LearnSightsOptions::validate() const {
  if (budget <= Duration::zero())
    return invalid_argument("learning sights: found a budget of {} s, needs more than 0",
                            to_seconds(budget));
  if (batch < 1 || batch > 1024)
    return invalid_argument("learning sights: found a batch of {}, needs 1 to 1024", batch);
  if (!(learning_rate > 0 && learning_rate < 1))
    return invalid_argument("learning sights: found a rate of {}, needs 0 to 1", learning_rate);
  if (copies < 0 || copies > 16)
    return invalid_argument("learning sights: found {} copies, needs 0 to 16", copies);
  return {};
}

Result<SightsReport> learn_sights(const std::vector<std::filesystem::path>& stores,
                                  const LearnSightsOptions& options,
                                  const std::filesystem::path& file, const ProgressSink& progress,
                                  const std::stop_token& stop) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return encoders::guarded("learning sights", [&]() -> Result<SightsReport> {
    encoders::set_threads(options.threads);
    torch::manual_seed(static_cast<int64_t>(options.seed));
    ENGRAM_ASSIGN_OR_RETURN(const SightExamples examples,
                            read_examples(stores, options, progress, stop));
    SightsReport report = examples.report;
    SavedSights sights{.words = examples.words,
                       .model = examples.model,
                       .grid = examples.grid,
                       .images = static_cast<int64_t>(report.images)};
    sights.layers = SightLayers(sights.shape());
    ENGRAM_RETURN_IF_ERROR(
        fit_sights(sights.layers, examples.learned, options, report, progress, stop));
    measure_sights(sights.layers, examples.held_out, report);
    sights.min_probability = report.min_probability;
    ENGRAM_RETURN_IF_ERROR(save_sights(sights, file));
    return report;
  });
}

}  // namespace engram::speech
