// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

/// A folder for files that fuzzing writes by the thousand: in memory where the system offers that. Removed at the end.
class MemoryFolder {
public:
    MemoryFolder() {
        namespace fs = std::filesystem;
        const fs::path memory = "/dev/shm";
        path_ = ((fs::is_directory(memory) ? memory : fs::temp_directory_path()) / "ajar_fuzz_XXXXXX").string();
        if (::mkdtemp(path_.data()) == nullptr) throw std::runtime_error("cannot make a folder");
    }
    ~MemoryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    MemoryFolder(const MemoryFolder&) = delete;
    MemoryFolder& operator=(const MemoryFolder&) = delete;

    const std::string& path() const { return path_; }

private:
    std::string path_;
};
