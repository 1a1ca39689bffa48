// SPDX-License-Identifier: GPL-3.0-or-later
#include "post/stitch.h"

namespace ajar {

namespace {

constexpr float kLambda = 0.1f; ///< pull towards the baked value; smaller darkens thin charts
constexpr int kIterations = 60;
constexpr double kTolerance = 1e-8; ///< of the squared residual

/// Difference of two bilinear reads, texels renumbered.
struct Row {
    uint32_t column[8];
    float weight[8];
};

} // namespace

struct SeamSolver::System {
    std::vector<Row> rows;
    std::vector<uint32_t> texel; ///< of each unknown

    // y = (A^T A + lambda) x
    void apply(const std::vector<Vec3>& x, std::vector<Vec3>& y) const {
        for (size_t i = 0; i < x.size(); ++i) y[i] = kLambda * x[i];
        for (const Row& r : rows) {
            Vec3 d(0.0f);
            for (int k = 0; k < 8; ++k) d += r.weight[k] * x[r.column[k]];
            for (int k = 0; k < 8; ++k) y[r.column[k]] += r.weight[k] * d;
        }
    }
    void build(const std::vector<SeamPoint>& seams, const std::vector<uint8_t>& usable);
    std::vector<Vec3> change(const std::vector<Vec3>& x0) const;
};

namespace {

bool touches_unusable(const BilinearTap& t, const std::vector<uint8_t>& usable) {
    for (int k = 0; k < 4; ++k)
        if (t.weight[k] > 1e-4f && usable[t.texel[k]] == 0) return true;
    return false;
}

glm::dvec3 dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    glm::dvec3 sum(0.0);
    for (size_t i = 0; i < a.size(); ++i) sum += glm::dvec3(a[i]) * glm::dvec3(b[i]);
    return sum;
}

Vec3 safe_ratio(const glm::dvec3& a, const glm::dvec3& b) {
    return Vec3(b.x > 0 ? a.x / b.x : 0, b.y > 0 ? a.y / b.y : 0, b.z > 0 ? a.z / b.z : 0);
}

} // namespace

void SeamSolver::System::build(const std::vector<SeamPoint>& seams, const std::vector<uint8_t>& usable) {
    std::vector<uint32_t> index(usable.size(), 0xffffffffu);
    const auto number = [&, this](uint32_t texel) {
        if (index[texel] == 0xffffffffu) {
            index[texel] = static_cast<uint32_t>(this->texel.size());
            this->texel.push_back(texel);
        }
        return index[texel];
    };
    for (const SeamPoint& p : seams) {
        if (touches_unusable(p.a, usable) || touches_unusable(p.b, usable)) continue;
        Row r{};
        for (int k = 0; k < 4; ++k) {
            const bool a = p.a.weight[k] > 1e-4f, b = p.b.weight[k] > 1e-4f;
            // A tap without weight points at the row's first texel, so that no stray one is moved.
            r.column[k] = number(a ? p.a.texel[k] : p.a.texel[0]);
            r.column[4 + k] = number(b ? p.b.texel[k] : p.b.texel[0]);
            r.weight[k] = a ? p.a.weight[k] : 0.0f;
            r.weight[4 + k] = b ? -p.b.weight[k] : 0.0f;
        }
        rows.push_back(r);
    }
}

/// Solves for the change of x, whose start is 0; the three channels run side by side.
std::vector<Vec3> SeamSolver::System::change(const std::vector<Vec3>& x0) const {
    const size_t n = x0.size();
    std::vector<Vec3> x(n, Vec3(0.0f)), r(n), p(n), q(n);
    apply(x0, q);
    for (size_t i = 0; i < n; ++i) p[i] = r[i] = kLambda * x0[i] - q[i];
    glm::dvec3 rr = dot(r, r);
    const glm::dvec3 goal = rr * kTolerance;
    for (int it = 0; it < kIterations && (rr.x > goal.x || rr.y > goal.y || rr.z > goal.z); ++it) {
        apply(p, q);
        const Vec3 alpha = safe_ratio(rr, dot(p, q));
        for (size_t i = 0; i < n; ++i) x[i] += alpha * p[i], r[i] -= alpha * q[i];
        const glm::dvec3 next = dot(r, r);
        const Vec3 beta = safe_ratio(next, rr);
        for (size_t i = 0; i < n; ++i) p[i] = r[i] + beta * p[i];
        rr = next;
    }
    return x;
}

SeamSolver::SeamSolver(const std::vector<SeamPoint>& seams, const std::vector<uint8_t>& usable)
    : system_(std::make_unique<System>()) {
    system_->build(seams, usable);
}

SeamSolver::~SeamSolver() = default;

uint64_t SeamSolver::points() const { return system_->rows.size(); }

void SeamSolver::solve(std::vector<Vec3>& value, bool may_be_negative) const {
    const Working here(Effect::seams);
    std::vector<Vec3> x0(system_->texel.size());
    for (size_t i = 0; i < x0.size(); ++i) x0[i] = value[system_->texel[i]];
    const std::vector<Vec3> change = system_->change(x0);
    for (size_t i = 0; i < x0.size(); ++i)
        value[system_->texel[i]] = may_be_negative ? x0[i] + change[i] : glm::max(x0[i] + change[i], Vec3(0.0f));
}

uint64_t stitch_seams(const std::vector<SeamPoint>& seams, const std::vector<uint8_t>& usable,
                      std::vector<Vec3>& value) {
    const SeamSolver solver(seams, usable);
    if (solver.points() != 0) solver.solve(value);
    return solver.points();
}

} // namespace ajar
