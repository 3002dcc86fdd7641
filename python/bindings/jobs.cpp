// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/jobs.h"

#include <pybind11/stl.h>

#include "encoders/load_model.h"
#include "ltm/forgetting/forget_config.h"
#include "ltm/reflection/record_reflection.h"
#include "ltm/reflection/reflect.h"
#include "ltm/store/store_check.h"
#include "python/bindings/python_progress.h"
#include "reports/consolidate_text.h"
#include "reports/plain/findings.h"
#include "reports/plain/forget_job.h"
#include "reports/plain/forget_text.h"
#include "reports/plain/reflection_text.h"
#include "speech/noticing/noticed_json.h"
#include "training/fade/erase.h"
#include "training/fade/fade.h"
#include "training/night/consolidate.h"

namespace engram::python {

namespace {

namespace py = pybind11;

/// Options by name.
class Options {
 public:
  explicit Options(const py::dict& given) : given_(given) {}

  /// Sets `place` unless the option is missing or None.
  template <typename T>
  void take(const char* name, T& place) const {
    if (given_.contains(name) && !given_[name].is_none()) place = given_[name].cast<T>();
  }
  [[nodiscard]] std::optional<int64_t> ns(const char* name) const {
    std::optional<int64_t> found;
    take(name, found);
    return found;
  }
  [[nodiscard]] std::string text(const char* name) const {
    std::string found;
    take(name, found);
    return found;
  }

 private:
  py::dict given_;
};

training::ConsolidateOptions consolidate_options(const Options& given) {
  training::ConsolidateOptions options;
  training::TrainOptions& train = options.train;
  if (const auto training = given.ns("training")) train.budget = Duration(*training);
  given.take("steps", train.steps);
  given.take("seed", train.seed);
  given.take("width", train.width);
  given.take("threads", train.threads);
  given.take("number_bound", train.number_bound);
  given.take("psnr", train.psnr_db);
  given.take("psnr", options.representation.bound_db);
  if (const std::string text = given.text("representation"); !text.empty())
    options.representation.kind = value_or_raise(training::representation_of(text));
  if (const auto access = given.ns("access")) options.access = Duration(*access);
  given.take("video_effort", options.representation.video_effort);
  given.take("video_tolerance", options.representation.video_tolerance_db);
  given.take("nights", options.representation.nights);
  given.take("refine", options.representation.refine_steps);
  given.take("entities", options.entities);
  options.augmented = given.text("augmented");
  given.take("min_snapshots", options.min_snapshots);
  given.take("force", options.force);
  given.take("anew", options.starts_anew);
  given.take("reuse_models", options.reuses_models);
  if (const auto until = given.ns("until")) options.job.until = time_from_ns(*until);
  if (const auto budget = given.ns("budget")) {
    if (*budget <= 0)
      value_or_raise<int>(invalid_argument("budget: found {} ns, needs more than 0", *budget));
    options.job.until = system_now() + Duration(*budget);
  }
  return options;
}

}  // namespace

std::string check(const std::string& store, bool is_deep, const py::object& progress) {
  PythonProgress told(progress);
  const ltm::CheckOptions options{is_deep, [](const std::filesystem::path& file) {
                                    return encoders::load_model(file).status();
                                  }};
  const ltm::CheckReport report =
      told.run([&] { return ltm::check_store(store, options, told.sink(), told.stop()); });
  return reports::check_json(report, store).dump();
}

std::string reflect(const std::string& store, const std::string& query, const std::string& against,
                    bool with_images, bool commits, const py::object& progress) {
  PythonProgress told(progress);
  ltm::ReflectOptions options = value_or_raise(ltm::reflect_options(query));
  options.with_images = with_images;
  const auto look = [&](const std::filesystem::path& at) {
    return told.run([&] { return ltm::reflect(at, options, told.sink(), told.stop()); });
  };
  const ltm::Reflection found = look(store);
  reports::Json json = reports::reflection_json(found);
  if (!against.empty())
    json["differences"] = reports::differences_json(ltm::compare_reflections(found, look(against)));
  if (commits)
    if (const Status recorded = ltm::record_reflection(store, found); !recorded.ok())
      raise(recorded);
  return json.dump();
}

std::string notice(const std::string& store, const std::string& joints, const std::string& open,
                   bool commits, const py::object& progress) {
  PythonProgress told(progress);
  speech::NoticeOptions options;
  options.open = value_or_raise(speech::open_hand_named(open));
  if (!joints.empty()) options.joints = value_or_raise(ltm::MemoryId::parse(joints));
  return told.run([&]() -> Result<std::string> {
    OpenOptions opened;
    opened.is_read_only = !commits;
    ENGRAM_ASSIGN_OR_RETURN(const auto memory, Memory::open(store, opened));
    ENGRAM_ASSIGN_OR_RETURN(const speech::Noticed found,
                            speech::notice_deeds(*memory, options, told.sink(), told.stop()));
    size_t committed = 0;
    if (commits) {
      ENGRAM_ASSIGN_OR_RETURN(committed, speech::remember_deeds(*memory, found.deeds));
      ENGRAM_RETURN_IF_ERROR(memory->close());
    }
    return speech::to_json(found, committed)
        .dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  });
}

std::string forget(const std::string& store, const std::vector<std::string>& targets,
                   const std::string& config, bool is_dry_run, bool erases,
                   const py::object& progress) {
  PythonProgress told(progress);
  ltm::ForgetOptions options;
  if (!config.empty()) options = value_or_raise(ltm::read_forget_config(config));
  const reports::ForgetJob job{store,
                               targets,
                               std::move(options),
                               encoders::load_model,
                               told.sink(),
                               told.stop(),
                               {training::fade, training::code_anew},
                               erases};
  // The plan's JSON is made before it is carried out, which consumes the plan.
  ltm::ForgetPlan plan = told.run([&] { return is_dry_run ? job.plan() : job.final_plan(); });
  reports::Json json{{"plan", reports::plan_json(plan)}};
  if (is_dry_run) return json.dump();
  const ltm::ForgetReport report = told.run([&] { return job.carry_out(std::move(plan)); });
  json["done"] = reports::report_json(report);
  return json.dump();
}

std::string consolidate(const std::string& store, const py::dict& options,
                        const py::object& progress) {
  PythonProgress told(progress);
  const training::ConsolidateOptions wanted = consolidate_options(Options(options));
  if (const Status status = wanted.validate(); !status.ok()) raise(status);
  training::ConsolidatePlan plan;
  const auto keep = [&](const training::ConsolidatePlan& made) { plan = made; };
  bool is_dry_run = false;
  Options(options).take("dry_run", is_dry_run);
  if (is_dry_run)
    return reports::plan_json(
               told.run([&] { return training::plan_consolidation(store, wanted, told.stop()); }))
        .dump();
  const training::ConsolidateReport report = told.run(
      [&] { return training::consolidate(store, wanted, told.sink(), told.stop(), keep); });
  return reports::report_json(plan, report, {}).dump();
}

}  // namespace engram::python
