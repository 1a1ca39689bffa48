// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "package/manifest.h"

namespace ajar {

/// Writes the package to `directory`, whole or not at all: into a temporary sibling, then swapped
/// in. An older package there is replaced; files beside it that Ajar did not write (an engine's
/// import data) stay. A directory that is neither empty nor a package is refused. Throws Error:
/// AJAR_ERROR_ARGUMENT for arrays of wrong size, AJAR_ERROR_IO with path and remedy otherwise.
void write_package(const PackageContent& content, const std::filesystem::path& directory);

/// Writes those files of the package that the run-time library opens, byte for byte as write_package does, into an
/// empty folder. Throws Error as write_package does.
void write_runtime_files(const PackageContent& content, const std::filesystem::path& folder);

} // namespace ajar
