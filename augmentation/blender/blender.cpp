// SPDX-License-Identifier: Apache-2.0
#include "augmentation/blender/blender.h"

#include <stdlib.h>
#include <xxhash.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "augmentation/blender/render_script.h"
#include "ltm/codec/codec.h"
#include "ltm/codec/image_file.h"
#include "ltm/core/file.h"
#include "ltm/core/line_process.h"

namespace engram::augmentation {

using nlohmann::json;

namespace {

constexpr std::string_view kPrefix = "engram: ";
constexpr auto kStart = std::chrono::minutes(1);
constexpr int64_t kMaxRenderedPixels = int64_t{1} << 28;

const char* word(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::kBox:
      return "box";
    case ShapeKind::kCylinder:
      return "cylinder";
    case ShapeKind::kCapsule:
      return "capsule";
    case ShapeKind::kEllipsoid:
      return "ellipsoid";
  }
  return "";
}

json to_json(const SceneCamera& camera) {
  return {{"width", camera.width}, {"height", camera.height}, {"fx", camera.fx},
          {"fy", camera.fy},       {"cx", camera.cx},         {"cy", camera.cy},
          {"pose", camera.pose}};
}

json to_json(const SceneShape& shape) {
  return {{"kind", word(shape.kind)},   {"half", shape.half},
          {"pose", shape.pose},         {"colour", shape.colour},
          {"texture", shape.texture},   {"way", shape.way == TextureWay::kCube ? "cube" : "plane"},
          {"repeat", shape.repeat},     {"roughness", shape.roughness},
          {"emission", shape.emission}, {"is_seen", shape.is_seen}};
}

json to_json(const SceneLamp& lamp) {
  return {{"kind", lamp.kind == LampKind::kSun ? "sun" : "point"},
          {"pose", lamp.pose},
          {"strength", lamp.strength},
          {"size", lamp.size},
          {"colour", lamp.colour},
          {"casts_shadow", lamp.casts_shadow},
          {"falls_off", lamp.falls_off}};
}

/// Returns the text of a member, or nothing if it is missing or not text.
std::optional<std::string> said_text(const json& said, const char* name) {
  const auto value = said.find(name);
  if (value == said.end() || !value->is_string()) return std::nullopt;
  return value->get<std::string>();
}

Result<std::filesystem::path> make_folder() {
  std::error_code error;
  std::string name =
      (std::filesystem::temp_directory_path(error) / "engram-blender-XXXXXX").string();
  if (error || ::mkdtemp(name.data()) == nullptr)
    return unavailable("no temporary folder can be made as '{}'", name);
  return std::filesystem::path(name);
}

Result<idf::NdArray> read_image(const std::filesystem::path& file, const SceneCamera& camera) {
  ENGRAM_ASSIGN_OR_RETURN(const Buffer bytes, read_file(file));
  auto image = ltm::decode_any_image_file(bytes.bytes(), kMaxRenderedPixels);
  if (!image.ok()) return image.status().with_context("Blender: '" + file.string() + "'");
  const idf::Shape needed{camera.height, camera.width, 3};
  if (image->type() != idf::ElementType::kUInt8 || image->shape() != needed)
    return unavailable("Blender: found an image {} {}, needs uint8 {}", to_string(image->type()),
                       idf::to_string(image->shape()), idf::to_string(needed));
  return image;
}

}  // namespace

struct Blender::State {
  Options options;
  std::filesystem::path folder;
  LineProcess process;
  std::string version;
  int number = 0;
  std::map<uint64_t, std::string> textures;  ///< Files by the hash of their pixels.

  ~State() {
    std::error_code ignored;
    if (!folder.empty()) std::filesystem::remove_all(folder, ignored);
  }

  /// Reads the next answer. Blender also prints lines of its own, so lines without our prefix are
  /// skipped.
  Result<json> answer(Duration patience) {
    while (true) {
      ENGRAM_ASSIGN_OR_RETURN(const std::string line, process.read_line(patience));
      if (!line.starts_with(kPrefix)) continue;
      json said = json::parse(line.substr(kPrefix.size()), nullptr, false);
      if (said.is_object()) return said;
    }
  }

  Result<std::string> file_of(const idf::NdArray& picture) {
    const auto bytes = picture.bytes();
    // Scenes of one recording repeat their textures, so each one is written once per process.
    uint64_t key = XXH3_64bits(bytes.data(), bytes.size());
    key =
        XXH3_64bits_withSeed(picture.shape().data(), picture.shape().size() * sizeof(int64_t), key);
    if (const auto known = textures.find(key); known != textures.end()) return known->second;
    ENGRAM_ASSIGN_OR_RETURN(const auto png, ltm::find_codec("png")->encode(picture));
    const std::string file = (folder / fmt::format("{:016x}.png", key)).string();
    ENGRAM_RETURN_IF_ERROR(replace_file(file, png));
    textures.emplace(key, file);
    return file;
  }
};

Blender::Blender(std::unique_ptr<State> state) : state_(std::move(state)) {}
Blender::~Blender() = default;

Result<std::unique_ptr<Blender>> Blender::start(const Options& options) {
  if (options.samples < 1 || options.samples > 4096)
    return invalid_argument("Blender: found {} samples per pixel, needs 1 to 4096",
                            options.samples);
  if (!(options.noise >= 0))
    return invalid_argument("Blender: found a noise of {}, needs 0 or more", options.noise);
  if (options.threads < 1)
    return invalid_argument("Blender: found {} threads, needs 1 or more", options.threads);
  auto state = std::make_unique<State>();
  state->options = options;
  ENGRAM_ASSIGN_OR_RETURN(state->folder, make_folder());
  const std::filesystem::path script = state->folder / "render_scenes.py";
  if (!(std::ofstream(script) << render_script()).flush())
    return unavailable("'{}' cannot be written", script.string());
  const char* named = ::getenv("ENGRAM_BLENDER");
  std::string program = options.program;
  if (program.empty()) program = named != nullptr && *named != '\0' ? named : "blender";
  const Status started =
      state->process.start({program, "--background", "--factory-startup", "-noaudio",
                            "--python-exit-code", "1", "--python", script.string()});
  if (started.code() == StatusCode::kNotFound)
    return not_found(
        "Blender: found no program '{}', needs Blender 3.4 (Debian: apt install blender), or its "
        "place in ENGRAM_BLENDER",
        program);
  ENGRAM_RETURN_IF_ERROR(started);
  auto ready = state->answer(kStart);
  if (!ready.ok()) return ready.status().with_context("Blender does not start");
  state->version = said_text(*ready, "ready").value_or("");
  return std::unique_ptr<Blender>(new Blender(std::move(state)));
}

const std::string& Blender::version() const {
  return state_->version;
}

Result<idf::NdArray> Blender::render(const Scene& scene) {
  ENGRAM_RETURN_IF_ERROR(scene.validate());
  State& state = *state_;
  const std::filesystem::path file = state.folder / "image.png";
  json job = {{"number", ++state.number},         {"file", file.string()},
              {"samples", state.options.samples}, {"noise", state.options.noise},
              {"threads", state.options.threads}, {"ambient", scene.ambient},
              {"camera", to_json(scene.camera)},  {"shapes", json::array()},
              {"lamps", json::array()},           {"textures", json::array()}};
  for (const SceneShape& shape : scene.shapes) job["shapes"].push_back(to_json(shape));
  for (const SceneLamp& lamp : scene.lamps) job["lamps"].push_back(to_json(lamp));
  for (const idf::NdArray& picture : scene.textures) {
    ENGRAM_ASSIGN_OR_RETURN(std::string name, state.file_of(picture));
    job["textures"].push_back(std::move(name));
  }
  // The image of the scene before has the same name; if Blender writes none, that one must not be
  // taken for the new one.
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  ENGRAM_RETURN_IF_ERROR(state.process.write_line(job.dump()));
  ENGRAM_ASSIGN_OR_RETURN(const json answer, state.answer(state.options.patience));
  const auto number = answer.find("number");
  if (number == answer.end() || *number != json(state.number) || answer.contains("error"))
    return unavailable("Blender: {}", said_text(answer, "error").value_or(answer.dump()));
  return read_image(file, scene.camera);
}

}  // namespace engram::augmentation
