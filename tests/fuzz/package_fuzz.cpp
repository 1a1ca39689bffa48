// SPDX-License-Identifier: GPL-3.0-or-later
#include "package_fuzz.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "../../native/runtime/terms_format.h"
#include "ajar_runtime.h"

namespace fs = std::filesystem;

namespace {

namespace terms = ajar::terms;

void mend_header(std::vector<uint8_t>& file) {
    if (file.size() < sizeof(terms::Header)) return;
    terms::Header header;
    std::memcpy(&header, file.data(), sizeof header);
    header.file_size = file.size();
    std::memcpy(file.data(), &header, sizeof header);
    header.checksum = terms::terms_checksum(file);
    std::memcpy(file.data(), &header, sizeof header);
}

/// A number from the fuzzer's bytes, of any kind a game might pass: also NaN and infinity.
float number(const std::vector<uint8_t>& bytes, size_t index) {
    float f = 0.0f;
    if (const size_t at = bytes.size() - 4 * (index % 8 + 1); bytes.size() >= 32) std::memcpy(&f, &bytes[at], 4);
    return f;
}

void read_pages(ajar_runtime runtime) {
    uint32_t pages = 0, width = 0, height = 0;
    ajar_runtime_page_count(runtime, &pages);
    for (uint32_t p = 0; p < pages; ++p) {
        if (ajar_runtime_page_size(runtime, p, &width, &height) != AJAR_RUNTIME_OK) continue;
        std::vector<float> light(size_t{3} * width * height);
        ajar_runtime_read_irradiance(runtime, p, 3, light.data(), light.size());
    }
}

void play(ajar_runtime runtime, const std::vector<uint8_t>& bytes) {
    uint32_t elements = 0;
    ajar_runtime_element_count(runtime, &elements);
    for (uint32_t e = 0; e < elements; ++e) {
        ajar_runtime_element about;
        ajar_runtime_element_init(&about);
        ajar_runtime_get_element(runtime, e, &about);
        ajar_runtime_set_weight(runtime, e, number(bytes, e));
    }
    ajar_runtime_update(runtime, nullptr);
    for (uint32_t e = 0; e < elements; e += 2) ajar_runtime_set_weight(runtime, e, 1.0f);
    ajar_runtime_update(runtime, nullptr);
    read_pages(runtime);
}

} // namespace

PackageFuzz::PackageFuzz(const std::string& seed) {
    for (const fs::directory_entry& f : fs::directory_iterator(seed)) fs::copy(f.path(), folder_.path());
}

bool PackageFuzz::run(const uint8_t* data, size_t size) const {
    std::vector<uint8_t> bytes(data, data + size);
    mend_header(bytes);
    {
        std::ofstream file(folder_.path() + "/terms.bin", std::ios::binary | std::ios::trunc);
        file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
    ajar_runtime runtime = nullptr;
    if (ajar_runtime_open(folder_.path().c_str(), &runtime) != AJAR_RUNTIME_OK) return false;
    play(runtime, bytes);
    ajar_runtime_release(&runtime);
    return true;
}
