// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A temporary folder with a package, and an open runtime, for tests through ajar_runtime.h alone.

#include <filesystem>
#include <string>
#include <vector>

#include "ajar_runtime.h"
#include "terms_kit.h"

namespace kit {

/// Words of a page, top row first.
struct PageWords {
    std::vector<uint32_t> irradiance, direction;
    bool operator==(const PageWords&) const = default;
};

/// An open package; failures throw std::runtime_error with the library's message.
class Runtime {
public:
    explicit Runtime(const std::string& directory);
    ~Runtime();
    Runtime(const Runtime&) = delete;
    Runtime& operator=(const Runtime&) = delete;

    ajar_runtime handle() const { return handle_; }
    uint32_t element_count() const;
    ajar_runtime_element element(uint32_t index) const;
    void set_weight(uint32_t element, float weight);
    void set_color(uint32_t element, float r, float g, float b);
    void set_all(float weight);
    ajar_runtime_stats update();
    PageWords page(uint32_t index) const;
    std::vector<PageWords> pages() const;

private:
    ajar_runtime handle_ = nullptr;
};

/// A folder that is removed at the end, with the package of a scene in it.
class PackageFolder {
public:
    explicit PackageFolder(const TermScene& scene);
    ~PackageFolder();
    PackageFolder(const PackageFolder&) = delete;
    PackageFolder& operator=(const PackageFolder&) = delete;

    std::string path() const { return (root_ / "package").string(); }
    std::string file(const std::string& name) const { return (root_ / "package" / name).string(); }
    std::vector<uint8_t> read(const std::string& name) const;
    void write(const std::string& name, const std::vector<uint8_t>& bytes) const;

private:
    std::filesystem::path root_;
};

} // namespace kit
