// SPDX-License-Identifier: GPL-3.0-or-later
#include "post/stitch.h"

#include <algorithm>
#include <numeric>

#include "base/disjoint_set.h"

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

/// Seam points that hang together by the texels they read, and those texels.
struct Piece {
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
    std::vector<Vec3> change(const std::vector<Vec3>& x0) const;
};

constexpr uint32_t kNowhere = 0xffffffffu;

} // namespace

struct SeamSolver::System {
    std::vector<Piece> pieces;
    std::vector<uint32_t> piece, unknown; ///< per page texel; kNowhere: no seam reads it
    uint64_t points = 0;

    void build(const std::vector<SeamPoint>& seams, const std::vector<uint8_t>& usable);
    void share_out(const std::vector<Row>& rows, const std::vector<uint32_t>& texel);
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
    std::vector<uint32_t> texels;
    std::vector<Row> rows;
    unknown.assign(usable.size(), kNowhere);
    const auto number = [&](uint32_t texel) {
        if (unknown[texel] == kNowhere) {
            unknown[texel] = static_cast<uint32_t>(texels.size());
            texels.push_back(texel);
        }
        return unknown[texel];
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
    points = rows.size();
    share_out(rows, texels);
}

/// Numbers the unknowns anew, within the piece they belong to.
void SeamSolver::System::share_out(const std::vector<Row>& rows, const std::vector<uint32_t>& texel) {
    DisjointSet groups(texel.size());
    for (const Row& r : rows)
        for (int k = 1; k < 8; ++k) groups.join(r.column[0], r.column[k]);
    std::vector<uint32_t> piece_of(texel.size(), kNowhere);
    piece.assign(unknown.size(), kNowhere);
    for (uint32_t i = 0; i < texel.size(); ++i) {
        uint32_t& p = piece_of[groups.root(i)];
        if (p == kNowhere) {
            p = static_cast<uint32_t>(pieces.size());
            pieces.emplace_back();
        }
        unknown[texel[i]] = static_cast<uint32_t>(pieces[p].texel.size());
        pieces[p].texel.push_back(texel[i]);
        piece[texel[i]] = p;
    }
    for (Row r : rows) {
        Piece& p = pieces[piece[texel[r.column[0]]]];
        for (uint32_t& c : r.column) c = unknown[texel[c]];
        p.rows.push_back(r);
    }
}

/// Solves for the change of x, whose start is 0; the three channels run side by side.
std::vector<Vec3> Piece::change(const std::vector<Vec3>& x0) const {
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

uint64_t SeamSolver::points() const { return system_->points; }

void SeamSolver::solve(std::vector<Vec3>& value) const {
    std::vector<uint32_t> all(value.size());
    std::iota(all.begin(), all.end(), 0u);
    solve(all, value, false);
}

void SeamSolver::solve(std::span<const uint32_t> texel, std::span<Vec3> value, bool may_be_negative) const {
    const Working here(Effect::seams);
    std::vector<std::pair<uint32_t, uint32_t>> on_seams; // piece, place in value
    for (uint32_t i = 0; i < texel.size(); ++i)
        if (const uint32_t p = system_->piece[texel[i]]; p != kNowhere) on_seams.emplace_back(p, i);
    std::sort(on_seams.begin(), on_seams.end());
    for (auto begin = on_seams.begin(), end = begin; begin != on_seams.end(); begin = end) {
        const Piece& piece = system_->pieces[begin->first];
        std::vector<Vec3> x0(piece.texel.size(), Vec3(0.0f));
        for (; end != on_seams.end() && end->first == begin->first; ++end)
            x0[system_->unknown[texel[end->second]]] = value[end->second];
        const std::vector<Vec3> change = piece.change(x0);
        for (auto k = begin; k != end; ++k) {
            Vec3& v = value[k->second];
            v += change[system_->unknown[texel[k->second]]];
            if (!may_be_negative) v = glm::max(v, Vec3(0.0f));
        }
    }
}

uint64_t stitch_seams(const std::vector<SeamPoint>& seams, const std::vector<uint8_t>& usable,
                      std::vector<Vec3>& value) {
    const SeamSolver solver(seams, usable);
    if (solver.points() != 0) solver.solve(value);
    return solver.points();
}

} // namespace ajar
