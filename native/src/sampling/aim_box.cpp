// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling/aim_box.h"

namespace ajar {

namespace {

constexpr double kLeastThickness = 1e-3; ///< of the largest extent: a flat leaf is a box too

/// The face of an axis that p sees, relative to p.
SphericalRectangle face(const AimBox& box, const DVec3& p, int axis) {
    const DVec3 to = box.center - p;
    const double side = glm::dot(to, box.axis[axis]) > 0.0 ? -1.0 : 1.0;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const DVec3 corner =
        to + side * box.half[axis] * box.axis[axis] - box.half[u] * box.axis[u] - box.half[v] * box.axis[v];
    return {corner, 2.0 * box.half[u] * box.axis[u], 2.0 * box.half[v] * box.axis[v]};
}

/// Axes of an instance's own frame; the world's if it is sheared.
std::array<DVec3, 3> axes_of(const Affine& m) {
    std::array<DVec3, 3> axis;
    for (int i = 0; i < 3; ++i) {
        const double length = glm::length(m.column(i));
        if (!(length > 0.0)) return AimBox().axis;
        axis[i] = m.column(i) / length;
    }
    for (int i = 0; i < 3; ++i)
        if (std::abs(glm::dot(axis[i], axis[(i + 1) % 3])) > 1e-4) return AimBox().axis;
    axis[2] = glm::cross(axis[0], axis[1]);
    return axis;
}

void fit(AimBox& box, const Snapshot& scene) {
    DVec3 low(std::numeric_limits<double>::infinity()), high = -low;
    for (const Triangle& t : scene.triangles) {
        const Instance& i = scene.instances[t.instance];
        if (i.element != box.element || i.open_pose) continue;
        for (const uint32_t v : t.vertex)
            for (int a = 0; a < 3; ++a) {
                const double along = glm::dot(DVec3(scene.positions[v]), box.axis[a]);
                low[a] = std::min(low[a], along), high[a] = std::max(high[a], along);
            }
    }
    box.half = 0.5 * (high - low);
    const double largest = std::max({box.half.x, box.half.y, box.half.z});
    for (int a = 0; a < 3; ++a) {
        box.half[a] = std::max(box.half[a], kLeastThickness * largest);
        box.center += 0.5 * (low[a] + high[a]) * box.axis[a];
    }
}

} // namespace

AimBox::View AimBox::view_from(const Vec3& from) const {
    const DVec3 p(from), to = p - center;
    View view;
    for (int a = 0; a < 3; ++a)
        if (std::abs(glm::dot(to, axis[a])) > half[a]) {
            view.face[a] = face(*this, p, a);
            view.solid_angle += static_cast<float>(view.face[a].solid_angle());
        }
    return view;
}

Vec3 AimBox::View::sample(Vec2 u) const {
    double target = double(u.x) * (face[0].solid_angle() + face[1].solid_angle() + face[2].solid_angle());
    int a = 0;
    while (a < 2 && target >= face[a].solid_angle()) target -= face[a++].solid_angle();
    while (a > 0 && !(face[a].solid_angle() > 0.0)) --a;
    u.x = static_cast<float>(std::clamp(target / std::max(face[a].solid_angle(), 1e-30), 0.0, 0x1.fffffep-1));
    return Vec3(glm::normalize(face[a].sample(u)));
}

float AimBox::distance(const Vec3& from, const Vec3& direction) const {
    constexpr float kNever = std::numeric_limits<float>::infinity();
    const DVec3 to = center - DVec3(from), w(direction);
    double begin = 0.0, end = kNever;
    for (int a = 0; a < 3; ++a) {
        const double along = glm::dot(w, axis[a]), distance = glm::dot(to, axis[a]);
        if (along == 0.0) {
            if (std::abs(distance) > half[a]) return kNever;
            continue;
        }
        const double t0 = (distance - half[a]) / along, t1 = (distance + half[a]) / along;
        begin = std::max(begin, std::min(t0, t1));
        end = std::min(end, std::max(t0, t1));
    }
    return begin <= end ? static_cast<float>(begin) : kNever;
}

std::vector<AimBox> door_boxes(const Snapshot& scene) {
    std::vector<AimBox> boxes;
    for (uint32_t e = 0; e < scene.elements.size(); ++e) {
        if (scene.elements[e].kind != ElementKind::door) continue;
        uint32_t largest = kNoElement;
        float most = 0.0f;
        std::vector<float> area(scene.instances.size(), 0.0f);
        for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
            const uint32_t i = scene.triangles[t].instance;
            if (scene.instances[i].element != e || scene.instances[i].open_pose) continue;
            if ((area[i] += scene.area(t)) > most) most = area[i], largest = i;
        }
        if (largest == kNoElement) continue;
        AimBox box{e, DVec3(0.0), axes_of(scene.instances[largest].transform), DVec3(0.0)};
        fit(box, scene);
        boxes.push_back(box);
    }
    return boxes;
}

} // namespace ajar
