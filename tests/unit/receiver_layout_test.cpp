// SPDX-License-Identifier: GPL-3.0-or-later
#include <functional>
#include <limits>
#include <random>

#include "layout_kit.h"

namespace ajar {
namespace {

TEST(ReceiverLayout, CubePacksTightly) {
    const std::vector<TestMesh> meshes{make_cube(2.0f)};
    const Layout layout = lay_out(meshes, settings());
    ASSERT_EQ(layout.page_count(), 1u);
    check_layout(layout, meshes, 2);
    check_density(layout, meshes[0], 0, 0, 0.002);
    EXPECT_LE(layout.page_size(0).width * layout.page_size(0).height, 3000u); // 6 * 16^2 and padding
    EXPECT_TRUE(layout.warnings().empty());
}

TEST(ReceiverLayout, CurvedMeshesDoNotOverlap) {
    const std::vector<TestMesh> meshes{make_tube(48, kTau), make_tube(16, 3.0), make_sphere(16),
                                       make_tube(100, 5 * kTau, 0.05, 0.4)};
    const Layout layout = lay_out(meshes, settings(16.0f));
    check_layout(layout, meshes, 2);
    for (uint32_t m = 0; m < meshes.size(); ++m) check_density(layout, meshes[m], m, 0, 0.35);
}

TEST(ReceiverLayout, CylinderBecomesFewStrips) {
    EXPECT_LE(unwrap(make_tube(64, kTau).unwrap_input(16.0), 0.7, 1000.0).charts.size(), 5u);
}

TEST(ReceiverLayout, MoebiusStripWorks) {
    TestMesh m;
    const auto at = [](int i, double s) {
        const double a = kTau * i / 60, r = 2.0 + s * std::cos(a / 2);
        return glm::vec3(r * std::cos(a), r * std::sin(a), s * std::sin(a / 2));
    };
    for (int i = 0; i < 60; ++i) m.polygon({at(i, -0.5), at(i + 1, -0.5), at(i + 1, 0.5), at(i, 0.5)});
    const Layout layout = lay_out({m}, settings(16.0f));
    check_layout(layout, {m}, 2);
}

TEST(ReceiverLayout, TenThousandRandomQuads) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    std::vector<TestMesh> meshes(20);
    for (TestMesh& m : meshes)
        for (int i = 0; i < 500; ++i) {
            const glm::vec3 a(unit(random), unit(random), unit(random)), b(unit(random), unit(random), unit(random));
            m.quad(glm::vec3(unit(random), unit(random), unit(random)) * 50.0f, a, b);
        }
    const Layout layout = lay_out(meshes, settings(8.0f, 1024));
    check_layout(layout, meshes, 2);
    check_density(layout, meshes[3], 3, 0, 0.02);
    EXPECT_LE(layout.page_count(), 3u);
}

TEST(ReceiverLayout, ObjectsSpillToFurtherPages) {
    std::vector<TestMesh> meshes(9, make_cube(3.0f));
    const Layout layout = lay_out(meshes, settings(10.0f, 128));
    EXPECT_GE(layout.page_count(), 3u);
    check_layout(layout, meshes, 2);
    EXPECT_TRUE(layout.warnings().empty());
}

TEST(ReceiverLayout, SharedMeshGetsARectanglePerUser) {
    TestMesh m = make_cube(1.0f);
    m.user(2, 2, 2);
    m.user(1, 1, 1, 3.0f);
    m.user(0.5, 0.5, 0.5);
    const std::vector<TestMesh> meshes{m, make_cube(4.0f)};
    const Layout layout = lay_out(meshes, settings());
    check_layout(layout, meshes, 2);
    for (uint32_t u = 0; u < 4; ++u) check_density(layout, m, 0, u, 0.1);
    EXPECT_FLOAT_EQ(layout.user(0, 0).texels_per_meter, 8.0f);
    EXPECT_FLOAT_EQ(layout.user(0, 2).texels_per_meter, 24.0f);
}

TEST(ReceiverLayout, StretchedUserIsUnwrappedInItsOwnShape) {
    TestMesh m = make_cube(1.0f);
    m.transforms.clear();
    m.user(10, 1, 0.5);
    const Layout layout = lay_out({m}, settings());
    check_layout(layout, {m}, 2);
    check_density(layout, m, 0, 0, 0.03);
}

TEST(ReceiverLayout, MirroredUserWorks) {
    TestMesh m = make_cube(1.0f);
    m.transforms.clear();
    m.user(-2, 1, 1);
    const Layout layout = lay_out({m}, settings());
    check_layout(layout, {m}, 2);
    check_density(layout, m, 0, 0, 0.03);
}

TEST(ReceiverLayout, ObjectTooBigIsReducedAndNamed) {
    TestMesh plane;
    plane.name = "Huge";
    plane.quad({0, 0, 0}, {1000, 0, 0}, {0, 500, 0});
    TestMesh room = make_cube(60.0f);
    room.name = "Room";
    const std::vector<TestMesh> meshes{plane, room, make_cube()};
    const Layout layout = lay_out(meshes, settings(8.0f, 512));
    check_layout(layout, meshes, 2);
    ASSERT_EQ(layout.warnings().size(), 2u);
    EXPECT_EQ(layout.warnings()[0].culprit, "Huge");
    EXPECT_EQ(layout.warnings()[1].culprit, "Room");
    EXPECT_NEAR(layout.user(0, 0).texels_per_meter, 0.508, 0.05);
    check_density(layout, meshes[1], 1, 0, 0.02);
}

TEST(ReceiverLayout, SharedMeshTooBigIsReduced) {
    TestMesh m = make_cube(100.0f);
    m.user(2, 2, 2);
    const Layout layout = lay_out({m}, settings(8.0f, 256));
    check_layout(layout, {m}, 2);
    EXPECT_EQ(layout.warnings().size(), 2u);
}

TEST(ReceiverLayout, BrokenPolygonsGetValidUvsAndAWarning) {
    TestMesh m = make_cube();
    m.name = "Broken";
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    m.polygon({{nan, 0, 0}, {1, 0, 0}, {1, 1, 0}});
    m.polygon({{0, 0, 0}, {inf, 0, 0}, {1, 1, 0}});
    m.polygon({{2, 2, 2}, {2, 2, 2}, {2, 2, 2}});       // a point
    m.polygon({{0, 0, 0}, {0.5f, 0.5f, 0}, {1, 1, 0}}); // a line
    const Layout layout = lay_out({m}, settings());
    check_layout(layout, {m}, 2);
    ASSERT_EQ(layout.warnings().size(), 2u);
    EXPECT_EQ(layout.warnings()[0].culprit, "Broken");
    EXPECT_EQ(layout.warnings()[0].text.substr(0, 1), "2");
}

TEST(ReceiverLayout, MeshOfNothingButBrokenPolygonsStillHasATexel) {
    TestMesh m;
    m.polygon({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}});
    const Layout layout = lay_out({m}, settings());
    EXPECT_EQ(layout.page_count(), 1u);
    check_layout(layout, {m}, 2);
}

TEST(ReceiverLayout, TinyAndThinChartsGetATexel) {
    TestMesh m;
    m.quad({0, 0, 0}, {0.001f, 0, 0}, {0, 0.001f, 0});
    m.quad({1, 0, 0}, {3, 0, 0}, {0, 0.01f, 0});
    const Layout layout = lay_out({m}, settings());
    check_layout(layout, {m}, 2);
    for (uint32_t p = 0; p < 2; ++p) EXPECT_GT(std::abs(area_of(page_polygon(layout, m, 0, 0, p))), 0.2);
}

TEST(ReceiverLayout, EmptyMeshIsReportedAndHasNoPage) {
    TestMesh empty;
    empty.name = "Nothing";
    const std::vector<TestMesh> meshes{empty, make_cube()};
    const Layout layout = lay_out(meshes, settings());
    EXPECT_EQ(layout.user(0, 0).page, AJAR_NONE);
    EXPECT_EQ(layout.user(1, 0).page, 0u);
    ASSERT_EQ(layout.warnings().size(), 1u);
    EXPECT_EQ(layout.warnings()[0].culprit, "Nothing");
}

TEST(ReceiverLayout, NoMeshesGiveNoPages) { EXPECT_EQ(lay_out({}, settings()).page_count(), 0u); }

TEST(ReceiverLayout, KeptChartsKeepShapeAndGetTheWantedDensity) {
    TestMesh m;
    m.quad({0, 0, 0}, {2, 0, 0}, {0, 1, 0});
    m.quad({0, 0, 1}, {4, 0, 0}, {0, 2, 0});
    m.uv = {0.0f, 0.0f, 0.4f, 0.0f, 0.4f, 0.2f, 0.0f, 0.2f, 0.5f, 0.5f, 0.9f, 0.5f, 0.9f, 0.7f, 0.5f, 0.7f};
    const Layout layout = lay_out({m}, settings());
    check_layout(layout, {m}, 2);
    check_density(layout, m, 0, 0, 0.01);
    EXPECT_TRUE(layout.warnings().empty());
}

TEST(ReceiverLayout, KeptChartsThatOverlapOrLeaveTheSquareArePackedApart) {
    TestMesh m;
    m.name = "Artist";
    m.quad({0, 0, 0}, {2, 0, 0}, {0, 1, 0});
    m.quad({0, 0, 1}, {2, 0, 0}, {0, 1, 0});
    m.quad({0, 0, 2}, {2, 0, 0}, {0, 1, 0});
    const std::vector<float> square{0.0f, 0.0f, 0.4f, 0.0f, 0.4f, 0.2f, 0.0f, 0.2f};
    for (int i = 0; i < 3; ++i)
        for (float v : square) m.uv.push_back(i == 2 ? v + 0.9f : v);
    const Layout layout = lay_out({m}, settings());
    check_layout(layout, {m}, 2);
    ASSERT_EQ(layout.warnings().size(), 2u);
    EXPECT_EQ(layout.warnings()[0].culprit, "Artist");
}

TEST(ReceiverLayout, KeptUvsWithoutAreaAreUnwrapped) {
    TestMesh m = make_cube();
    m.uv.assign(48, 0.5f);
    m.uv[3] = std::numeric_limits<float>::quiet_NaN();
    const Layout layout = lay_out({m}, settings());
    check_layout(layout, {m}, 2);
    check_density(layout, m, 0, 0, 0.02);
    EXPECT_EQ(layout.warnings().size(), 1u);
}

TEST(ReceiverLayout, SameInputGivesSameBytes) {
    const std::vector<TestMesh> meshes{make_sphere(12), make_tube(30, kTau), make_cube(3.0f)};
    const Layout a = lay_out(meshes, settings()), b = lay_out(meshes, settings());
    for (uint32_t m = 0; m < meshes.size(); ++m) {
        const std::span<const float> x = a.mesh_uv(m), y = b.mesh_uv(m);
        EXPECT_TRUE(std::equal(x.begin(), x.end(), y.begin(), y.end()));
    }
}

TEST(ReceiverLayout, PaddingsFromNoneToMany) {
    const std::vector<TestMesh> meshes{make_sphere(8), make_cube(2.0f)};
    for (uint32_t padding : {1u, 4u, 9u})
        check_layout(lay_out(meshes, settings(8.0f, 512, padding)), meshes, int(padding));
    EXPECT_EQ(lay_out(meshes, settings(8.0f, 512, 0)).page_count(), 1u);
}

ajar_result code_of(const std::function<void()>& body) {
    try {
        body();
    } catch (const Error& e) {
        return e.code();
    }
    return AJAR_OK;
}

TEST(ReceiverLayout, MoreChartsThanAPageTakesIsAnErrorThatNamesTheMesh) {
    TestMesh m;
    m.name = "Gravel";
    for (int i = 0; i < 500; ++i) m.quad({i, 0, 0}, {0.01f, 0, 0}, {0, 0.01f, 0});
    Layout layout(settings(8.0f, 32));
    layout.add_mesh(m.desc());
    try {
        layout.run();
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), AJAR_ERROR_INPUT);
        EXPECT_EQ(e.culprit(), "Gravel");
    }
}

TEST(ReceiverLayout, AVertexFarOutCostsOnlyItsOwnPolygons) {
    TestMesh m;
    for (int i = 0; i < 20; ++i) m.quad({i, 0, 0}, {1, 0, 0}, {0, 1, 0});
    m.polygon({{0, 0, 5}, {1e30f, 0, 5}, {0, 1, 5}});
    EXPECT_LE(unwrap(m.unwrap_input(8.0), 0.7, 1000.0).charts.size(), 2u);
}

TEST(ReceiverUnwrap, FineMeshesAtLowDensityStillJoin) {
    TestMesh m;
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 40; ++x) m.quad({0.001f * x, 0.001f * y, 0}, {0.001f, 0, 0}, {0, 0.001f, 0});
    EXPECT_LE(unwrap(m.unwrap_input(0.1), 0.7, 1000.0).charts.size(), 2u);
}

TEST(ReceiverLayout, WrongArgumentsAreErrors) {
    for (auto change : std::vector<void (*)(ajar_layout_settings&)>{
             [](ajar_layout_settings& s) { s.texels_per_meter = 0.0f; },
             [](ajar_layout_settings& s) { s.texels_per_meter = std::numeric_limits<float>::quiet_NaN(); },
             [](ajar_layout_settings& s) { s.atlas_size = 0; }, [](ajar_layout_settings& s) { s.padding = 1000; },
             [](ajar_layout_settings& s) { s.chart_angle = 4.0f; }}) {
        ajar_layout_settings s = settings();
        change(s);
        EXPECT_EQ(code_of([&] { Layout layout(s); }), AJAR_ERROR_ARGUMENT);
    }
    Layout layout(settings());
    const TestMesh cube = make_cube();
    for (auto change :
         std::vector<void (*)(ajar_layout_mesh_desc&)>{[](ajar_layout_mesh_desc& d) { d.positions = nullptr; },
                                                       [](ajar_layout_mesh_desc& d) { d.corner_vertex = nullptr; },
                                                       [](ajar_layout_mesh_desc& d) { d.user_count = 0; },
                                                       [](ajar_layout_mesh_desc& d) { d.user_transforms = nullptr; }}) {
        ajar_layout_mesh_desc d = cube.desc();
        change(d);
        EXPECT_EQ(code_of([&] { layout.add_mesh(d); }), AJAR_ERROR_ARGUMENT);
    }
    ajar_layout_mesh_desc short_vertices = cube.desc(), short_corners = cube.desc();
    short_vertices.vertex_count = 3;
    short_corners.corner_count = 22;
    EXPECT_EQ(code_of([&] { layout.add_mesh(short_vertices); }), AJAR_ERROR_INPUT);
    EXPECT_EQ(code_of([&] { layout.add_mesh(short_corners); }), AJAR_ERROR_INPUT);
    EXPECT_EQ(code_of([&] { layout.page_count(); }), AJAR_ERROR_STATE);
    layout.add_mesh(cube.desc());
    layout.run();
    EXPECT_EQ(code_of([&] { layout.run(); }), AJAR_ERROR_STATE);
    EXPECT_EQ(code_of([&] { layout.page_size(1); }), AJAR_ERROR_ARGUMENT);
    EXPECT_EQ(code_of([&] { layout.user(0, 1); }), AJAR_ERROR_ARGUMENT);
    EXPECT_EQ(code_of([&] { layout.mesh_uv(1); }), AJAR_ERROR_ARGUMENT);
}

} // namespace
} // namespace ajar
