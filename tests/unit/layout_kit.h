// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Meshes for the layout tests, and what must hold for every layout.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "receiver/layout.h"
#include "receiver/unwrap.h"

namespace ajar {

inline constexpr double kTau = 2.0 * std::numbers::pi;
inline constexpr double kIdentity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/// A mesh under construction and its ABI description.
struct TestMesh {
    std::string name = "mesh";
    std::vector<glm::vec3> positions;
    std::vector<uint32_t> corner_vertex, start, size;
    std::vector<float> uv;
    std::vector<uint8_t> sharp;
    std::vector<double> transforms{std::begin(kIdentity), std::end(kIdentity)};
    std::vector<float> texel_scale;

    void polygon(const std::vector<glm::vec3>& points) {
        start.push_back(uint32_t(corner_vertex.size()));
        size.push_back(uint32_t(points.size()));
        for (const glm::vec3& p : points) {
            corner_vertex.push_back(uint32_t(positions.size()));
            positions.push_back(p);
        }
    }
    /// Rectangle from origin along a and b.
    void quad(glm::vec3 origin, glm::vec3 a, glm::vec3 b) { polygon({origin, origin + a, origin + a + b, origin + b}); }
    void user(double scale_x, double scale_y, double scale_z, float texels = 1.0f) {
        transforms.insert(transforms.end(), {scale_x, 0, 0, 5, 0, scale_y, 0, -3, 0, 0, scale_z, 1});
        texel_scale.resize(transforms.size() / 12, 1.0f);
        texel_scale.back() = texels;
    }
    ajar_layout_mesh_desc desc() const {
        ajar_layout_mesh_desc d{};
        d.struct_size = sizeof d;
        d.name = name.c_str();
        d.vertex_count = uint32_t(positions.size());
        d.corner_count = uint32_t(corner_vertex.size());
        d.polygon_count = uint32_t(start.size());
        d.positions = positions.empty() ? nullptr : &positions[0].x;
        d.corner_vertex = corner_vertex.data();
        d.polygon_start = start.data();
        d.polygon_size = size.data();
        d.corner_uv = uv.empty() ? nullptr : uv.data();
        d.corner_edge_sharp = sharp.empty() ? nullptr : sharp.data();
        d.user_count = uint32_t(transforms.size() / 12);
        d.user_transforms = transforms.data();
        d.user_texel_scale = texel_scale.empty() ? nullptr : texel_scale.data();
        return d;
    }
    UnwrapMesh unwrap_input(double density = 1.0) const {
        UnwrapMesh mesh;
        for (const glm::vec3& p : positions) mesh.positions.push_back(glm::dvec3(p) * density);
        mesh.corner_vertex = corner_vertex;
        mesh.polygon_start = start;
        mesh.polygon_size = size;
        mesh.corner_uv = uv;
        mesh.corner_edge_sharp = sharp;
        return mesh;
    }
};

inline TestMesh make_cube(float edge = 1.0f) {
    TestMesh m;
    const float e = edge;
    m.quad({0, 0, 0}, {0, e, 0}, {e, 0, 0});
    m.quad({0, 0, e}, {e, 0, 0}, {0, e, 0});
    m.quad({0, 0, 0}, {e, 0, 0}, {0, 0, e});
    m.quad({0, e, 0}, {0, 0, e}, {e, 0, 0});
    m.quad({0, 0, 0}, {0, 0, e}, {0, e, 0});
    m.quad({e, 0, 0}, {0, e, 0}, {0, 0, e});
    return m;
}

/// Part of a tube of radius 1 with `count` faces over `angle` radians; pitch lifts each face (helix).
inline TestMesh make_tube(int count, double angle, double pitch = 0.0, double height = 2.0) {
    TestMesh m;
    const auto point = [&](int i, double z) {
        const double a = angle * i / count;
        return glm::vec3(std::cos(a), std::sin(a), z + pitch * i);
    };
    for (int i = 0; i < count; ++i) m.polygon({point(i, 0), point(i + 1, 0), point(i + 1, height), point(i, height)});
    return m;
}

inline TestMesh make_sphere(int rings) {
    TestMesh m;
    const auto point = [&](int i, int j) {
        const double t = std::numbers::pi * i / rings, p = kTau * j / (2 * rings);
        return glm::vec3(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t));
    };
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < 2 * rings; ++j)
            m.polygon({point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)}); // triangles at the poles
    return m;
}

inline ajar_layout_settings settings(float density = 8.0f, uint32_t atlas = 1024, uint32_t padding = 2) {
    ajar_layout_settings s{};
    s.struct_size = sizeof s;
    s.texels_per_meter = density;
    s.atlas_size = atlas;
    s.padding = padding;
    s.chart_angle = 0.7f;
    return s;
}

/// Page UVs of a user's polygon in texels.
inline std::vector<glm::dvec2> page_polygon(const Layout& layout, const TestMesh& mesh, uint32_t id, uint32_t user,
                                            uint32_t polygon) {
    const LayoutUser place = layout.user(id, user);
    const PageSize page = layout.page_size(place.page);
    const std::span<const float> uv = layout.mesh_uv(id);
    std::vector<glm::dvec2> result;
    for (uint32_t c = mesh.start[polygon]; c < mesh.start[polygon] + mesh.size[polygon]; ++c)
        result.push_back({(double(uv[2 * c]) * place.scale[0] + place.offset[0]) * page.width,
                          (double(uv[2 * c + 1]) * place.scale[1] + place.offset[1]) * page.height});
    return result;
}

inline double area_of(const std::vector<glm::dvec2>& p) {
    double twice = 0.0;
    for (size_t i = 0; i < p.size(); ++i) {
        const glm::dvec2 &a = p[i], &b = p[(i + 1) % p.size()];
        twice += a.x * b.y - a.y * b.x;
    }
    return 0.5 * twice;
}

inline constexpr int kFine = 8; ///< cells per texel when charts are told apart by touching

/// Label of the connected piece of set bits that every fine cell belongs to; 0: free.
inline std::vector<uint32_t> label_pieces(const BitRows& bits, uint32_t& count) {
    std::vector<uint32_t> label(size_t(bits.width()) * bits.height(), 0), stack;
    count = 0;
    for (int y = 0; y < bits.height(); ++y)
        for (int x = 0; x < bits.width(); ++x) {
            if (!bits.get(x, y) || label[size_t(y) * bits.width() + x]) continue;
            label[size_t(y) * bits.width() + x] = ++count;
            stack.push_back(uint32_t(y * bits.width() + x));
            while (!stack.empty()) {
                const int cx = int(stack.back()) % bits.width(), cy = int(stack.back()) / bits.width();
                stack.pop_back();
                for (int ny = std::max(cy - 1, 0); ny <= std::min(cy + 1, bits.height() - 1); ++ny)
                    for (int nx = std::max(cx - 1, 0); nx <= std::min(cx + 1, bits.width() - 1); ++nx) {
                        uint32_t& at = label[size_t(ny) * bits.width() + nx];
                        if (at || !bits.get(nx, ny)) continue;
                        at = count;
                        stack.push_back(uint32_t(ny * bits.width() + nx));
                    }
            }
        }
    return label;
}

/// What must hold for every layout: UVs finite and in [0,1], pieces that do not touch keep `padding`
/// free texels between them and to the border, and no sample lies in two polygons.
inline void check_layout(const Layout& layout, const std::vector<TestMesh>& meshes, int padding) {
    for (uint32_t m = 0; m < meshes.size(); ++m)
        for (float value : layout.mesh_uv(m)) ASSERT_TRUE(value >= 0.0f && value <= 1.0f) << meshes[m].name;
    for (uint32_t page = 0; page < layout.page_count(); ++page) {
        const PageSize size = layout.page_size(page);
        EXPECT_EQ(size.width % 4 + size.height % 4, 0u);
        BitRows fine(int(size.width) * kFine, int(size.height) * kFine), samples(fine.width(), fine.height());
        std::vector<std::vector<glm::dvec2>> polygons;
        size_t twice = 0, covered = 0;
        std::vector<SampleSpan> spans;
        for (uint32_t m = 0; m < meshes.size(); ++m)
            for (uint32_t u = 0; u < meshes[m].transforms.size() / 12; ++u) {
                if (layout.user(m, u).page != page) continue;
                for (uint32_t p = 0; p < meshes[m].start.size(); ++p) {
                    std::vector<glm::dvec2> polygon = page_polygon(layout, meshes[m], m, u, p);
                    std::vector<glm::dvec2> scaled = polygon;
                    for (glm::dvec2& v : scaled) v *= double(kFine);
                    polygon_spans(scaled, fine.width(), fine.height(), spans);
                    for (const SampleSpan& s : spans) {
                        for (int x = s.begin; x < s.end; ++x) twice += samples.get(x, s.y);
                        covered += size_t(s.end - s.begin);
                        samples.set_span(s.y, s.begin, s.end);
                    }
                    cover_polygon(scaled, fine);
                    polygons.push_back(std::move(polygon));
                }
            }
        EXPECT_LE(double(twice), 0.002 * double(covered));
        uint32_t pieces = 0;
        const std::vector<uint32_t> label = label_pieces(fine, pieces);
        std::vector<uint32_t> owner(size_t(size.width) * size.height, 0);
        for (const auto& polygon : polygons) {
            const glm::ivec2 first(glm::clamp(polygon[0] * double(kFine), glm::dvec2(0.0),
                                              glm::dvec2(fine.width() - 1, fine.height() - 1)));
            uint32_t piece = 0; // a corner on a cell border may have its piece in the next cell
            for (int y = std::max(first.y - 1, 0); y <= std::min(first.y + 1, fine.height() - 1); ++y)
                for (int x = std::max(first.x - 1, 0); x <= std::min(first.x + 1, fine.width() - 1); ++x)
                    piece = std::max(piece, label[size_t(y) * fine.width() + x]);
            if (std::abs(area_of(polygon)) < 1e-6) continue; // has no texels of its own
            ASSERT_NE(piece, 0u);
            BitRows texels(int(size.width), int(size.height));
            cover_polygon(polygon, texels);
            double low = 1e9, high = -1e9;
            for (const glm::dvec2& p : polygon) {
                low = std::min(low, p.y);
                high = std::max(high, p.y);
            }
            for (int y = std::max(int(low) - 1, 0); y <= std::min(int(high) + 1, int(size.height) - 1); ++y)
                for (const auto& [begin, end] : texels.runs(y))
                    for (int x = begin; x < end; ++x) {
                        EXPECT_TRUE(x >= padding && y >= padding && x < int(size.width) - padding &&
                                    y < int(size.height) - padding);
                        uint32_t& at = owner[size_t(y) * size.width + x];
                        EXPECT_TRUE(at == 0 || at == piece) << "two charts share texel " << x << "," << y;
                        at = piece;
                    }
        }
        size_t close = 0; // a corner that touches a texel by a rounding error may count
        for (int y = 0; y < int(size.height); ++y)
            for (int x = 0; x < int(size.width); ++x) {
                const uint32_t at = owner[size_t(y) * size.width + x];
                for (int ny = y; at && ny <= std::min(y + padding, int(size.height) - 1); ++ny)
                    for (int nx = std::max(x - padding, 0); nx <= std::min(x + padding, int(size.width) - 1); ++nx) {
                        const uint32_t other = owner[size_t(ny) * size.width + nx];
                        close += other && other != at;
                    }
            }
        EXPECT_LE(close, 2u) << "charts closer than the padding on page " << page;
    }
}

/// Texel density of every polygon against the one wanted; small and thin polygons are left out.
inline void check_density(const Layout& layout, const TestMesh& mesh, uint32_t id, uint32_t user, double tolerance) {
    const double* m = mesh.transforms.data() + 12 * user;
    const double wanted = layout.user(id, user).texels_per_meter;
    for (uint32_t p = 0; p < mesh.start.size(); ++p) {
        const auto world = [&](uint32_t c) {
            const glm::dvec3 v = mesh.positions[mesh.corner_vertex[mesh.start[p] + c]];
            return glm::dvec3(m[0] * v.x + m[1] * v.y + m[2] * v.z, m[4] * v.x + m[5] * v.y + m[6] * v.z,
                              m[8] * v.x + m[9] * v.y + m[10] * v.z);
        };
        glm::dvec3 normal(0.0);
        for (uint32_t c = 1; c + 1 < mesh.size[p]; ++c)
            normal += glm::cross(world(c) - world(0), world(c + 1) - world(0));
        const double texels = std::abs(area_of(page_polygon(layout, mesh, id, user, p)));
        double longest = 1.0;
        for (const glm::dvec2& a : page_polygon(layout, mesh, id, user, p))
            for (const glm::dvec2& b : page_polygon(layout, mesh, id, user, p))
                longest = std::max(longest, glm::length(a - b));
        if (texels < 2.0 || texels / longest < 1.0) continue; // widened to a texel, as it should
        EXPECT_NEAR(std::sqrt(texels / (0.5 * glm::length(normal))) / wanted, 1.0, tolerance) << "polygon " << p;
    }
}

inline Layout lay_out(const std::vector<TestMesh>& meshes, const ajar_layout_settings& s) {
    Layout layout(s);
    for (const TestMesh& mesh : meshes) layout.add_mesh(mesh.desc());
    layout.run();
    return layout;
}

} // namespace ajar
