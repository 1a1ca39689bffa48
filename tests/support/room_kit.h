// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Small ready scenes and comparisons that several test files share.

#include "scene_kit.h"

namespace kit {

/// A white room of 4 x 4 x 3 m on one page, with a box in it and two point lights.
struct RoomOptions {
    uint32_t page_size = 48;
    bool committed = true;
};
void fill_room(Scene& scene, RoomOptions options = {});

/// Starts a bake without waiting.
ajar_job start(const Scene& scene, const ajar_settings& settings);
/// Settings of a bake that takes minutes, so that it is surely still running when looked at.
ajar_settings endless();
/// Settings of a bake that takes a fraction of a second.
ajar_settings quick();

/// Texts of all warnings of the scene, "culprit: text" each.
std::vector<std::string> scene_warnings(const Scene& scene);
/// Whether some warning names culprit and contains text.
bool has_warning(const std::vector<std::string>& warnings, const std::string& culprit, const std::string& text);

/// Difference of two measured numbers in units of their combined standard error.
double z_score(double a, double error_a, double b, double error_b);

/// Mean of one channel over the valid texels inside [x0,x1) x [y0,y1).
double mean(const Layer& layer, uint32_t channel = 0);
double mean(const Layer& layer, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, uint32_t channel = 0);
bool all_finite(const Layer& layer);

/// Result code, message and culprit of the last call, for failure messages.
std::string last_failure();

/// A folder of its own under the temporary directory, removed at the end.
class TempFolder {
public:
    TempFolder();
    ~TempFolder();
    TempFolder(const TempFolder&) = delete;
    std::string path(const std::string& name) const { return path_ + "/" + name; }
    const std::string& path() const { return path_; }
    /// Names of everything inside, sorted.
    std::vector<std::string> entries() const;

private:
    std::string path_;
};

std::string read_file(const std::string& path);

} // namespace kit
