// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

#include "cli/command.h"
#include "ltm/forgetting/erasure.h"
#include "ltm/forgetting/fade_report.h"
#include "ltm/recall/model.h"
#include "speech/attention/attention_reader.h"

namespace engram::cli {

/// What the program takes from `engram-learning.so`, which is linked with LibTorch and lies beside
/// the program. Loading LibTorch takes a third of a second of processor time, so it is loaded when
/// a model is opened or a command learns, and not before.
///
/// The module holds the rooms that learn, and takes all other rooms from the program: there is one
/// log, one lock around HDF5 and one of every other thing that a process has once.
struct LearningModule {
  using AddCommand = void (*)(CLI::App& app, ExitCode& exit_code);

  /// Version and compiler that it was built with: module_build(). It stays the first member in all
  /// versions, because it is compared before any other is read.
  const char* build;
  /// An ltm::ModelLoader.
  Result<ltm::LoadedModel> (*load_model)(const std::filesystem::path& file);
  AddCommand add_consolidate_command;
  AddCommand add_crossval_command;
  AddCommand add_eval_command;
  AddCommand add_learn_answers_command;
  AddCommand add_learn_sights_command;
  AddCommand add_notice_sights_command;
  /// speech::load_attention.
  Result<std::unique_ptr<speech::AttentionNetwork>> (*load_attention)(
      const std::filesystem::path& file);
  /// An ltm::Fade.
  Result<ltm::FadeReport> (*fade)(const std::filesystem::path& store, const ltm::FadeSet& what,
                                  const ProgressSink& progress, const std::stop_token& stop);
  /// An ltm::CodeAnew.
  Result<ltm::Erasures> (*code_anew)(const std::filesystem::path& store, const ltm::ForgetSet& gone,
                                     const ProgressSink& progress, const std::stop_token& stop);
};

/// What LearningModule::build has to be.
[[nodiscard]] constexpr const char* module_build() {
  return ENGRAM_VERSION ", " __VERSION__;
}

/// Loads the module when it is called first.
/// Errors: kFailedPrecondition naming the file if it is missing, cannot be loaded or is of another
/// build. All calls return the same.
/// Threading: thread-safe.
[[nodiscard]] Result<const LearningModule*> learning_module();

/// Whether the models of a store can be tested. A model that merely cannot be loaded must not be
/// taken for a damaged one.
/// Errors: those of learning_module() if the store has models.
[[nodiscard]] Status ready_for_models(const std::filesystem::path& store);

/// Codes anew what is to stay when something is erased. An ltm::CodeAnew, which loads the module
/// only if the store has models. Errors: those of learning_module() and of training::code_anew.
Result<ltm::Erasures> code_anew(const std::filesystem::path& store, const ltm::ForgetSet& gone,
                                const ProgressSink& progress, const std::stop_token& stop);

/// Tests that a model file decodes as it did when it was written. An ltm::ModelTest.
/// Errors: those of learning_module() and of encoders::load_model.
[[nodiscard]] Status test_model(const std::filesystem::path& file);

}  // namespace engram::cli
