// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace ajar::runtime {

/// The bytes of a file, mapped where the system can, read otherwise. Writes stay private: they
/// change the view, never the file, and cost memory only for what they touch.
class FileView {
public:
    FileView() = default;
    /// Throws Error(AJAR_RUNTIME_ERROR_IO) if the file cannot be opened or read. may_map = false reads
    /// it even where it could be mapped.
    explicit FileView(const std::string& path, bool may_map = true);
    ~FileView();
    FileView(FileView&& other) noexcept;
    FileView& operator=(FileView&& other) noexcept;

    std::span<uint8_t> bytes() { return {data_, size_}; }
    std::span<const uint8_t> bytes() const { return {data_, size_}; }

private:
    void read(int file, const std::string& path);

    uint8_t* data_ = nullptr; ///< aligned to 16 bytes at least
    size_t size_ = 0;
    bool mapped_ = false;
    std::vector<uint64_t> copy_; ///< where the file is not mapped
};

bool file_exists(const std::string& path);

} // namespace ajar::runtime
