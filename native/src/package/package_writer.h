// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>

#include "package/terms_file.h"

namespace ajar {

/// Writes the package to `directory`, whole or not at all: into a temporary sibling, then swapped
/// in. An older package there is replaced; files beside it that Ajar did not write (an engine's
/// import data) stay. A directory that is neither empty nor a package is refused. Throws Error:
/// AJAR_ERROR_ARGUMENT for arrays of wrong size, AJAR_ERROR_IO with path and remedy otherwise.
/// terms_file: what encode_terms gave for this content, where that was called before.
void write_package(const PackageContent& content, const std::filesystem::path& directory,
                   const TermsFile* terms_file = nullptr);

/// terms.bin, or nothing for a package without elements. Throws Error(AJAR_ERROR_ARGUMENT) for malformed terms.
std::optional<TermsFile> encode_terms(const PackageContent& content);

/// Writes those files of the package that the run-time library opens, byte for byte as write_package does, into an
/// empty folder. terms_file: of encode_terms, or null. Throws Error as write_package does.
void write_runtime_files(const PackageContent& content, const TermsFile* terms_file,
                         const std::filesystem::path& folder);

} // namespace ajar
