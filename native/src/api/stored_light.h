// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "ajar_runtime.h"
#include "package/terms_file.h"

namespace ajar {

/// The light of a package as a game gets it: its files, written to a folder of their own, opened and updated by the
/// run-time library. What storage loses is lost here too.
class StoredLight {
public:
    /// terms_file: of a content with elements. Throws Error: AJAR_ERROR_IO where there is no room for the files,
    /// AJAR_ERROR_INTERNAL for a package that the run-time library refuses.
    StoredLight(const PackageContent& content, const TermsFile* terms_file);
    ~StoredLight();
    StoredLight(const StoredLight&) = delete;
    StoredLight& operator=(const StoredLight&) = delete;

    /// Brings the pages up to weights, one per element.
    void set_weights(const std::vector<float>& weights);
    /// Luminance of the irradiance at a texel, W/m^2; row 0 is the bottom one.
    float light(uint32_t page, uint32_t x, uint32_t y) const;

private:
    ajar_runtime runtime_ = nullptr;
};

} // namespace ajar
