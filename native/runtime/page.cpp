// SPDX-License-Identifier: Apache-2.0
// Layout of DDS files: Microsoft, "Programming Guide for DDS" (DDS_HEADER and DDS_HEADER_DXT10).
#include "page.h"

#include <cmath>
#include <cstring>

#include "error.h"
#include "terms_format.h"
#include "texel.h"

namespace ajar::runtime {
namespace {

constexpr size_t kHeaderWords = 37;
constexpr uint32_t kMagic = 0x20534444u;                      // "DDS "
constexpr uint32_t kFourCcDx10 = 0x30315844u;                 // "DX10"
constexpr uint32_t kR11G11B10Float = 26, kR8G8B8A8Unorm = 28; // DXGI_FORMAT

constexpr uint32_t kScaleTag = 0x52414a41u; // "AJAR", before a float in the reserved words

struct Image {
    uint32_t width, height;
    uint32_t* words;
    float scale; ///< what 1 stands for
};

/// The image in an uncompressed 32 bit DDS file with a DX10 header and no mip maps.
Image find_image(FileView& file, uint32_t format, const std::string& path) {
    const auto refuse = [&](const char* why) {
        throw Error(AJAR_RUNTIME_ERROR_DATA,
                    "\"" + path + "\" is not a lightmap page: " + why + ". Bake or copy it again.");
    };
    uint32_t header[kHeaderWords];
    if (file.bytes().size() < sizeof header) refuse("it is cut short");
    std::memcpy(header, file.bytes().data(), sizeof header);
    if (header[0] != kMagic || header[1] != 124 || header[21] != kFourCcDx10) refuse("wrong header");
    if (header[32] != format) refuse("wrong texel format");
    const uint32_t height = header[3], width = header[4];
    if (width == 0 || height == 0 || width > 65536 || height > 65536) refuse("wrong size");
    if (file.bytes().size() != sizeof header + uint64_t{width} * height * 4) refuse("its length does not fit its size");
    float scale = 1.0f;
    if (header[8] == kScaleTag) std::memcpy(&scale, &header[9], sizeof scale);
    if (!(scale > 0.0f) || !std::isfinite(scale)) refuse("its scale is not a positive number");
    return {width, height, reinterpret_cast<uint32_t*>(file.bytes().data() + sizeof header), scale};
}

std::string page_path(const std::string& directory, size_t index, const char* rest) {
    return directory + "/page_" + std::to_string(index) + rest;
}

} // namespace

std::string Page::irradiance_path(const std::string& directory, size_t index) {
    return page_path(directory, index, ".irradiance.dds");
}

std::string Page::direction_path(const std::string& directory, size_t index) {
    return page_path(directory, index, ".direction.dds");
}

Page::Page(const std::string& directory, size_t index)
    : irradiance_file_(irradiance_path(directory, index)), direction_file_(direction_path(directory, index)) {
    const Image irradiance = find_image(irradiance_file_, kR11G11B10Float, irradiance_path(directory, index));
    const Image direction = find_image(direction_file_, kR8G8B8A8Unorm, direction_path(directory, index));
    if (irradiance.width != direction.width || irradiance.height != direction.height)
        throw Error(AJAR_RUNTIME_ERROR_DATA, "the two files of page " + std::to_string(index) + " differ in size");
    width_ = irradiance.width;
    height_ = irradiance.height;
    irradiance_ = irradiance.words;
    scale_ = irradiance.scale;
    direction_ = direction.words;
}

bool Page::matches(uint64_t irradiance_checksum, uint64_t direction_checksum) const {
    return terms::file_checksum(irradiance_file_.bytes()) == irradiance_checksum &&
           terms::file_checksum(direction_file_.bytes()) == direction_checksum;
}

void Page::read_irradiance(uint32_t channels, float* out) const {
    for (uint32_t y = height_; y-- > 0;) {
        const uint32_t* row = irradiance_ + size_t{y} * width_;
        for (uint32_t x = 0; x < width_; ++x, out += channels) {
            const Rgb e = unpack_irradiance(row[x]);
            out[0] = e.r * scale_;
            out[1] = e.g * scale_;
            out[2] = e.b * scale_;
            if (channels == 4) out[3] = 1.0f;
        }
    }
}

} // namespace ajar::runtime
