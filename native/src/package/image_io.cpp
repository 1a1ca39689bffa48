// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstring>

#include "base/error.h"

namespace ajar {
namespace {

using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::stride_t;
using OIIO::TypeDesc;

/// Encodes bottom-up rows; negative strides make OpenImageIO walk them from the top.
std::vector<uint8_t> encode(const char* format, const ImageSpec& spec, TypeDesc type, const void* data,
                            size_t row_bytes) {
    const std::string name = std::string("image.") + format; // chooses the format; no such file is made
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const std::unique_ptr<ImageOutput> output = ImageOutput::create(name);
    if (!output || !output->supports("ioproxy"))
        throw Error(AJAR_ERROR_INTERNAL, std::string("OpenImageIO was built without writing ") + format + " to memory");
    ImageSpec full = spec;
    void* proxy = &memory;
    full.attribute("oiio:ioproxy", TypeDesc::PTR, &proxy);
    const auto* top = static_cast<const uint8_t*>(data) + row_bytes * size_t(spec.height - 1);
    bool good = output->open(name, full);
    good = good && output->write_image(type, top, OIIO::AutoStride, -static_cast<stride_t>(row_bytes));
    good = output->close() && good;
    if (!good) throw Error(AJAR_ERROR_IO, std::string("Encoding ") + format + " failed: " + output->geterror());
    return bytes;
}

/// Opens by the plug-in's own open: ImageInput::open would look for the name on the disk.
std::unique_ptr<ImageInput> open_memory(const char* format, OIIO::Filesystem::IOMemReader& memory,
                                        const std::string& name) {
    ImageSpec config, spec;
    config.attribute("oiio:UnassociatedAlpha", 1);
    std::unique_ptr<ImageInput> input = ImageInput::create(format);
    if (!input || !input->set_ioproxy(&memory) || !input->open(std::string("image.") + format, spec, config))
        throw Error(AJAR_ERROR_IO, "\"" + name + "\" cannot be read: " + (input ? input->geterror() : OIIO::geterror()),
                    name);
    return input;
}

void read_rows(ImageInput& input, TypeDesc type, void* data, size_t row_bytes, const std::string& name) {
    const ImageSpec& spec = input.spec();
    auto* top = static_cast<uint8_t*>(data) + row_bytes * size_t(spec.height - 1);
    if (!input.read_image(0, 0, 0, spec.nchannels, type, top, OIIO::AutoStride, -static_cast<stride_t>(row_bytes)))
        throw Error(AJAR_ERROR_IO, "\"" + name + "\" cannot be read: " + input.geterror(), name);
}

} // namespace

std::vector<uint8_t> encode_exr(uint32_t width, uint32_t height, const std::vector<std::string>& channels,
                                std::span<const float> data) {
    if (width == 0 || height == 0 || channels.empty() || data.size() != size_t(width) * height * channels.size())
        throw Error(AJAR_ERROR_ARGUMENT, "EXR image size and data size differ");
    ImageSpec spec(int(width), int(height), int(channels.size()), TypeDesc::FLOAT);
    spec.channelnames = channels;
    spec.alpha_channel = -1;
    spec.attribute("compression", "zip");
    spec.attribute("oiio:ColorSpace", "Linear");
    spec.attribute("Software", "Ajar");
    // The library would write the time of day; equal bakes must give equal files.
    spec.attribute("DateTime", "1970:01:01 00:00:00");
    return encode("exr", spec, TypeDesc::FLOAT, data.data(), size_t(width) * channels.size() * sizeof(float));
}

FloatImage decode_exr(std::span<const uint8_t> bytes, const std::string& name) {
    OIIO::Filesystem::IOMemReader memory(const_cast<uint8_t*>(bytes.data()), bytes.size());
    const auto input = open_memory("exr", memory, name);
    const ImageSpec& spec = input->spec();
    FloatImage image{uint32_t(spec.width), uint32_t(spec.height), spec.channelnames, {}};
    image.data.resize(size_t(spec.width) * size_t(spec.height) * size_t(spec.nchannels));
    read_rows(*input, TypeDesc::FLOAT, image.data.data(), size_t(spec.width) * size_t(spec.nchannels) * sizeof(float),
              name);
    return image;
}

std::vector<uint8_t> encode_png(uint32_t width, uint32_t height, std::span<const uint32_t> texels) {
    if (width == 0 || height == 0 || texels.size() != size_t(width) * height)
        throw Error(AJAR_ERROR_ARGUMENT, "PNG image size and texel count differ");
    std::vector<uint8_t> rgba(texels.size() * 4);
    for (size_t i = 0; i < texels.size(); ++i)
        for (size_t c = 0; c < 4; ++c) rgba[4 * i + c] = static_cast<uint8_t>(texels[i] >> (8 * c));
    ImageSpec spec(int(width), int(height), 4, TypeDesc::UINT8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    return encode("png", spec, TypeDesc::UINT8, rgba.data(), size_t(width) * 4);
}

std::vector<uint32_t> decode_png(std::span<const uint8_t> bytes, const std::string& name, uint32_t& width,
                                 uint32_t& height) {
    OIIO::Filesystem::IOMemReader memory(const_cast<uint8_t*>(bytes.data()), bytes.size());
    const auto input = open_memory("png", memory, name);
    const ImageSpec& spec = input->spec();
    if (spec.nchannels != 4) throw Error(AJAR_ERROR_IO, "\"" + name + "\" is not an RGBA image", name);
    width = uint32_t(spec.width);
    height = uint32_t(spec.height);
    std::vector<uint8_t> rgba(size_t(width) * height * 4);
    read_rows(*input, TypeDesc::UINT8, rgba.data(), size_t(width) * 4, name);
    std::vector<uint32_t> texels(size_t(width) * height);
    for (size_t i = 0; i < texels.size(); ++i)
        for (size_t c = 0; c < 4; ++c) texels[i] |= uint32_t(rgba[4 * i + c]) << (8 * c);
    return texels;
}

} // namespace ajar
