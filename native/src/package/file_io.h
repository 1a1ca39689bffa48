// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace ajar {

/// Error(AJAR_ERROR_IO): what failed, the path, the system's reason and what the user can do.
[[noreturn]] void throw_io(const std::string& what, const std::filesystem::path& path, int error_number);

/// Writes a new file; synced: and forces it to the disk.
void write_file(const std::filesystem::path& path, std::span<const uint8_t> bytes, bool synced);
/// Writes a new file and forces it to the disk.
void write_file_synced(const std::filesystem::path& path, std::span<const uint8_t> bytes);
std::vector<uint8_t> read_file(const std::filesystem::path& path);

/// Fills a temporary sibling of `directory` through `fill`, then puts it in place in one step.
/// Whatever happens, `directory` holds either what it held before or all that fill wrote; the
/// temporary directory is removed on failure, and those of dead processes on the next call.
/// `accept_existing` is called for a directory already there, with the new one still apart; it
/// throws to refuse, and may carry files over.
void replace_directory(const std::filesystem::path& directory,
                       const std::function<void(const std::filesystem::path& temporary)>& fill,
                       const std::function<void(const std::filesystem::path& existing,
                                                const std::filesystem::path* temporary)>& accept_existing);

} // namespace ajar
