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

class Stage {
public:
    explicit Stage(const Variant& variant) : variant_(variant) {}

    Scene scene;
    /// A lightmapped object on a page of its own, or an occluder for size 0; returns the page.
    uint32_t object(MeshData mesh, uint32_t material, uint32_t page_size = 0, const char* name = "object");
    uint32_t emitter(Float3 radiance);
    void point(Float3 position, double watts, float radius = 0.0f);
    void spot(Float3 position, double watts, float angle);
    /// Sun that stands the given angle above the horizon, in the direction of x; W/m^2.
    void sun(double elevation, double strength);
    void sky(double radiance);
    /// Irradiance of a page over the light factor.
    Layer irradiance(const Bake& bake, uint32_t page) const;
    Layer term(const Bake& bake, uint32_t index, uint32_t size, uint32_t page) const;
    /// Settings with the variant's threads.
    ajar_settings settings(uint32_t bounces, uint32_t samples) const;

private:
    ajar_light_desc lamp(uint32_t type, double energy) const;
    std::array<double, 12> at(Float3 position) const;
    Layer divided(Layer layer) const;

    Variant variant_;
};

} // namespace kit
