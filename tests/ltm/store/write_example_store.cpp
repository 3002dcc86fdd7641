// SPDX-License-Identifier: Apache-2.0
// Writes a store and prints as JSON what our reader finds in it, for h5py_test.py to compare.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "ltm/core/file.h"
#include "ltm/store/publish.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

using Json = nlohmann::ordered_json;

constexpr int64_t kSnapshots = 40;
/// The latents of the others are coded as blocks, the first of which lacks some.
constexpr int64_t kAlone = 15;

Snapshot robot_snapshot(int64_t index) {
  const double x = 0.125 * static_cast<double>(index);
  idf::Dict value{{"image", example_image(20, 30, 3, index)},
                  {"joints", idf::Dict{{"a/b", x}, {"elbow", -x}}},
                  {"count", index},
                  {"closed", index % 2 == 0},
                  {"force", idf::NdArray::take<float>({3}, {1, 2, static_cast<float>(index)})},
                  {"label", "grasp"}};
  return {example_entity(), example_time(index), {{std::move(value), example_metadata(index)}}};
}

idf::Type robot_type() {
  using idf::Type;
  const Type joints =
      Type::object("Joints", {{"a/b", Type::float64({"rad"})}, {"elbow", Type::float64({"rad"})}});
  return Type::object("Robot", {{"image", Type::image(idf::PixelType::kRgb24)},
                                {"joints", joints},
                                {"count", Type::int64()},
                                {"closed", Type::boolean()},
                                {"force", Type::ndarray(idf::ElementType::kFloat32, {3}, {"N"})},
                                {"label", Type::string()}});
}

Status write_store(const std::filesystem::path& store) {
  ENGRAM_RETURN_IF_ERROR(create_store(store));
  ENGRAM_ASSIGN_OR_RETURN(const auto writer, StoreWriter::open(store, {}));
  ENGRAM_RETURN_IF_ERROR(writer->declare(example_entity().parent(), robot_type()));
  for (int64_t i = 0; i < kSnapshots; ++i)
    ENGRAM_RETURN_IF_ERROR(writer->append({pack_snapshot(robot_snapshot(i))}, nullptr));
  ENGRAM_RETURN_IF_ERROR(writer->seal());
  ENGRAM_ASSIGN_OR_RETURN(const auto model, temporary_file(store, ".model"));
  ENGRAM_RETURN_IF_ERROR(replace_file(model, as_bytes("weights")));
  std::vector<LatentSnapshot> latents = example_latents(0, kAlone, 1);
  for (LatentSnapshot& each : example_block_latents(kAlone, kSnapshots, 1))
    latents.push_back(std::move(each));
  return publish_model(store, example_entity(), 1, model, latents);
}

Json describe(const Snapshot& snapshot, const PackedSnapshot& packed,
              const LatentSnapshot& latent) {
  const idf::Data& value = snapshot.instances[0].data;
  const Buffer& png = packed.instances[0].value.media[0].bytes;
  const Latent& coded = latent.instances[0].latent;
  Json json{{"timestamp", to_ns(snapshot.time)},
            {"a", *value.at("joints/a\\/b")->as_number()},
            {"elbow", *value.at("joints/elbow")->as_number()},
            {"count", value.at("count")->get<int64_t>()},
            {"closed", value.at("closed")->get<bool>()},
            {"provider", snapshot.instances[0].metadata.provider},
            {"png_bytes", png.size()}};
  json["force"] = Json::array();
  for (const float number : value.at("force")->get<idf::NdArray>().values<float>())
    json["force"].push_back(number);
  json["png_start"] = Json::array();
  for (size_t i = 0; i < 24; ++i) json["png_start"].push_back(static_cast<int>(png.bytes()[i]));
  json["code"] = Json::array();
  json["place"] = {coded.place.index, coded.place.count};
  for (const std::byte byte : coded.code.bytes()) json["code"].push_back(static_cast<int>(byte));
  return json;
}

Result<Json> read_store(const std::filesystem::path& store) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, StoreReader::open(store));
  ENGRAM_ASSIGN_OR_RETURN(const auto* entries, reader->index(example_entity()));
  Json rows = Json::array();
  for (const SnapshotEntry& entry : *entries) {
    ENGRAM_ASSIGN_OR_RETURN(const auto packed, reader->read_packed(example_entity(), entry));
    ENGRAM_ASSIGN_OR_RETURN(const auto snapshot, unpack(packed));
    ENGRAM_ASSIGN_OR_RETURN(const auto latent, reader->read_latent(example_entity(), entry));
    rows.push_back(describe(snapshot, packed, latent));
  }
  return rows;
}

int run(const std::filesystem::path& store) {
  const Status written = write_store(store);
  const auto rows = written.ok() ? read_store(store) : Result<Json>(written);
  if (!rows.ok()) {
    fmt::print(stderr, "{}\n", rows.status().to_string());
    return 1;
  }
  fmt::print("{}\n", rows->dump());
  return 0;
}

}  // namespace
}  // namespace engram::ltm

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: write_example_store STORE\n");
    return 2;
  }
  return engram::ltm::run(argv[1]);
}
