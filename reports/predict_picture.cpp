// SPDX-License-Identifier: Apache-2.0
#include "reports/predict_picture.h"

#include <algorithm>
#include <cmath>

#include "reports/contact_sheet.h"
#include "reports/plain/text.h"
#include "training/quality/quality_metrics.h"

namespace engram::reports {

namespace {

using training::PredictedHorizon;
using training::PredictedMoment;

/// Returns the first image of a snapshot's first instance, or null.
const idf::NdArray* image_of(const ltm::SnapshotResult& snapshot) {
  return snapshot.instances.empty() ? nullptr : first_image(snapshot.instances.front().data);
}

/// The label of a row: the horizon such as "+200ms", the expected error and the real one, a line
/// each.
std::string label_of(const PredictedHorizon& horizon) {
  const ltm::InstanceResult& first = horizon.predicted.instances.front();
  std::string text = "+" + to_string(horizon.predicted.horizon);
  const auto add = [&text](const char* what, const std::optional<ltm::MeasuredError>& error) {
    if (!error || std::isnan(error->image_mse)) return;
    text += fmt::format("\n{} {}", what, db_text(training::psnr_db(error->image_mse)));
  };
  add("expected", first.error);
  add("90 % over", first.bound);
  add("real", horizon.error);
  add("copy-last", horizon.copy_error);
  return text;
}

}  // namespace

Status write_predict_picture(const PredictedMoment& moment, const std::filesystem::path& picture) {
  const bool has_come = std::ranges::any_of(
      moment.horizons, [](const PredictedHorizon& horizon) { return horizon.actual.has_value(); });
  const idf::NdArray* last = image_of(moment.last);
  std::vector<PictureRow> rows;
  for (const PredictedHorizon& horizon : moment.horizons) {
    const idf::NdArray* predicted = image_of(horizon.predicted);
    const idf::NdArray* actual = horizon.actual ? image_of(*horizon.actual) : nullptr;
    const idf::NdArray* beside = has_come ? actual : last;
    if (predicted == nullptr || beside == nullptr || beside->shape() != predicted->shape() ||
        last == nullptr)
      continue;
    PictureRow& row = rows.emplace_back(PictureRow{label_of(horizon), {*last}});
    if (has_come) row.images.push_back(*actual);
    row.images.push_back(*predicted);
    row.images.push_back(difference(*beside, *predicted));
  }
  if (rows.empty())
    return failed_precondition("picture '{}': what was predicted has no colour or grey image",
                               picture.string());
  const std::string error = fmt::format("error x {}", kDifferenceGain);
  const std::string change = fmt::format("change x {}", kDifferenceGain);
  if (has_come) return write_contact_sheet(picture, rows, {"last", "came", "predicted", error});
  return write_contact_sheet(picture, rows, {"last", "predicted", change});
}

}  // namespace engram::reports
