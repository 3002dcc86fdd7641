// SPDX-License-Identifier: Apache-2.0
#include "store/image_reads.h"

#include <algorithm>
#include <random>

#include "ltm/core/check.h"

namespace engram::experiments {

std::vector<ImageRead> draw_reads(const Stream& stream, size_t count, uint64_t seed) {
  ENGRAM_CHECK(stream.ticks() > 0, "no ticks");
  const size_t images = (stream.ticks() - 1) / Stream::kTicksPerImage;
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<size_t> image(0, images), camera(0, kCameras.size() - 1);
  std::vector<ImageRead> reads;
  for (size_t i = 0; i < count; ++i)
    reads.push_back({camera(random), image(random) * Stream::kTicksPerImage});
  return reads;
}

Result<Buffer> read_image(ltm::Recall& recall, size_t camera, Time time) {
  const ltm::MemoryId id = camera_id(camera);
  ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult answer,
                          recall.query(ltm::Query::of_entity(id, ltm::select::At{time})));
  const ltm::InstanceResult* found = answer.find_instance(id.at(time).instance(0));
  const idf::Data* image = found == nullptr ? nullptr : found->data.at("image");
  if (image == nullptr || !image->is<idf::NdArray>())
    return not_found("entity '{}': no image at {}", id.to_string(), to_string(time));
  return image->get<idf::NdArray>().buffer();
}

Status expect_image(const Buffer& found, const Stream& stream, const ImageRead& read) {
  const idf::NdArray& shown = stream.frames()[stream.frame_index(read.camera, read.tick)];
  if (std::ranges::equal(found.bytes(), shown.bytes())) return {};
  return data_loss("entity '{}': the image at {} is not what was written",
                   camera_id(read.camera).to_string(), to_string(stream.tick(read.tick).time));
}

}  // namespace engram::experiments
