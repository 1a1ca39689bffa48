// SPDX-License-Identifier: GPL-3.0-or-later
// Writes golden data: golden_make FOLDER [--fine N] [--tested N] [SCENE...], see README.md.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>

#include "golden_file.h"

namespace {

struct Options {
    std::string folder;
    uint32_t fine = 64, tested = 256; ///< bakes
    std::vector<std::string> scenes;
};

Options parse(int count, char** arguments) {
    Options o;
    for (int i = 1; i < count; ++i) {
        uint32_t* number = std::strcmp(arguments[i], "--fine") == 0     ? &o.fine
                           : std::strcmp(arguments[i], "--tested") == 0 ? &o.tested
                                                                        : nullptr;
        if (number != nullptr && i + 1 < count)
            *number = static_cast<uint32_t>(std::strtoul(arguments[++i], nullptr, 10));
        else if (o.folder.empty())
            o.folder = arguments[i];
        else
            o.scenes.emplace_back(arguments[i]);
    }
    if (o.scenes.empty()) o.scenes = golden::scene_names();
    return o;
}

/// Bakes count times. Seeds of golden bakes are even, those of tests odd: no bake is held against itself.
template <class Add>
void bake(const golden::GoldenScene& scene, const ajar_settings& settings, uint32_t count, uint32_t first, Add add) {
    const auto begin = std::chrono::steady_clock::now();
    for (uint32_t i = 0; i < count; ++i) add(golden::bake(scene, settings, 2 * (first + i)), i);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    std::printf("  %u bakes, %.2f s each\n", count, seconds.count() / count);
    std::fflush(stdout);
}

void make(const std::string& name, const Options& o) {
    std::printf("%s\n", name.c_str());
    const auto scene = golden::make_scene(name);
    golden::Measurement fine(*scene), tested(*scene);
    std::vector<golden::Measurement> groups(o.tested / golden::kGroup, golden::Measurement(*scene));
    bake(*scene, scene->tested, o.tested, 1, [&](const kit::Bake& b, uint32_t i) {
        tested.add(b);
        groups.at(i / golden::kGroup).add(b);
    });
    bake(*scene, scene->fine, o.fine, 100000, [&](const kit::Bake& b, uint32_t) { fine.add(b); });
    golden::write_golden(golden::join(fine, tested, groups), o.folder + "/" + name + ".txt");
}

} // namespace

int main(int count, char** arguments) {
    const Options o = parse(count, arguments);
    if (o.folder.empty() || o.fine < 2 || o.tested == 0 || o.tested % golden::kGroup != 0) {
        std::fprintf(stderr,
                     "usage: golden_make FOLDER [--fine N] [--tested N] [SCENE...]\n"
                     "--tested: a multiple of %u\n",
                     golden::kGroup);
        return 1;
    }
    try {
        for (const std::string& name : o.scenes) make(name, o);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "golden_make: %s\n", e.what());
        return 1;
    }
    return 0;
}
