// SPDX-License-Identifier: GPL-3.0-or-later
#include "runtime_kit.h"

#include <fstream>
#include <stdexcept>

#include "package/file_io.h"
#include "package/package_writer.h"

namespace kit {

namespace fs = std::filesystem;

namespace {

void check(ajar_runtime_result result) {
    if (result != AJAR_RUNTIME_OK) throw std::runtime_error(ajar_runtime_error_message());
}

} // namespace

Runtime::Runtime(const std::string& directory) { check(ajar_runtime_open(directory.c_str(), &handle_)); }

Runtime::~Runtime() { ajar_runtime_release(&handle_); }

uint32_t Runtime::element_count() const {
    uint32_t count = 0;
    check(ajar_runtime_element_count(handle_, &count));
    return count;
}

ajar_runtime_element Runtime::element(uint32_t index) const {
    ajar_runtime_element element;
    ajar_runtime_element_init(&element);
    check(ajar_runtime_get_element(handle_, index, &element));
    return element;
}

void Runtime::set_weight(uint32_t element, float weight) { check(ajar_runtime_set_weight(handle_, element, weight)); }

void Runtime::set_color(uint32_t element, float r, float g, float b) {
    const float color[3] = {r, g, b};
    check(ajar_runtime_set_color(handle_, element, color));
}

void Runtime::set_all(float weight) {
    for (uint32_t e = 0; e < element_count(); ++e) set_weight(e, weight);
}

ajar_runtime_stats Runtime::update() {
    ajar_runtime_stats stats;
    ajar_runtime_stats_init(&stats);
    check(ajar_runtime_update(handle_, &stats));
    return stats;
}

PageWords Runtime::page(uint32_t index) const {
    uint32_t width = 0, height = 0;
    const uint32_t *irradiance = nullptr, *direction = nullptr;
    check(ajar_runtime_page_size(handle_, index, &width, &height));
    check(ajar_runtime_page_texels(handle_, index, &irradiance, &direction));
    const size_t texels = size_t{width} * height;
    return {{irradiance, irradiance + texels}, {direction, direction + texels}};
}

std::vector<PageWords> Runtime::pages() const {
    uint32_t count = 0;
    check(ajar_runtime_page_count(handle_, &count));
    std::vector<PageWords> pages;
    for (uint32_t i = 0; i < count; ++i) pages.push_back(page(i));
    return pages;
}

PackageFolder::PackageFolder(const TermScene& scene) {
    std::string pattern = (fs::temp_directory_path() / "ajar_runtime_XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    root_ = pattern;
    ajar::write_package(scene.content, path());
}

PackageFolder::~PackageFolder() {
    std::error_code ignored;
    fs::remove_all(root_, ignored);
}

std::vector<uint8_t> PackageFolder::read(const std::string& name) const { return ajar::read_file(file(name)); }

void PackageFolder::write(const std::string& name, const std::vector<uint8_t>& bytes) const {
    std::ofstream out(file(name), std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

} // namespace kit
