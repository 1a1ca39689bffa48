// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/package_writer.h"

#include <algorithm>

#include "base/error.h"
#include "package/dds.h"
#include "package/file_io.h"
#include "package/image_io.h"
#include "package/light_patches.h"
#include "package/overlap_picture.h"
#include "runtime/terms_format.h"

namespace ajar {
namespace {

namespace fs = std::filesystem;

constexpr const char* kManifest = "manifest.json";

void check_page(const PackagePage& page, size_t index) {
    const size_t texels = size_t(page.width) * page.height;
    const bool floats = page.irradiance.size() == 3 * texels && page.stderr_.size() == texels &&
                        page.samples.size() == texels && page.validity.size() == texels;
    const bool words = page.packed_irradiance.size() == texels && page.packed_direction.size() == texels;
    const bool sh = page.sh.empty() || page.sh.size() == 27 * texels;
    if (texels == 0 || !floats || !words || !sh)
        throw Error(AJAR_ERROR_ARGUMENT, "Page " + std::to_string(index) + " of the package has a layer of wrong size");
}

std::vector<uint8_t> encode_quality(const PackagePage& page) {
    std::vector<float> data;
    data.reserve(page.stderr_.size() * 3);
    for (size_t i = 0; i < page.stderr_.size(); ++i)
        data.insert(data.end(), {page.stderr_[i], page.samples[i], page.validity[i]});
    return encode_exr(page.width, page.height, {"stderr", "samples", "validity"}, data);
}

std::vector<std::string> sh_channels() {
    std::vector<std::string> names;
    for (int c = 0; c < 9; ++c)
        for (const char* color : {".R", ".G", ".B"}) names.push_back("sh" + std::to_string(c) + color);
    return names;
}

std::vector<uint8_t> irradiance_dds(const PackagePage& page, float scale) {
    return encode_dds(page.width, page.height, DdsFormat::kR11G11B10Float, page.packed_irradiance, scale);
}

std::vector<uint8_t> direction_dds(const PackagePage& page) {
    return encode_dds(page.width, page.height, DdsFormat::kR8G8B8A8Unorm, page.packed_direction);
}

void write_packed(const PackagePage& page, size_t index, float scale, const fs::path& folder, bool synced) {
    const PageFiles files(index);
    write_file(folder / files.packed_irradiance, irradiance_dds(page, scale), synced);
    write_file(folder / files.packed_direction, direction_dds(page), synced);
}

void write_page(const PackagePage& page, size_t index, float scale, const fs::path& folder) {
    const PageFiles files(index);
    const uint32_t w = page.width, h = page.height;
    write_file_synced(folder / files.irradiance, encode_exr(w, h, {"R", "G", "B"}, page.irradiance));
    write_file_synced(folder / files.quality, encode_quality(page));
    if (!page.sh.empty()) write_file_synced(folder / files.sh, encode_exr(w, h, sh_channels(), page.sh));
    write_packed(page, index, scale, folder, true);
    write_file_synced(folder / files.direction_png, encode_png(w, h, page.packed_direction));
}

/// Pictures of how many terms, and bytes of terms.bin, the texels of all pages take.
void write_overlap(const PackageContent& content, const TermsFile& file, const fs::path& folder) {
    size_t first = 0;
    for (size_t i = 0; i < content.pages.size(); ++i) {
        const PackagePage& page = content.pages[i];
        const size_t texels = size_t{page.width} * page.height;
        const PageFiles files(i);
        const auto write = [&](const std::string& name, const std::vector<uint32_t>& values, uint32_t unit) {
            const auto colors = overlap_picture(std::span(values).subspan(first, texels), unit);
            write_file_synced(folder / name, encode_png(page.width, page.height, colors));
        };
        write(files.overlap, file.texel_terms, kTermsUnit);
        write(files.bytes, file.texel_bytes, kBytesUnit);
        first += texels;
    }
}

void write_text(const fs::path& path, const std::string& text) {
    write_file_synced(path, {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

void write_light_patches(const PackageContent& content, const fs::path& folder) {
    const LightPatches patches = make_light_patches(content, content.light_patches);
    for (size_t a = 0; a < patches.atlases.size(); ++a)
        write_file_synced(folder / atlas_file(a), encode_dds(patches.atlases[a].width, patches.atlases[a].height,
                                                             DdsFormat::kR16G16B16A16Float, patches.texels[a]));
    write_text(folder / kLightPatchesFile, light_patches_json(content, patches));
}

/// The place of the dot in "<stem><number>.<rest>"; npos for other names.
size_t dot_after_number(const std::string& name, const std::string& stem) {
    const size_t dot = name.find('.');
    const bool fits = dot != std::string::npos && dot > stem.size() && name.rfind(stem, 0) == 0 &&
                      std::all_of(name.begin() + long(stem.size()), name.begin() + long(dot),
                                  [](char c) { return c >= '0' && c <= '9'; });
    return fits ? dot : std::string::npos;
}

/// "page_<number>.<rest>", light patches, the terms and the manifest are Ajar's; everything else is someone else's.
bool is_own_file(const std::string& name) {
    if (name == kManifest || name == terms::kFileName || name == kLightPatchesFile) return true;
    const size_t atlas_dot = dot_after_number(name, "patches_");
    if (atlas_dot != std::string::npos) return name.substr(atlas_dot) == ".dds";
    const size_t dot = dot_after_number(name, "page_");
    if (dot == std::string::npos) return false;
    const PageFiles files(0);
    const std::string rest = "page_0" + name.substr(dot);
    return rest == files.irradiance || rest == files.quality || rest == files.sh || rest == files.packed_irradiance ||
           rest == files.packed_direction || rest == files.direction_png || rest == files.overlap ||
           rest == files.bytes;
}

/// Refuses to replace what is not a package.
void check_replaceable(const fs::path& existing) {
    const auto refuse = [&](const std::string& why) {
        throw Error(AJAR_ERROR_IO,
                    "Will not replace \"" + existing.string() + "\": " + why +
                        ". Choose another output folder or empty this one.",
                    existing.string());
    };
    if (!fs::is_directory(existing)) refuse("it is a file, not a folder");
    if (fs::is_empty(existing)) return;
    const fs::path manifest = existing / kManifest;
    if (!fs::is_regular_file(manifest)) refuse("it holds files but no Ajar package (no manifest.json)");
    if (!is_ajar_manifest(read_file(manifest))) refuse("its manifest.json was not written by Ajar");
}

/// Hard links (or copies) foreign files of the old package into the new one.
void carry_over(const fs::path& existing, const fs::path& temporary) {
    for (const fs::directory_entry& entry : fs::directory_iterator(existing)) {
        const std::string name = entry.path().filename().string();
        if (is_own_file(name)) continue;
        std::error_code failed;
        const auto options = fs::copy_options::recursive | fs::copy_options::copy_symlinks;
        fs::copy(entry.path(), temporary / name, options | fs::copy_options::create_hard_links, failed);
        if (failed) fs::copy(entry.path(), temporary / name, options | fs::copy_options::overwrite_existing);
    }
}

} // namespace

std::optional<TermsFile> encode_terms(const PackageContent& content) {
    if (content.elements.empty() && content.terms.empty()) return std::nullopt;
    std::vector<PageChecksums> sums;
    for (const PackagePage& page : content.pages)
        sums.push_back(
            {terms::file_checksum(irradiance_dds(page, content.scale)), terms::file_checksum(direction_dds(page))});
    return make_terms_file(content, sums);
}

void write_runtime_files(const PackageContent& content, const TermsFile* terms_file, const fs::path& folder) {
    for (size_t i = 0; i < content.pages.size(); ++i) {
        check_page(content.pages[i], i);
        write_packed(content.pages[i], i, content.scale, folder, false);
    }
    if (terms_file != nullptr) write_file(folder / terms::kFileName, terms_file->bytes, false);
}

void write_package(const PackageContent& content, const fs::path& directory, const TermsFile* terms_file) {
    for (size_t i = 0; i < content.pages.size(); ++i) check_page(content.pages[i], i);
    std::optional<TermsFile> made;
    if (terms_file == nullptr) made = encode_terms(content);
    if (made) terms_file = &*made;
    const std::string manifest = manifest_json(content, terms_file != nullptr ? &terms_file->summary : nullptr);
    const auto fill = [&](const fs::path& folder) {
        for (size_t i = 0; i < content.pages.size(); ++i) write_page(content.pages[i], i, content.scale, folder);
        if (terms_file != nullptr) write_file_synced(folder / terms::kFileName, terms_file->bytes);
        if (terms_file != nullptr && content.overlap_pictures) write_overlap(content, *terms_file, folder);
        if (content.light_patches != LightPatchPlanes::none) write_light_patches(content, folder);
        write_text(folder / kManifest, manifest);
    };
    const auto accept_existing = [&](const fs::path& existing, const fs::path* temporary) {
        if (temporary)
            carry_over(existing, *temporary);
        else
            check_replaceable(existing);
    };
    replace_directory(directory, fill, accept_existing);
}

} // namespace ajar
