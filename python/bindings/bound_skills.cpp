// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/bound_skills.h"

#include <pybind11/stl.h>
#include <unistd.h>

#include <memory>

#include "ltm/core/mutex.h"
#include "python/bindings/errors.h"
#include "python/bindings/values.h"
#include "server/client/skill_provider.h"

namespace engram::python {

namespace {

namespace py = pybind11;

std::vector<ltm::MemoryId> links_from(const std::vector<std::string>& texts) {
  std::vector<ltm::MemoryId> links;
  for (const std::string& text : texts) links.push_back(value_or_raise(ltm::MemoryId::parse(text)));
  return links;
}

/// An execution as the Python function sees it, valid as long as that function runs.
class BoundRun {
 public:
  explicit BoundRun(SkillRun& run) : run_(&run) {}

  /// Returns once no thread of the function reports any more.
  void end() {
    run_ = nullptr;
    const py::gil_scoped_release others;
    const MutexLock lock(mutex_);
    is_idle_.wait(mutex_, [this]() ENGRAM_REQUIRES(mutex_) { return reports_ == 0; });
  }

  py::object parameters() { return to_python(run().parameters()); }
  bool is_stopped() { return run().stop().stop_requested(); }
  std::string stop_reason() { return run().stop_reason(); }
  std::string execution() { return run().execution().to_string(); }
  std::string request() { return run().request().to_string(); }

  void report(const py::object& value, const std::vector<std::string>& links) {
    const idf::Data data = from_python(value);
    const auto ids = links_from(links);
    // Threads of the function may report, too, while it ends.
    SkillRun& here = run();
    count_report(1);
    Status status;
    {
      const py::gil_scoped_release others;
      status = here.report(data, ids);
      count_report(-1);
    }
    if (!status.ok()) raise(status);
  }

  /// Waits; true as soon as it is to stop.
  bool wait(int64_t timeout) {
    const std::stop_token stop = run().stop();
    const py::gil_scoped_release others;
    Mutex mutex;  // StoppableCondition needs one; this one guards nothing.
    StoppableCondition changed;
    const MutexLock lock(mutex);
    changed.wait_for(mutex, stop, Duration(timeout), [] { return false; });
    return stop.stop_requested();
  }

 private:
  SkillRun& run() const {
    if (run_ == nullptr) raise(failed_precondition("the execution of the skill is over"));
    return *run_;
  }

  void count_report(int change) {
    const MutexLock lock(mutex_);
    reports_ += change;
    if (reports_ == 0) is_idle_.notify_all();
  }

  SkillRun* run_;  ///< Under the interpreter's lock.
  Mutex mutex_;
  ConditionVariable is_idle_;
  int reports_ ENGRAM_GUARDED_BY(mutex_) = 0;
};

/// Calls a function of Python, which returns (outcome, reason, result, links). It is shared and not
/// copied, because copies of Python's objects need the interpreter's lock.
class CalledFunction {
 public:
  explicit CalledFunction(py::function function) : function_(std::move(function)) {}
  CalledFunction(const CalledFunction&) = delete;
  CalledFunction& operator=(const CalledFunction&) = delete;
  ~CalledFunction() {
    const py::gil_scoped_acquire interpreter;
    function_ = py::function();
  }

  SkillEnd call(SkillRun& run) {
    const py::gil_scoped_acquire interpreter;
    const auto bound = std::make_shared<BoundRun>(run);
    try {
      const auto [outcome, reason, result, links] =
          function_(bound)
              .cast<std::tuple<int, std::string, py::object, std::vector<std::string>>>();
      bound->end();
      return {static_cast<SkillOutcome>(outcome), reason, from_python(result), links_from(links)};
    } catch (py::error_already_set& error) {
      bound->end();
      return SkillEnd::failure(error.what());
    } catch (const py::cast_error& error) {
      bound->end();
      return SkillEnd::failure(error.what());
    }
  }

 private:
  py::function function_;
};

class BoundProvider {
 public:
  BoundProvider(const std::string& endpoint, const std::string& name, const std::string& token,
                const std::string& ca, int64_t timeout, bool is_name_system)
      : process_(::getpid()) {
    ConnectOptions options{
        .is_name_system = is_name_system, .token = token, .ca = ca, .timeout = Duration(timeout)};
    const py::gil_scoped_release others;
    auto connected = SkillProvider::connect(endpoint, name, options);
    const py::gil_scoped_acquire interpreter;
    provider_ = value_or_raise(std::move(connected));
  }
  BoundProvider(const BoundProvider&) = delete;
  BoundProvider& operator=(const BoundProvider&) = delete;
  ~BoundProvider() { close(); }

  void add(const std::string& description, py::function function) {
    const auto called = std::make_shared<CalledFunction>(std::move(function));
    const auto provider = open();
    Status status;
    {
      const py::gil_scoped_release others;
      status = provider->add(description, [called](SkillRun& run) { return called->call(run); });
    }
    if (!status.ok()) raise(status);
  }

  void remove(const std::string& skill) {
    const auto provider = open();
    Status status;
    {
      const py::gil_scoped_release others;
      status = provider->remove(skill);
    }
    if (!status.ok()) raise(status);
  }

  size_t running() { return open()->running(); }

  void close() {
    std::shared_ptr<SkillProvider> provider = std::move(provider_);
    // Its threads did not survive a fork.
    if (provider && process_ != ::getpid()) new std::shared_ptr<SkillProvider>(provider);
    // Functions that run need the interpreter to end.
    const py::gil_scoped_release others;
    provider.reset();
  }

 private:
  std::shared_ptr<SkillProvider> open() {
    if (!provider_) raise(failed_precondition("the provider is closed"));
    return provider_;
  }

  const int process_;
  std::shared_ptr<SkillProvider> provider_;
};

}  // namespace

void define_skills(py::module_& module) {
  py::class_<BoundRun, std::shared_ptr<BoundRun>>(module, "SkillRun")
      .def("parameters", &BoundRun::parameters)
      .def("is_stopped", &BoundRun::is_stopped)
      .def("stop_reason", &BoundRun::stop_reason)
      .def("execution", &BoundRun::execution)
      .def("request", &BoundRun::request)
      .def("report", &BoundRun::report)
      .def("wait", &BoundRun::wait);
  py::class_<BoundProvider>(module, "SkillProvider")
      .def(py::init<const std::string&, const std::string&, const std::string&, const std::string&,
                    int64_t, bool>())
      .def("add", &BoundProvider::add)
      .def("remove", &BoundProvider::remove)
      .def("running", &BoundProvider::running)
      .def("close", &BoundProvider::close);
}

}  // namespace engram::python
