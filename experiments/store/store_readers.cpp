// SPDX-License-Identifier: Apache-2.0
// Do readers block each other? Reads random images of one store by one thread and by several, each
// with a reader of its own, and compares with the same threads that only decode images in memory.
#include "ltm/codec/codec.h"
#include "store/image_reads.h"
#include "store/recorder_run.h"
#include "store/report.h"
#include "store/stream_options.h"
#include "store/thread_run.h"

namespace engram::experiments {
namespace {

constexpr double kScalingBar = 1.8;  // of two threads, median

struct Arguments {
  StreamOptions stream{.seconds = 20, .dir = "bars/readers"};
  size_t reads = 50;
  size_t threads = 2;
  int repeats = 200;
};

/// Makes the work of a thread from its number.
using MakeWork = std::function<Result<Work>(size_t)>;

/// The passes of one thread or of several, per image.
struct Figures {
  std::vector<double> per_second;
  std::vector<double> cpu_seconds;
  double waits = 0;

  void add(const Pass& pass, size_t images) {
    const auto count = static_cast<double>(images);
    per_second.push_back(count / pass.seconds);
    cpu_seconds.push_back(pass.spent.cpu_seconds / count);
    waits += pass.spent.waits;
  }
};

/// Passes of one thread and of several, which alternate.
struct Scaling {
  std::string name;
  Works works;  ///< One work per thread.
  Figures one;
  Figures several;

  /// The ratio of wall times, which also depends on the load of the machine.
  [[nodiscard]] double ratio(double share) const {
    return quantile(several.per_second, share) / quantile(one.per_second, share);
  }

  /// The ratio that otherwise idle processors would reach as long as nobody waits.
  [[nodiscard]] double free_ratio() const {
    return static_cast<double>(works.size()) * quantile(one.cpu_seconds, 0.5) /
           quantile(several.cpu_seconds, 0.5);
  }
};

Result<Scaling> prepare(std::string name, const MakeWork& make, size_t threads) {
  Scaling scaling{std::move(name), {}, {}, {}};
  for (size_t i = 0; i < threads; ++i) {
    ENGRAM_ASSIGN_OR_RETURN(Work work, make(i));
    scaling.works.push_back(std::move(work));
  }
  return scaling;
}

Status measure(Scaling& scaling, size_t reads) {
  const size_t threads = scaling.works.size();
  ENGRAM_ASSIGN_OR_RETURN(const Pass one, run_threads(scaling.works, 1));
  ENGRAM_ASSIGN_OR_RETURN(const Pass several, run_threads(scaling.works, threads));
  scaling.one.add(one, reads);
  scaling.several.add(several, reads * threads);
  return {};
}

/// Each thread has its own reader and its own images. One pass before the timing compares them.
MakeWork readers_of(const std::filesystem::path& store, const Stream& stream, size_t reads) {
  return [=, &stream](size_t thread) -> Result<Work> {
    ENGRAM_ASSIGN_OR_RETURN(auto reader, ltm::StoreReader::open(store));
    const auto recall = std::make_shared<ltm::Recall>(std::move(reader), ltm::ModelLoader());
    std::vector<std::pair<size_t, Time>> places;
    for (const ImageRead& it : draw_reads(stream, reads, thread + 1)) {
      places.emplace_back(it.camera, stream.tick(it.tick).time);
      ENGRAM_ASSIGN_OR_RETURN(const Buffer found,
                              read_image(*recall, it.camera, places.back().second));
      ENGRAM_RETURN_IF_ERROR(expect_image(found, stream, it));
    }
    return Work([recall, places = std::move(places)]() -> Status {
      for (const auto& [camera, time] : places)
        ENGRAM_RETURN_IF_ERROR(read_image(*recall, camera, time).status());
      return {};
    });
  };
}

/// Decodes the same images, encoded in memory.
MakeWork decoders_of(const Stream& stream, size_t reads) {
  return [=, &stream](size_t thread) -> Result<Work> {
    const ltm::Codec* codec = ltm::find_codec("rowpred");
    const idf::NdArray& first = stream.frames().front();
    std::vector<std::vector<std::byte>> packed;
    for (const ImageRead& it : draw_reads(stream, reads, thread + 1)) {
      ENGRAM_ASSIGN_OR_RETURN(
          auto bytes, codec->encode(stream.frames()[stream.frame_index(it.camera, it.tick)]));
      packed.push_back(std::move(bytes));
    }
    return Work([=, packed = std::move(packed), &first]() -> Status {
      for (const auto& bytes : packed)
        ENGRAM_RETURN_IF_ERROR(codec->decode(bytes, first.type(), first.shape()).status());
      return {};
    });
  };
}

void print_table(const std::vector<Scaling>& rows) {
  const size_t threads = rows.front().works.size();
  const auto several = fmt::format("{} threads", threads);
  TextTable table({"what", "images/s, best", several, "median", several, "ratio, best", "median",
                   "CPU ms per image", several, "ratio, free cores", "waits", several,
                   "bar, median"});
  for (const Scaling& it : rows)
    table.add({it.name, fmt::format("{:.0f}", quantile(it.one.per_second, 1)),
               fmt::format("{:.0f}", quantile(it.several.per_second, 1)),
               fmt::format("{:.0f}", quantile(it.one.per_second, 0.5)),
               fmt::format("{:.0f}", quantile(it.several.per_second, 0.5)),
               fmt::format("{:.2f}", it.ratio(1)), fmt::format("{:.2f}", it.ratio(0.5)),
               fmt::format("{:.3f}", 1e3 * quantile(it.one.cpu_seconds, 0.5)),
               fmt::format("{:.3f}", 1e3 * quantile(it.several.cpu_seconds, 0.5)),
               fmt::format("{:.2f}", it.free_ratio()), fmt::format("{:.0f}", it.one.waits),
               fmt::format("{:.0f}", it.several.waits),
               threads == 2 ? verdict(it.ratio(0.5) >= kScalingBar) : ""});
  fmt::print("\n{}", table.to_string());
}

nlohmann::json to_json(const Figures& it) {
  return {{"per_second", it.per_second}, {"cpu_seconds", it.cpu_seconds}, {"waits", it.waits}};
}

Status run(const Arguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(StreamSource source, load_stream_source(arguments.stream.frames));
  const Stream stream(std::move(source), arguments.stream.seconds);
  const auto store = std::filesystem::path(arguments.stream.dir) / "store";
  ENGRAM_RETURN_IF_ERROR(record_stream({"readers", "preset: recorder\n"}, stream, store).status());
  fmt::print("stream: {}; {:.0f} s; {} reads per thread, {} times\n", stream.description(),
             stream.seconds(), arguments.reads, arguments.repeats);
  ENGRAM_ASSIGN_OR_RETURN(Scaling stored,
                          prepare("images of one store", readers_of(store, stream, arguments.reads),
                                  arguments.threads));
  ENGRAM_ASSIGN_OR_RETURN(
      Scaling in_memory,
      prepare("images in memory", decoders_of(stream, arguments.reads), arguments.threads));
  for (int i = 0; i < arguments.repeats; ++i) {
    ENGRAM_RETURN_IF_ERROR(measure(stored, arguments.reads));
    ENGRAM_RETURN_IF_ERROR(measure(in_memory, arguments.reads));
  }
  const std::vector<Scaling> rows{std::move(stored), std::move(in_memory)};
  print_table(rows);
  nlohmann::json json{{"stream", stream.description()}, {"threads", arguments.threads}};
  for (const Scaling& it : rows)
    json["rows"].push_back(
        {{"name", it.name}, {"one", to_json(it.one)}, {"several", to_json(it.several)}});
  return write_json(arguments.stream.json, json);
}

}  // namespace
}  // namespace engram::experiments

int main(int argc, char** argv) {
  engram::experiments::Arguments arguments;
  CLI::App app(
      "Measures how reading scales over threads. ENGRAM_RECORDINGS names a folder of videos;"
      " without it a scene is rendered.");
  arguments.stream.add_to(app);
  app.add_option("--reads", arguments.reads, "of one image at a random time, per thread")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--threads", arguments.threads, "to compare with one")
      ->check(CLI::Range(2, 256))
      ->capture_default_str();
  app.add_option("--repeats", arguments.repeats, "of one thread and several, alternating")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  return engram::experiments::exit_code("store_readers", engram::experiments::run(arguments));
}
