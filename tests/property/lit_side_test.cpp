// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces whose normals point away from where they are seen, and sane ones that look like them.
#include <gtest/gtest.h>

#include "room_kit.h"

namespace {

constexpr const char* kTurned = "their back is baked";

struct LampScene {
    kit::Scene scene;
    uint32_t white = scene.diffuse({0.5f, 0.5f, 0.5f});
    uint32_t add(const kit::MeshData& mesh, const char* name) {
        const uint32_t page = scene.page(24, 16);
        scene.instance(scene.mesh(mesh), white, page, name);
        return page;
    }
    bool turned(const char* name) const { return kit::has_warning(kit::scene_warnings(scene), name, kTurned); }
};

kit::MeshData wall(float x, bool towards_plus_x) {
    kit::MeshData m;
    if (towards_plus_x)
        m.quad({x, -2, 0}, {x, 2, 0}, {x, 2, 3}, {x, -2, 3}, {0, 0}, {1, 1});
    else
        m.quad({x, 2, 0}, {x, -2, 0}, {x, -2, 3}, {x, 2, 3}, {0, 0}, {1, 1});
    return m;
}

/// Appends the corners [begin, end) of a mesh to another.
void append(kit::MeshData& to, const kit::MeshData& from, size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) {
        to.corners.push_back(static_cast<uint32_t>(to.positions.size()));
        to.positions.push_back(from.positions[from.corners[c]]);
        to.uv.push_back(from.uv[c]);
    }
}

kit::MeshData part_of(const kit::MeshData& mesh, size_t begin, size_t end) {
    kit::MeshData out;
    append(out, mesh, begin, end);
    return out;
}

double mean_of_room(bool inside, bool& turned) {
    LampScene s;
    s.add(kit::box({-2, -2, 0}, {2, 2, 3}, inside), "room");
    s.scene.point_light({0, 0, 1.5f}, 100.0f);
    s.scene.commit();
    turned = s.turned("room");
    return kit::mean(kit::Bake(s.scene, kit::settings(3)).layer(AJAR_LAYER_IRRADIANCE));
}

TEST(LitSide, RoomWithOutwardNormalsIsBakedFromInside) {
    bool turned_sane, turned_wrong;
    const double sane = mean_of_room(true, turned_sane), wrong = mean_of_room(false, turned_wrong);
    EXPECT_FALSE(turned_sane);
    EXPECT_TRUE(turned_wrong);
    EXPECT_NEAR(wrong / sane, 1.0, 0.01);
}

TEST(LitSide, PropInARoomKeepsItsNormals) {
    LampScene s;
    s.add(kit::box({-2, -2, 0}, {2, 2, 3}, true), "room");
    s.add(kit::box({-0.5f, -0.5f, 0.0f}, {0.5f, 0.5f, 1.0f}, false), "crate");
    s.scene.point_light({0, 0, 2.5f}, 100.0f);
    s.scene.commit();
    EXPECT_TRUE(kit::scene_warnings(s.scene).empty());
}

TEST(LitSide, PlaneLitFromBehindStaysDark) {
    LampScene s;
    s.add(kit::plane(2.0f, 0.0f), "floor");
    s.scene.point_light({0, 0, -1}, 100.0f);
    s.scene.commit();
    EXPECT_TRUE(kit::scene_warnings(s.scene).empty());
    EXPECT_EQ(kit::mean(kit::Bake(s.scene, kit::settings(1)).layer(AJAR_LAYER_IRRADIANCE)), 0.0);
}

TEST(LitSide, SinglePartitionBelongsToTheRoomItsNormalsFace) {
    LampScene s;
    s.add(kit::box({-2, -2, 0}, {2, 2, 3}, true), "rooms");
    const uint32_t page = s.add(wall(0.0f, true), "partition");
    s.scene.point_light({-1, 0, 1.5f}, 100.0f);
    s.scene.commit();
    EXPECT_TRUE(kit::scene_warnings(s.scene).empty());
    EXPECT_LT(kit::mean(kit::Bake(s.scene, kit::settings(1)).layer(AJAR_LAYER_IRRADIANCE, page)), 1e-6);
}

TEST(LitSide, RoomOfLoosePanelsThatAllPointOutIsTurned) {
    LampScene s;
    const kit::MeshData shell = kit::box({-2, -2, 0}, {2, 2, 3}, false);
    for (size_t quad = 0; quad < 6; ++quad)
        s.add(part_of(shell, 6 * quad, 6 * quad + 6), ("panel " + std::to_string(quad)).c_str());
    s.scene.point_light({0, 0, 2}, 100.0f);
    s.scene.commit();
    for (int quad = 0; quad < 6; ++quad) EXPECT_TRUE(s.turned(("panel " + std::to_string(quad)).c_str())) << quad;
}

/// A room whose wall x = 2 is missing, as a level compiler leaves it behind a panel, with a lamp; behind lie the
/// backs of a lit next room.
void add_open_room(LampScene& s) {
    const kit::MeshData room = kit::box({-2, -2, 0}, {2, 2, 3}, true);
    kit::MeshData open;
    for (size_t c = 0; c < room.corners.size(); c += 3) {
        bool at_wall = true;
        for (size_t k = c; k < c + 3; ++k) at_wall = at_wall && room.positions[room.corners[k]][0] == 2.0f;
        if (!at_wall) append(open, room, c, c + 3);
    }
    s.add(open, "room");
    s.add(kit::box({2.5f, -4, -1}, {6, 4, 4}, true), "next room");
    s.scene.point_light({0, 0, 1.5f}, 100.0f);
    s.scene.point_light({4, 0, 1.5f}, 100.0f);
}

TEST(LitSide, CurvedPanelTurnedTowardsTheVoidIsBakedFromTheRoom) {
    LampScene s;
    add_open_room(s);
    const uint32_t page = s.add(wall(2.0f, true), "panel");
    s.scene.commit();
    EXPECT_TRUE(s.turned("panel"));
    EXPECT_FALSE(s.turned("room"));
    EXPECT_FALSE(s.turned("next room"));
    EXPECT_GT(kit::mean(kit::Bake(s.scene, kit::settings(1)).layer(AJAR_LAYER_IRRADIANCE, page)), 0.5);
}

TEST(LitSide, PanelThatHangsTogetherWithARightFloorIsTurnedAlone) {
    // As the filling of an arch does with the walls beside it.
    LampScene s;
    add_open_room(s);
    kit::MeshData both = wall(2.0f, true);
    both.quad({2, 2, 0}, {2, -2, 0}, {6, -2, 0}, {6, 2, 0}, {0, 0}, {1, 1});
    s.add(both, "panel and floor");
    s.scene.commit();
    EXPECT_TRUE(kit::has_warning(kit::scene_warnings(s.scene), "panel and floor", "the normals of 2 triangles"));
}

} // namespace
