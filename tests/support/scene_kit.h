// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Builds small scenes through the public C ABI, for tests and benchmarks.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "ajar/ajar.h"

namespace kit {

using Float3 = std::array<float, 3>;
using Float2 = std::array<float, 2>;

/// Triangle soup with one lightmap UV layer.
struct MeshData {
    std::vector<Float3> positions;
    std::vector<uint32_t> corners;
    std::vector<Float3> normals; ///< per corner, or empty: flat
    std::vector<Float2> uv;      ///< per corner

    /// Adds a quad a, b, c, d (counterclockwise seen from its front) whose UVs fill the rectangle.
    void quad(Float3 a, Float3 b, Float3 c, Float3 d, Float2 low, Float2 high);
};

/// Axis-aligned box [low, high] seen from inside or outside; the six faces get cells of a 3x2 grid.
MeshData box(Float3 low, Float3 high, bool inside, float margin = 0.02f);
/// Horizontal square of edge size at height z, facing up (or down), UVs over [0,1].
MeshData plane(float size, float z, bool up = true);
/// Square of edge 2 m at height 0, facing up, of strips of which every other is 1e-6 m wide; UVs over [0,1].
MeshData sliver_strip();
/// Octahedron subdivided n times and projected to the sphere, seen from inside; UVs: one cell per triangle.
MeshData sphere_inside(float radius, int subdivisions);

/// Owns a scene handle; every failing call throws std::runtime_error with the library's message.
class Scene {
public:
    explicit Scene(const char* name = "test");
    ~Scene();
    Scene(const Scene&) = delete;

    uint32_t texture(const std::vector<float>& rgba, uint32_t width, uint32_t height);
    uint32_t diffuse(Float3 albedo);
    uint32_t emitter(Float3 radiance, Float3 albedo = {0, 0, 0}, bool one_sided = false);
    uint32_t material(const std::vector<ajar_closure>& closures, bool one_sided = false);
    uint32_t page(uint32_t width, uint32_t height);
    uint32_t mesh(const MeshData& data);
    /// Lightmapped on page, or an occluder for page AJAR_NONE.
    uint32_t instance(uint32_t mesh, uint32_t material, uint32_t page, const std::string& name = "object",
                      const double* transform = nullptr);
    uint32_t light(ajar_light_desc desc, const double* transform);
    uint32_t point_light(Float3 position, float watts, float radius = 0.0f, bool primary = false);
    /// kind: AJAR_ELEMENT_*; weight: at the start.
    uint32_t element(uint32_t kind, const std::string& name, bool bounces = true, float weight = 1.0f);
    /// Elements that the next instances and lights belong to; AJAR_NONE for none.
    uint32_t current_switch = AJAR_NONE, current_set = AJAR_NONE;
    bool open_pose = false;
    uint32_t bake_side = AJAR_SIDE_FRONT; ///< of the next instances
    /// AJAR_VISIBLE_* of the next instances.
    uint32_t visibility = AJAR_VISIBLE_GATHER | AJAR_VISIBLE_SHADOW;
    void sky(Float3 radiance);
    /// Equirectangular image (see ajar_sky_desc) times radiance.
    void sky_image(uint32_t texture, Float3 radiance);
    void commit();
    ajar_scene handle() const { return scene_; }

private:
    ajar_scene scene_ = nullptr;
};

/// One layer of one page.
struct Layer {
    uint32_t width = 0, height = 0, channels = 0;
    std::vector<float> data;
    float at(uint32_t x, uint32_t y, uint32_t c = 0) const { return data[(size_t{y} * width + x) * channels + c]; }
};

/// Bakes to the end; owns the job.
class Bake {
public:
    Bake(const Scene& scene, const ajar_settings& settings);
    ~Bake();
    Bake(const Bake&) = delete;
    Layer layer(uint32_t which, uint32_t page = 0) const;
    std::string report() const;
    /// All terms of the bake, the base first.
    std::vector<ajar_term_info> terms() const;
    /// Irradiance of one term over a page of this size.
    Layer term(uint32_t index, uint32_t width, uint32_t height, uint32_t page = 0) const;
    ajar_job handle() const { return job_; }

private:
    ajar_job job_ = nullptr;
};

/// Traces a reference to the end; its points.
std::vector<ajar_reference_point> trace(const Scene& scene, const ajar_reference_settings& settings);
/// Reference settings of small tests: whole texels, a given number of points and batches.
ajar_reference_settings reference_settings(uint32_t bounces, uint32_t points, uint32_t batches);

/// Defaults of small exact tests: fixed sample counts, no stitching.
ajar_settings settings(uint32_t bounces, uint32_t samples = 256);

void check(ajar_result result);
std::array<double, 12> translation(double x, double y, double z);

} // namespace kit
