// SPDX-License-Identifier: Apache-2.0
#include "cli/learning_module.h"

#include <dlfcn.h>

#include <string_view>

#include "ltm/store/manifest.h"
#include "memory/model_loader.h"

namespace engram::cli {

namespace {

namespace fs = std::filesystem;

/// As the linker is told to export it (cli/learning_module.exports).
constexpr const char* kSymbol = "engram_learning_module";

/// Builds and installations have it beside the program.
fs::path module_file() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path() / ENGRAM_LEARNING_MODULE;
}

Result<const LearningModule*> load(const fs::path& file) {
  // The module is linked with -z now, so a symbol that it lacks is an error here and not in the
  // middle of a command. The hundred libraries behind LibTorch are bound lazily, as at the start of
  // a program; RTLD_NOW would bind every function of theirs. It is never closed, as models and
  // commands live as long as they like.
  void* const library = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (library == nullptr)
    return failed_precondition("'{}', which learns and opens models, cannot be loaded: {}",
                               file.string(), ::dlerror());
  const auto* const module = static_cast<const LearningModule*>(::dlsym(library, kSymbol));
  const std::string_view found = module != nullptr ? module->build : "no module of engram";
  if (found != module_build())
    return failed_precondition("'{}' is of another build: found {}, needs {}", file.string(), found,
                               module_build());
  return module;
}

}  // namespace

Result<const LearningModule*> learning_module() {
  static const Result<const LearningModule*> module = load(module_file());
  return module;
}

Status ready_for_models(const fs::path& store) {
  std::error_code error;
  if (fs::is_empty(store / "models", error) || error) return {};
  return learning_module().status();
}

Result<ltm::Erasures> code_anew(const std::filesystem::path& store, const ltm::ForgetSet& gone,
                                const ProgressSink& progress, const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Manifest manifest, ltm::read_manifest(store));
  if (manifest.models.empty()) return ltm::Erasures();
  ENGRAM_ASSIGN_OR_RETURN(const LearningModule* module, learning_module());
  return module->code_anew(store, gone, progress, stop);
}

Status test_model(const fs::path& file) {
  return model_loader()(file).status();
}

}  // namespace engram::cli

namespace engram {

// Takes the place of memory/model_loader.cpp, by which other programs link LibTorch directly.
ltm::ModelLoader model_loader() {
  return [](const std::filesystem::path& file) -> Result<ltm::LoadedModel> {
    ENGRAM_ASSIGN_OR_RETURN(const cli::LearningModule* const module, cli::learning_module());
    return module->load_model(file);
  };
}

}  // namespace engram
