// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "datasets/vault/vault_check.h"
#include "datasets/vault/vault_export.h"
#include "datasets/vault/vault_import.h"
#include "reports/plain/output.h"

namespace engram::reports {

// What was done with a vault, and what is in it. No key is ever printed.

[[nodiscard]] Json vault_export_json(const datasets::vault::VaultExportReport& report);
void print_vault_export(const datasets::vault::VaultExportReport& report,
                        const std::filesystem::path& vault, bool is_dry);

[[nodiscard]] Json vault_import_json(const datasets::vault::VaultImportReport& report);
void print_vault_import(const datasets::vault::VaultImportReport& report);

[[nodiscard]] Json vault_check_json(const datasets::vault::VaultCheckReport& report);
void print_vault_check(const datasets::vault::VaultCheckReport& report);

[[nodiscard]] Json vault_list_json(const datasets::vault::VaultKeys& keys);
void print_vault_list(const datasets::vault::VaultKeys& keys);

/// The days that are to be forgotten.
[[nodiscard]] Json vault_days_json(const datasets::vault::VaultKeys& keys,
                                   const std::vector<datasets::vault::EntityDay>& days);
void print_vault_days(const datasets::vault::VaultKeys& keys,
                      const std::vector<datasets::vault::EntityDay>& days);

}  // namespace engram::reports
