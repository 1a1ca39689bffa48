// SPDX-License-Identifier: GPL-3.0-or-later
#include <ctime>

#include "layout_kit.h"

namespace ajar {
namespace {

TEST(ReceiverUnwrap, CubeHasSixSquareCharts) {
    const Unwrapped u = unwrap(make_cube().unwrap_input(8.0), 0.7, 1000.0);
    ASSERT_EQ(u.charts.size(), 6u);
    for (const Chart& chart : u.charts) {
        EXPECT_NEAR(chart.size.x, 8.0, 1e-4);
        EXPECT_NEAR(chart.size.y, 8.0, 1e-4);
        EXPECT_NEAR(chart.area, 64.0, 1e-3);
    }
}

TEST(ReceiverUnwrap, UnsharedCoplanarQuadsJoin) {
    TestMesh m;
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 7; ++x) m.quad({x, y, 0}, {1, 0, 0}, {0, 1, 0});
    EXPECT_EQ(unwrap(m.unwrap_input(8.0), 0.7, 1000.0).charts.size(), 1u);
}

TEST(ReceiverUnwrap, TJunctionsJoin) {
    TestMesh m; // one long quad beside three short ones, and one that overlaps only half an edge
    m.quad({0, 0, 0}, {3, 0, 0}, {0, 1, 0});
    for (int x = 0; x < 3; ++x) m.quad({x, 1, 0}, {1, 0, 0}, {0, 1, 0});
    m.quad({3, 0.5f, 0}, {1, 0, 0}, {0, 2, 0});
    EXPECT_EQ(unwrap(m.unwrap_input(8.0), 0.7, 1000.0).charts.size(), 1u);
}

TEST(ReceiverUnwrap, SharpEdgesCutUnlessTheSurfaceIsFlatThere) {
    TestMesh bent;
    bent.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    bent.quad({1, 0, 0}, {0.9f, 0, 0.3f}, {0, 1, 0});
    EXPECT_EQ(unwrap(bent.unwrap_input(8.0), 0.7, 1000.0).charts.size(), 1u);
    bent.sharp.assign(8, 1);
    EXPECT_EQ(unwrap(bent.unwrap_input(8.0), 0.7, 1000.0).charts.size(), 2u);
    TestMesh flat;
    flat.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    flat.quad({1, 0, 0}, {1, 0, 0}, {0, 1, 0});
    flat.sharp.assign(8, 1);
    EXPECT_EQ(unwrap(flat.unwrap_input(8.0), 0.7, 1000.0).charts.size(), 1u);
}

TEST(ReceiverUnwrap, BackToBackFacesStayApart) {
    TestMesh m;
    m.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    m.quad({0, 0, 0}, {0, 1, 0}, {1, 0, 0});
    EXPECT_EQ(unwrap(m.unwrap_input(8.0), 0.7, 1000.0).charts.size(), 2u);
}

TEST(ReceiverUnwrap, FlatSpiralThatCoversItselfIsCut) {
    TestMesh m; // coplanar ring of 24 steps that goes round twice
    for (int i = 0; i < 24; ++i) {
        const auto at = [&](int k, float r) {
            return glm::vec3(r * std::cos(k * kTau / 12), r * std::sin(k * kTau / 12), 0.0005f * k);
        };
        m.polygon({at(i, 1), at(i, 2), at(i + 1, 2), at(i + 1, 1)});
    }
    const Unwrapped u = unwrap(m.unwrap_input(8.0), 0.7, 1000.0);
    EXPECT_GE(u.charts.size(), 2u);
    EXPECT_LE(u.charts.size(), 6u);
}

TEST(ReceiverUnwrap, TurnedRectangleGetsItsOwnAxes) {
    TestMesh m;
    m.quad({1, 2, 3}, {0.6f * 4, 0.8f * 4, 0}, {-0.8f, 0.6f, 0});
    const Unwrapped u = unwrap(m.unwrap_input(8.0), 0.7, 1000.0);
    ASSERT_EQ(u.charts.size(), 1u);
    EXPECT_NEAR(std::max(u.charts[0].size.x, u.charts[0].size.y), 32.0, 1e-3);
    EXPECT_NEAR(std::min(u.charts[0].size.x, u.charts[0].size.y), 8.0, 1e-3);
}

TEST(ReceiverUnwrap, ConcavePolygonsKeepTheirNeighboursInTheNotch) {
    TestMesh m;
    m.polygon({{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0}, {2, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}});
    m.quad({1, 1, 0}, {1, 0, 0}, {0, 2, 0});
    EXPECT_EQ(unwrap(m.unwrap_input(8.0), 0.7, 1000.0).charts.size(), 1u);
}

TEST(ReceiverUnwrap, FacesThatAreLargerThanAPageTakeNoTime) {
    const std::clock_t start = std::clock(); // each took a bitmap of 64 million samples
    const Unwrapped u = unwrap(make_sphere(16).unwrap_input(1e6), 0.7, 100.0);
    EXPECT_LT(double(std::clock() - start) / CLOCKS_PER_SEC, 2.0);
    EXPECT_GT(u.charts.size(), 100u);
}

TEST(ReceiverUnwrap, ChartsStayBelowTheLargestExtent) {
    TestMesh m;
    for (int i = 0; i < 100; ++i) m.quad({i, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const Unwrapped u = unwrap(m.unwrap_input(8.0), 0.7, 200.0);
    EXPECT_EQ(u.charts.size(), 4u);
    for (const Chart& chart : u.charts) EXPECT_LE(std::max(chart.size.x, chart.size.y), 200.001);
}

} // namespace
} // namespace ajar
