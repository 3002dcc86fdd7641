// SPDX-License-Identifier: Apache-2.0
// What engram-learning.so exports.
#include "cli/learning_module.h"
#include "encoders/load_model.h"
#include "speech/learning/attention_file.h"
#include "training/fade/erase.h"
#include "training/fade/fade.h"

extern "C" {

extern const engram::cli::LearningModule engram_learning_module;

const engram::cli::LearningModule engram_learning_module{engram::cli::module_build(),
                                                         engram::encoders::load_model,
                                                         engram::cli::add_consolidate_command,
                                                         engram::cli::add_crossval_command,
                                                         engram::cli::add_eval_command,
                                                         engram::cli::add_learn_answers_command,
                                                         engram::cli::add_learn_sights_command,
                                                         engram::cli::add_notice_sights_command,
                                                         engram::speech::load_attention,
                                                         engram::training::fade,
                                                         engram::training::code_anew};

}  // extern "C"
