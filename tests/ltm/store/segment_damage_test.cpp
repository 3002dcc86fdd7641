// SPDX-License-Identifier: Apache-2.0
// Segments that are damaged, of another format or none: ltm/store/segment_reader.h.
#include "ltm/core/file.h"
#include "ltm/h5/h5.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/store/segment_files.h"

namespace engram::ltm {
namespace {

/// A small segment with something of everything.
Entities small_entities() {
  Entities entities;
  for (int64_t i = 0; i < 40; ++i) {
    idf::Dict value{{"image", example_image(9, 9, 1, i)},
                    {"x", 0.5 * static_cast<double>(i)},
                    {"n", static_cast<int32_t>(i)},
                    {"v", idf::NdArray::take<float>({4}, std::vector<float>(4, float(i)))},
                    {"label", "l" + std::to_string(i)}};
    Snapshot snapshot{example_entity(), example_time(i), {{value, example_metadata(i)}}};
    snapshot.instances[0].metadata.provider = i % 2 == 0 ? "left driver" : "right driver";
    entities[example_entity()].push_back(snapshot);
  }
  return entities;
}

/// Reads everything of a segment: what can be read must be what was written.
void expect_original_or_error(const std::filesystem::path& file,
                              const std::vector<Snapshot>& expected, const std::string& damage) {
  const auto reader = SegmentReader::open(file);
  if (!reader.ok()) return;
  const auto spans = (*reader)->index(example_entity());
  if (!spans.ok()) return;
  ASSERT_EQ(spans->size(), expected.size()) << damage;
  for (size_t i = 0; i < spans->size(); ++i) {
    EXPECT_EQ((*spans)[i].time, expected[i].time) << damage;
    const auto packed = (*reader)->read_recorded(example_entity(), (*spans)[i]);
    if (!packed.ok()) continue;
    EXPECT_EQ(packed->raw_bytes, expected[i].raw_bytes()) << damage;
    EXPECT_EQ(packed->dropped, 0u) << damage;
    const auto snapshot = unpack(*packed);
    if (!snapshot.ok()) continue;
    EXPECT_EQ(*snapshot, expected[i]) << damage;
  }
}

TEST(SegmentDamage, RefusesANewerFormat) {
  const ScratchDirectory scratch;
  {
    auto file = h5::File::create(scratch / "s.h5");
    ASSERT_OK(file->write_attribute("/", "format_version", int64_t{3}));
    ASSERT_OK(file->close());
  }
  EXPECT_FAILS(SegmentReader::open(scratch / "s.h5"), StatusCode::kFailedPrecondition, "up to 2");
}

TEST(SegmentDamage, IsNoOtherHdf5File) {
  const ScratchDirectory scratch;
  ASSERT_OK(h5::File::create(scratch / "s.h5")->close());
  EXPECT_FAILS(SegmentReader::open(scratch / "s.h5"), StatusCode::kDataLoss, "no segment");
}

TEST(SegmentDamage, NeverGivesWrongDataWhereAByteIsDamaged) {
  const ScratchDirectory scratch;
  const Entities entities = small_entities();
  ASSERT_OK(write_entities(scratch / "s.h5", entities));
  const Buffer whole = *read_file(scratch / "s.h5");
  RandomValues random(31);
  for (size_t at = random.below(23); at < whole.size(); at += 23) {
    std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
    damaged[at] ^= static_cast<std::byte>(1u << random.below(8));
    overwrite_file(scratch / "d.h5", damaged);
    expect_original_or_error(scratch / "d.h5", entities.at(example_entity()),
                             "byte " + std::to_string(at));
    if (HasFatalFailure()) return;
  }
}

TEST(SegmentDamage, NeverGivesWrongDataWhereItIsCutShort) {
  const ScratchDirectory scratch;
  const Entities entities = small_entities();
  ASSERT_OK(write_entities(scratch / "s.h5", entities));
  const Buffer whole = *read_file(scratch / "s.h5");
  for (size_t size = 0; size < whole.size(); size += 997) {
    overwrite_file(scratch / "d.h5", whole.bytes().subspan(0, size));
    expect_original_or_error(scratch / "d.h5", entities.at(example_entity()),
                             "cut at " + std::to_string(size));
  }
}

}  // namespace
}  // namespace engram::ltm
