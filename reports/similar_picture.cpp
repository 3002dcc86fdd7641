// SPDX-License-Identifier: Apache-2.0
#include "reports/similar_picture.h"

#include <array>

#include "ltm/likeness/seen_image.h"
#include "reports/contact_sheet.h"

namespace engram::reports {

namespace {

constexpr std::array<Duration, 3> kShownLags{Duration::zero(), std::chrono::seconds(1),
                                             std::chrono::seconds(2)};

/// The images of a moment and before it, as far as its recording goes.
Result<std::vector<idf::NdArray>> seen_until(const SeenAt& seen, Time moment, Time first) {
  std::vector<idf::NdArray> images;
  for (const Duration lag : kShownLags) {
    ENGRAM_ASSIGN_OR_RETURN(const auto snapshot, seen(moment - lag));
    if (!snapshot || snapshot->time < first) break;
    const idf::NdArray* const image = ltm::image_of(*snapshot);
    if (image == nullptr || image->type() != idf::ElementType::kUInt8) break;
    images.push_back(*image);
  }
  return images;
}

}  // namespace

Status draw_similar(const SeenAt& seen, const ltm::SimilarRequest& request,
                    const ltm::SimilarAnswer& answer, const std::filesystem::path& file) {
  std::vector<PictureRow> rows;
  if (request.image) {
    rows.push_back({"asked with", {*request.image}});
  } else {
    ENGRAM_ASSIGN_OR_RETURN(auto images,
                            seen_until(seen, *request.moment, *request.moment - kShownLags[2]));
    rows.push_back({"asked with\n" + to_string(*request.moment), std::move(images)});
  }
  for (const ltm::SimilarMoment& moment : answer.moments) {
    ENGRAM_ASSIGN_OR_RETURN(auto images, seen_until(seen, moment.time, moment.recording_first));
    rows.push_back(
        {fmt::format("{:.3f}\n{}", moment.distance, to_string(moment.time)), std::move(images)});
  }
  std::erase_if(rows, [](const PictureRow& row) { return row.images.empty(); });
  if (rows.empty())
    return failed_precondition("'{}': has no images of 8 bits to draw", answer.entity.to_string());
  return write_contact_sheet(file, rows, {"now", "1 s before", "2 s before"});
}

}  // namespace engram::reports
