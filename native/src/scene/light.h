// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "ajar/ajar.h"
#include "base/math.h"
#include "scene/element.h"

namespace ajar {

/// One sampled direction towards a lamp.
struct LightSample {
    Vec3 direction{0.0f};  ///< unit, receiver to light
    float distance = 0.0f; ///< m; infinite for the sun
    Vec3 weight{0.0f};     ///< W/m^2 on a surface that faces the light, divided by the pdf; 0 = no light
};

/// A lamp with Blender's units turned into radiometry. World space, relative to the scene origin.
struct Light {
    enum class Type { point, spot, sun, rectangle, ellipse };

    std::string name;
    Type type = Type::point;
    bool primary = true; ///< only its bounced light is stored
    bool casts_shadow = true;
    uint32_t light_set = kNoElement;
    Vec3 position{0.0f};
    DVec3 exact_position{0.0};
    Vec3 axis{0, 0, -1};                          ///< where it shines; sun: where the light travels
    Vec3 edge_x{0.0f}, edge_y{0.0f};              ///< area: full extents
    Vec3 intensity{0.0f};                         ///< point, spot: W/sr; sun: W/m^2; area: radiance W/(m^2 sr)
    float radius = 0.0f;                          ///< point, spot: m; sun: tangent of half its diameter
    float cone_cos = -1.0f, cone_smooth = 0.0f;   ///< spot: Blender's cone
    float spread_tan = 0.0f, spread_scale = 1.0f; ///< area: 0 = Lambertian
    float area = 0.0f;                            ///< m^2
    float extent = 0.0f; ///< m, half its edges or its radius: no point is further from the position; 0 for suns

    /// Samples the lamp from p with two numbers in [0,1).
    LightSample sample(const Vec3& p, const Vec2& u) const;
    /// Roughly the unshadowed irradiance luminance at p with unit normal n; 0 only if no part of
    /// the lamp can light the surface. reach: m about p in which a narrow area lamp counts too.
    float importance(const Vec3& p, const Vec3& n, float reach = 0.0f) const;
    void move(const DVec3& offset);
    /// A lamp without extent has one direction from each receiver.
    bool is_delta() const { return area == 0.0f && radius == 0.0f; }
    /// A spot, or an area lamp with a spread: its light ends at a cone.
    bool is_narrow() const { return type == Type::spot || spread_tan != 0.0f; }
    bool dark() const { return !(max_component(intensity) > 0.0f); }
};

/// Converts Blender's watts, angles and sizes (all values finite).
Light make_light(const ajar_light_desc& desc, const std::string& name, const Affine& transform);

/// Concentric map of the unit square to the unit disk (Shirley and Chiu 1997); keeps strata compact.
Vec2 square_to_disk(const Vec2& u);

} // namespace ajar
