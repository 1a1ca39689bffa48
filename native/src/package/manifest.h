// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "package/texel_summary.h"

namespace ajar {

/// One page as the bake leaves it. All arrays are width * height texels, bottom row first, channels
/// interleaved; they stay owned by the caller while the package is written.
struct PackagePage {
    uint32_t width = 0, height = 0;
    std::span<const float> irradiance;           ///< 3 channels, W/m^2
    std::span<const float> stderr_;              ///< standard error of its luminance, W/m^2
    std::span<const float> samples;              ///< gather rays
    std::span<const float> validity;             ///< 1 valid, 0.75 outside its chart, 0.5 filled, 0 not covered
    std::span<const float> sh;                   ///< 27 channels, coefficient-major RGB; empty if not kept
    std::span<const uint32_t> packed_irradiance; ///< R11G11B10F, of irradiance over the scale
    std::span<const uint32_t> packed_direction;  ///< RGBA8, r in the low byte
};

/// A lightmapped object: page UV = uv * uv_scale + uv_offset.
struct PackageInstance {
    std::string name;
    uint32_t page = 0;
    float uv_scale[2] = {1.0f, 1.0f};
    float uv_offset[2] = {0.0f, 0.0f};
    std::string uv_layer = "AjarLightmap";
    bool back = false; ///< its lightmap is of the side that the normals point away from
};

struct PackageLight {
    std::string name;
    std::string role;           ///< "primary" or "static"
    std::string light_set = {}; ///< name, or empty
};

/// A light set, door or toggle; terms name elements by their index.
struct PackageElement {
    std::string name;
    std::string kind;    ///< "light_set", "door" or "toggle"
    float weight = 1.0f; ///< at the start

    /// What the element multiplies the light of its terms by at weight w (terms::element_variable).
    float variable(float w) const;
};
/// terms::Kind as a number. Throws Error(AJAR_ERROR_ARGUMENT) if it is none.
uint32_t element_kind(const PackageElement& element);

/// Baked light of a product of elements, at the texels that keep it. The base is no term here: the
/// pages hold it. Arrays stay owned by the caller while the package is written.
struct PackageTerm {
    std::vector<uint32_t> elements;      ///< ascending, never empty
    bool is_signed = false;              ///< some irradiance is negative
    float relative_error = 0.0f;         ///< standard error of the mean term at a texel, relative
    float discarded = 0.0f;              ///< share of its light at texels that do not keep it
    std::span<const uint32_t> texel;     ///< ascending index over all pages' texels, page after page, bottom row first
    std::span<const float> irradiance;   ///< [count][3], W/m^2 along the shading normal
    std::span<const uint32_t> direction; ///< [count] RGBA8 as in packed_direction, of irradiance / its sign
};

inline constexpr const char* kLightPatchesFile = "patches.json"; ///< beside manifest.json

/// Whether the layout of semi-dynamic light maps is written beside terms.bin (light_patches.h), and
/// how many planes the maps of light sets have there: luminance with one colour per set, or RGB.
enum class LightPatchPlanes : uint32_t { none = 0, one = 1, three = 2 };

/// All that a package holds.
struct PackageContent {
    std::string name;
    std::string extras; ///< JSON object as text, or empty
    std::vector<PackagePage> pages;
    std::vector<PackageInstance> instances;
    std::vector<PackageLight> lights;
    std::vector<PackageElement> elements;
    std::vector<PackageTerm> terms;
    float scale = 1.0f; ///< W/m^2 that 1 in packed irradiance stands for, a power of two
    LightPatchPlanes light_patches = LightPatchPlanes::none;
    bool overlap_pictures = false; ///< whether pictures of what texels take are written (overlap_picture.h)
    double discarded = 0.0;        ///< share of all terms' light at texels that do not keep it
    std::string self_check = {};   ///< JSON object as text: what brute force said of this package; or empty
};

/// Dispatches of one class of terms.bin (native/runtime/terms_format.h).
struct ClassSummary {
    uint64_t dispatches = 0, receivers = 0, entries = 0, bytes = 0;
};

/// A term as it is stored.
struct TermSummary {
    bool is_signed = false;
    float scale = 1.0f; ///< stored values times this are W/m^2
    uint64_t texels = 0, bytes = 0;
};

/// Texels that an element reaches, and the bytes of all terms that it is part of.
struct ElementSummary {
    uint64_t texels = 0, bytes = 0;
};

/// What terms.bin holds, for the manifest.
struct TermsSummary {
    ClassSummary classes[5]; ///< U, Q, V8, V16, B
    std::vector<TermSummary> terms;
    std::vector<ElementSummary> elements;
    uint64_t bytes = 0;          ///< size of the file
    double wasted_updates = 1.0; ///< receivers updated over those that need it, elements changing one at a time
    TexelSummary texels;
};

/// File names of a page's images, e.g. "page_0.irradiance.exr".
struct PageFiles {
    explicit PageFiles(size_t page);
    std::string irradiance, quality, sh, packed_irradiance, packed_direction, direction_png, overlap, bytes;
};

/// Hash of the pages' sizes and texels, of the instances and of the elements' terms, e.g. "ajar64:0123456789abcdef".
/// Equal for equal content, whatever the image library's compression does.
std::string content_hash(const PackageContent& content);

/// manifest.json (schemas/manifest.schema.json). terms is null for a package without elements.
/// Throws Error(AJAR_ERROR_ARGUMENT) if extras is not a JSON object.
std::string manifest_json(const PackageContent& content, const TermsSummary* terms);

/// True if the text is a manifest that some version of Ajar wrote.
bool is_ajar_manifest(std::span<const uint8_t> text);

} // namespace ajar
