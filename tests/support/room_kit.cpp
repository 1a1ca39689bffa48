// SPDX-License-Identifier: GPL-3.0-or-later
#include "room_kit.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace kit {

namespace fs = std::filesystem;

void fill_room(Scene& scene, RoomOptions options) {
    const uint32_t grey = scene.diffuse({0.7f, 0.6f, 0.5f});
    const uint32_t page = scene.page(options.page_size, options.page_size);
    scene.instance(scene.mesh(box({-2, -2, 0}, {2, 2, 3}, true)), grey, page, "room");
    scene.instance(scene.mesh(box({-0.5f, -0.5f, 0.0f}, {0.5f, 0.5f, 1.0f}, false)), grey, AJAR_NONE, "box");
    scene.point_light({1.0f, 0.5f, 2.5f}, 60.0f, 0.1f);
    scene.point_light({-1.2f, -1.0f, 1.5f}, 20.0f, 0.0f, true);
    if (options.committed) scene.commit();
}

ajar_job start(const Scene& scene, const ajar_settings& settings) {
    ajar_job job = nullptr;
    check(ajar_job_start(scene.handle(), &settings, &job));
    return job;
}

ajar_settings endless() {
    ajar_settings s = settings(16, 1u << 18);
    s.bounce_samples = 256;
    s.direct_samples = 1024;
    return s;
}

ajar_settings quick() {
    ajar_settings s = settings(2, 32);
    s.bounce_samples = 16;
    s.direct_samples = 8;
    s.positions_per_texel = 4;
    return s;
}

std::vector<std::string> scene_warnings(const Scene& scene) {
    uint32_t count = 0;
    check(ajar_scene_warning_count(scene.handle(), &count));
    std::vector<std::string> out;
    for (uint32_t i = 0; i < count; ++i) {
        char text[512], culprit[256];
        check(ajar_scene_warning(scene.handle(), i, text, sizeof(text), culprit, sizeof(culprit)));
        out.push_back(std::string(culprit) + ": " + text);
    }
    return out;
}

bool has_warning(const std::vector<std::string>& warnings, const std::string& culprit, const std::string& text) {
    return std::any_of(warnings.begin(), warnings.end(), [&](const std::string& w) {
        return w.rfind(culprit + ": ", 0) == 0 && w.find(text) != std::string::npos;
    });
}

double z_score(double a, double error_a, double b, double error_b) {
    return std::abs(a - b) / std::max(std::sqrt(error_a * error_a + error_b * error_b), 1e-30);
}

double mean(const Layer& layer, uint32_t channel) { return mean(layer, 0, 0, layer.width, layer.height, channel); }

double mean(const Layer& layer, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, uint32_t channel) {
    double sum = 0.0;
    for (uint32_t y = y0; y < y1; ++y)
        for (uint32_t x = x0; x < x1; ++x) sum += layer.at(x, y, channel);
    return sum / (double(x1 - x0) * double(y1 - y0));
}

bool all_finite(const Layer& layer) {
    return std::all_of(layer.data.begin(), layer.data.end(), [](float v) { return std::isfinite(v); });
}

std::string last_failure() { return std::string(ajar_error_message()) + " [" + ajar_error_culprit() + "]"; }

TempFolder::TempFolder() {
    std::string pattern = (fs::temp_directory_path() / "ajar_test_XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = pattern;
}

TempFolder::~TempFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

std::vector<std::string> TempFolder::entries() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(path_))
        names.push_back(fs::relative(entry.path(), path_).string());
    std::sort(names.begin(), names.end());
    return names;
}

std::string read_file(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

} // namespace kit
