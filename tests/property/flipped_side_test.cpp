// SPDX-License-Identifier: GPL-3.0-or-later
// Objects that look flipped are named, and sane ones that look like them are not.
#include <gtest/gtest.h>

#include <algorithm>

#include "room_kit.h"

namespace {

struct Place {
    kit::Scene scene;
    uint32_t grey = scene.diffuse({0.5f, 0.5f, 0.5f});

    void add(const kit::MeshData& mesh, const char* name) {
        scene.instance(scene.mesh(mesh), grey, scene.page(12, 8), name);
    }
    void add_room(bool inside = true) { add(kit::box({-2, -2, 0}, {2, 2, 3}, inside), "room"); }

    /// Names of the objects that the report of a bake says look flipped.
    std::vector<std::string> flipped() {
        scene.commit();
        const std::string report = kit::Bake(scene, kit::settings(0, 1)).report();
        std::vector<std::string> names;
        for (size_t at = 0; (at = report.find("\"culprit\": \"", at)) != std::string::npos;) {
            const size_t begin = at + 12, end = report.find('"', begin), next = report.find('}', end);
            if (report.substr(end, next - end).find("looks flipped") != std::string::npos)
                names.push_back(report.substr(begin, end - begin));
            at = next;
        }
        return names;
    }
};

using Names = std::vector<std::string>;

/// An upright square of 1.2 m at a distance from the wall y = 2.
kit::MeshData picture(float gap, bool to_wall) {
    kit::MeshData m;
    const float y = 2.0f - gap;
    m.quad({-0.6f, y, 1}, {0.6f, y, 1}, {0.6f, y, 2.2f}, {-0.6f, y, 2.2f}, {0, 0}, {1, 1});
    if (to_wall) std::reverse(m.corners.begin(), m.corners.end());
    return m;
}

TEST(FlippedSide, PictureThatFacesItsWallIsNamed) {
    for (const float gap : {0.005f, 0.04f, 0.1f}) {
        for (const bool to_wall : {false, true}) {
            Place p;
            p.add_room();
            p.add(picture(gap, to_wall), "picture");
            p.scene.point_light({0, 0, 2}, 100.0f);
            EXPECT_EQ(p.flipped(), to_wall ? Names{"picture"} : Names{}) << gap;
        }
    }
}

TEST(FlippedSide, FloorThatFacesDownIsNamed) {
    for (const bool sky : {false, true}) {
        Place p;
        const kit::MeshData room = kit::box({-2, -2, 0}, {2, 2, 3}, true);
        kit::MeshData walls = room;
        walls.corners.erase(walls.corners.begin(), walls.corners.begin() + 6);
        walls.uv.erase(walls.uv.begin(), walls.uv.begin() + 6);
        p.add(walls, "walls");
        p.add(kit::plane(4.0f, 0.0f, false), "floor");
        if (sky) p.scene.sky({1, 1, 1});
        p.scene.point_light({0, 0, 2}, 100.0f);
        EXPECT_EQ(p.flipped(), Names{"floor"}) << sky;
    }
}

TEST(FlippedSide, RoomWhoseNormalsPointOutIsNamedWhereNoSkyShines) {
    Place p;
    p.add_room(false);
    p.scene.point_light({0, 0, 2}, 100.0f);
    EXPECT_EQ(p.flipped(), Names{"room"});
}

TEST(FlippedSide, BackBakedIsFlipped) {
    Place p;
    p.scene.bake_side = AJAR_SIDE_BACK;
    p.add_room(false);
    p.scene.point_light({0, 0, 2}, 100.0f);
    EXPECT_EQ(p.flipped(), Names{});
}

TEST(FlippedSide, WallOverTheEdgeOfTheWorldIsNamedUnderASky) {
    for (const bool out : {false, true}) {
        Place p;
        const kit::MeshData room = kit::box({-2, -2, 0}, {2, 2, 3}, true);
        kit::MeshData rest = room, wall = room;
        rest.corners.resize(30), rest.uv.resize(30); // all but the wall at x low
        wall.corners.assign(room.corners.begin() + 30, room.corners.end());
        wall.uv.assign(room.uv.begin() + 30, room.uv.end());
        if (out) std::reverse(wall.corners.begin(), wall.corners.end());
        p.add(rest, "room");
        p.add(wall, "wall");
        p.scene.sky({1, 1, 1});
        EXPECT_EQ(p.flipped(), out ? Names{"wall"} : Names{});
    }
}

TEST(FlippedSide, UpperFloorWithoutARoofIsSane) {
    Place p;
    kit::MeshData walls = kit::box({-2, -2, 0}, {2, 2, 5}, true);
    walls.corners.erase(walls.corners.begin() + 6, walls.corners.begin() + 12);
    walls.uv.erase(walls.uv.begin() + 6, walls.uv.begin() + 12);
    p.add(walls, "walls and lower floor");
    p.add(kit::plane(4.0f, 3.0f), "upper floor");
    p.scene.point_light({0, 0, 4}, 100.0f);
    EXPECT_EQ(p.flipped(), Names{});
}

TEST(FlippedSide, CardInTheAirIsSane) {
    Place p;
    p.add(picture(2.0f, false), "card");
    p.scene.sky({1, 1, 1});
    EXPECT_EQ(p.flipped(), Names{});
}

TEST(FlippedSide, ClosedPropWithALampInItIsSane) {
    Place p;
    p.add(kit::plane(6.0f, 0.0f), "ground");
    p.add(kit::box({-0.2f, -0.2f, 2.8f}, {0.2f, 0.2f, 3.2f}, false), "lantern");
    p.scene.point_light({0, 0, 3}, 30.0f);
    p.scene.sky({0.5f, 0.5f, 0.5f});
    EXPECT_EQ(p.flipped(), Names{});
}

TEST(FlippedSide, FurnishedRoomIsSane) {
    Place p;
    p.add_room();
    p.add(kit::box({-0.5f, -0.5f, 0.0f}, {0.5f, 0.5f, 1.0f}, false), "crate");
    p.add(kit::box({-1.5f, -1.5f, 0.0f}, {-1.2f, -1.2f, 0.03f}, false), "book");
    p.add(kit::plane(0.8f, 0.01f), "rug under the crate");
    p.add(kit::box({1.2f, 1.2f, 0.5f}, {1.5f, 1.5f, 0.8f}, true), "drawer");
    p.scene.point_light({0, 0, 2.5f}, 100.0f);
    EXPECT_EQ(p.flipped(), Names{});
}

TEST(FlippedSide, SheetsAboveEachOtherAreSane) {
    Place p; // a floor under a roof, a rug under a bridge, shelves, low storeys: all normals up
    p.add(kit::plane(8.0f, -0.005f), "ground");
    p.add(kit::plane(1.0f, 0.0f), "rug");
    p.add(kit::plane(3.0f, 0.8f), "bridge");
    for (const float z : {1.1f, 1.4f, 1.7f, 2.0f}) p.add(kit::plane(1.0f, z), "shelf");
    p.add(kit::plane(6.0f, 3.0f), "roof");
    p.scene.sky({0.3f, 0.3f, 0.3f});
    EXPECT_EQ(p.flipped(), Names{});
}

TEST(FlippedSide, ManyObjectsShareOneWarning) {
    Place p;
    p.add_room();
    for (int i = 0; i < 12; ++i) {
        kit::MeshData m;
        const float x = -1.9f + 0.3f * static_cast<float>(i);
        m.quad({x, 1.98f, 1}, {x + 0.2f, 1.98f, 1}, {x + 0.2f, 1.98f, 2}, {x, 1.98f, 2}, {0, 0}, {1, 1});
        std::reverse(m.corners.begin(), m.corners.end());
        p.add(m, ("picture " + std::to_string(i)).c_str());
    }
    p.scene.point_light({0, 0, 2}, 100.0f);
    EXPECT_EQ(p.flipped().size(), 8u);
    EXPECT_NE(kit::Bake(p.scene, kit::settings(0, 1)).report().find("4 more objects look flipped"), std::string::npos);
}

} // namespace
