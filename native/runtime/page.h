// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "file_view.h"

namespace ajar::runtime {

/// A lightmap page: the words of its two DDS files in memory, top row first, free to be changed.
class Page {
public:
    /// Page number `index` of the package in a directory. Throws Error: AJAR_RUNTIME_ERROR_IO, or
    /// AJAR_RUNTIME_ERROR_DATA for a file that is not such a DDS image.
    Page(const std::string& directory, size_t index);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    uint32_t* irradiance() { return irradiance_; }
    uint32_t* direction() { return direction_; }
    /// W/m^2 that 1 in the irradiance words stands for.
    float scale() const { return scale_; }
    /// Whether the files are those that a bake wrote (terms_format.h, file_checksum).
    bool matches(uint64_t irradiance_checksum, uint64_t direction_checksum) const;
    /// Irradiance in W/m^2, bottom row first; channels is 3 or 4 (alpha 1).
    void read_irradiance(uint32_t channels, float* out) const;

    static std::string irradiance_path(const std::string& directory, size_t index);
    static std::string direction_path(const std::string& directory, size_t index);

private:
    FileView irradiance_file_, direction_file_;
    uint32_t width_ = 0, height_ = 0;
    uint32_t* irradiance_ = nullptr;
    uint32_t* direction_ = nullptr;
    float scale_ = 1.0f;
};

} // namespace ajar::runtime
