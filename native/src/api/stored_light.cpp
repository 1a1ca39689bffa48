// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/stored_light.h"

#include <stdlib.h>

#include <cerrno>
#include <filesystem>

#include "base/error.h"
#include "base/math.h"
#include "package/file_io.h"
#include "package/package_writer.h"
#include "runtime/texel.h"

namespace ajar {

namespace {

namespace fs = std::filesystem;

/// A new folder among the system's temporary files, removed with all it holds when the scope ends.
class ScratchFolder {
public:
    ScratchFolder() {
        std::error_code failed;
        const fs::path parent = fs::temp_directory_path(failed);
        if (failed) throw Error(AJAR_ERROR_IO, "there is no folder for temporary files: " + failed.message());
        std::string name = (parent / "ajar-check-XXXXXX").string();
        if (::mkdtemp(name.data()) == nullptr) throw_io("create", name, errno);
        path_ = name;
    }
    ~ScratchFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

void require(ajar_runtime_result result) {
    if (result == AJAR_RUNTIME_ERROR_MEMORY) throw std::bad_alloc();
    if (result != AJAR_RUNTIME_OK)
        throw Error(AJAR_ERROR_INTERNAL, std::string("the run-time library says: ") + ajar_runtime_error_message());
}

} // namespace

// The files are gone when this returns: the library has mapped or read what it needs.
StoredLight::StoredLight(const PackageContent& content, const TermsFile* terms_file) {
    const ScratchFolder folder;
    write_runtime_files(content, terms_file, folder.path());
    require(ajar_runtime_open(folder.path().c_str(), &runtime_));
}

StoredLight::~StoredLight() {
    if (runtime_ != nullptr) ajar_runtime_release(&runtime_);
}

void StoredLight::set_weights(const std::vector<float>& weights) {
    for (uint32_t e = 0; e < weights.size(); ++e) require(ajar_runtime_set_weight(runtime_, e, weights[e]));
    require(ajar_runtime_update(runtime_, nullptr));
}

float StoredLight::light(uint32_t page, uint32_t x, uint32_t y) const {
    uint32_t width = 0, height = 0;
    const uint32_t *irradiance = nullptr, *direction = nullptr;
    require(ajar_runtime_page_size(runtime_, page, &width, &height));
    require(ajar_runtime_page_texels(runtime_, page, &irradiance, &direction));
    if (x >= width || y >= height) throw Error(AJAR_ERROR_INTERNAL, "the package lacks a texel");
    const runtime::Rgb e = runtime::unpack_irradiance(irradiance[size_t{height - 1 - y} * width + x]);
    return luminance({e.r, e.g, e.b});
}

} // namespace ajar
