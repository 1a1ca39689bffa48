// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A scene that is told in metres and watts and built at another scale, far away, or under stronger light.

#include "scene_kit.h"

namespace kit {

/// How a scene is built. Light arrives times light, whatever the scale: lamps grow with the scene.
struct Variant {
    const char* name = "as it is";
    float scale = 1.0f;
    double away = 0.0; ///< m along each axis, after scaling
    double light = 1.0;
    uint32_t threads = 1;
};

inline constexpr std::array<double, 9> kUpright = {1, 0, 0, 0, 1, 0, 0, 0, 1};

class Stage {
public:
    explicit Stage(const Variant& variant) : variant_(variant) {}

    Scene scene;
    /// A lightmapped object on a page of its own, or an occluder for size 0; returns the page.
    uint32_t object(MeshData mesh, uint32_t material, uint32_t page_size = 0, const char* name = "object");
    /// The same, mirrored, sheared or turned about the origin by a row-major 3x3 matrix.
    uint32_t object(MeshData mesh, uint32_t material, uint32_t page_size, const char* name,
                    const std::array<double, 9>& turned);
    uint32_t emitter(Float3 radiance, float albedo = 0.0f);
    /// Lets a share of light through, reflects a share and glows.
    uint32_t pane(Float3 transmittance, float albedo = 0.0f, double radiance = 0.0);
    uint32_t black() { return scene.diffuse({0, 0, 0}); }
    /// An element that the next objects (toggle, door) or lamps (set) belong to, until release().
    uint32_t toggle(const std::string& name, float presence = 1.0f);
    uint32_t door(const std::string& name, float openness = 1.0f);
    uint32_t set(const std::string& name);
    void release() { scene.current_switch = scene.current_set = AJAR_NONE; }
    void point(Float3 position, double watts, float radius = 0.0f);
    void spot(Float3 position, double watts, float angle);
    /// Sun that stands the given angle above the horizon, in the direction of x; W/m^2.
    void sun(double elevation, double strength);
    /// Any lamp; its axes are the columns of a row-major 3x3 matrix. Energies and sizes as in the other calls.
    void light(ajar_light_desc desc, Float3 position, const std::array<double, 9>& axes = kUpright);
    void sky(double radiance);
    /// A lamp to fill in.
    static ajar_light_desc lamp(uint32_t type, double energy, uint32_t role = AJAR_ROLE_STATIC);
    /// Irradiance of a page over the light factor.
    Layer irradiance(const Bake& bake, uint32_t page) const;
    /// Irradiance at a state: weights by element, times the terms of the polynomial in them.
    Layer state(const Bake& bake, const std::vector<float>& weights, uint32_t size, uint32_t page) const;
    Layer term(const Bake& bake, uint32_t index, uint32_t size, uint32_t page) const;
    Layer divided(Layer layer) const;
    /// Settings with the variant's threads.
    ajar_settings settings(uint32_t bounces, uint32_t samples) const;

private:
    std::array<double, 12> at(Float3 position, const std::array<double, 9>& axes = kUpright) const;

    Variant variant_;
};

} // namespace kit
