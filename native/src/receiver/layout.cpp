// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/layout.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>

#include "receiver/layout_mesh.h"

namespace ajar {
namespace {

constexpr int kFineShrinks = 12; ///< density steps of kShrink before larger ones
constexpr double kCoarseShrink = 0.75;
constexpr double kShrink = 0.93;     ///< density step while an object does not fit
constexpr double kTestAlone = 0.6;   ///< share of a page above which an object is tested alone first
constexpr double kExtentShare = 0.7; ///< of the page edge: longest chart grown; its diagonal still fits

std::string density_text(double reached, double wanted, uint32_t edge) {
    char text[200];
    std::snprintf(
        text, sizeof text,
        "does not fit into a page of %u x %u texels at %.3g texels per metre; %.3g texels per metre were reached", edge,
        edge, wanted, reached);
    return text;
}

/// A mesh on its way: charts, then their places inside the mesh's own rectangle if it is shared.
struct Work {
    UnwrappedMesh unwrapped;
    double density = 1.0;             ///< of all charts, reduced until the mesh fits
    std::vector<TexelFit> fits;       ///< per chart
    std::vector<Placement> local;     ///< per chart, shared meshes only
    glm::dvec2 local_size{0.0};       ///< texels
    double local_density = 1.0;       ///< of the local rectangle: that of the coarsest user
    std::vector<double> user_density; ///< per user of a shared mesh, relative to the local rectangle
    uint32_t first_group = 0, first_item = 0;
    int shrinks = 0;

    bool shared() const { return unwrapped.user_factor.size() > 1; }
    const std::vector<Chart>& charts() const { return unwrapped.charts.charts; }
};

} // namespace

struct Layout::Impl {
    ajar_layout_settings settings;
    std::vector<LayoutMesh> meshes;
    std::vector<Work> work;
    std::vector<Warning> warnings;
    std::vector<std::vector<float>> uv;
    std::vector<std::vector<LayoutUser>> users;
    PagePlan plan;
    std::deque<Footprint> shapes; ///< a deque: items point into it
    std::vector<PackItem> items;
    bool done = false;

    double usable_edge() const { return double(settings.atlas_size) - 2.0 * settings.padding; }

    template <typename Body>
    static void each_corner(const LayoutMesh& mesh, const Chart& chart, Body&& body) {
        for (uint32_t f : chart.polygons) body(mesh.polygon_start[f], mesh.polygon_size[f]);
    }

    /// Draws a chart's polygons, mapped by `place`, into bits.
    template <typename Place>
    static void draw_chart(const LayoutMesh& mesh, const Work& w, size_t chart, BitRows& bits, Place&& place) {
        std::vector<glm::dvec2> polygon;
        each_corner(mesh, w.charts()[chart], [&](uint32_t start, uint32_t size) {
            polygon.clear();
            for (uint32_t i = 0; i < size; ++i) polygon.push_back(place(w.unwrapped.charts.corner_uv[start + i]));
            cover_polygon(polygon, bits);
        });
    }

    void add_item(Footprint shape, bool may_turn, uint32_t group) {
        shapes.push_back(std::move(shape));
        PackItem item{&shapes.back(), nullptr, group};
        if (may_turn && item.shape->width() > 0) {
            shapes.push_back(item.shape->turned());
            item.turned = &shapes.back();
        }
        items.push_back(item);
    }

    /// One item per chart at the work's density.
    void add_charts(const LayoutMesh& mesh, Work& w, double density, uint32_t group) {
        w.fits.clear();
        for (size_t c = 0; c < w.charts().size(); ++c) {
            const TexelFit fit(w.charts()[c].size, density);
            BitRows bits(fit.width, fit.height);
            draw_chart(mesh, w, c, bits, [&](const glm::dvec2& uv) { return fit.apply(uv); });
            if (bits.count() == 0) bits.set(0, 0); // a point still needs its texel
            w.fits.push_back(fit);
            add_item(Footprint(std::move(bits)), true, group);
        }
    }

    /// Reduces w.density until no chart exceeds a page and the areas can fit, before anything is drawn.
    void limit_density(Work& w) const {
        double longest = 0.0, area = 0.0;
        for (const Chart& chart : w.charts()) {
            longest = std::max({longest, chart.size.x, chart.size.y});
            area += chart.area;
        }
        w.density =
            std::min({1.0, usable_edge() / std::max(longest, 1e-9), usable_edge() / std::sqrt(std::max(area, 1e-9))});
    }

    /// Takes a density step, or gives up if every chart is down to one texel.
    void shrink(const LayoutMesh& mesh, Work& w) const {
        const auto least = [](const TexelFit& fit) { return fit.width == 1 && fit.height == 1; };
        if (std::all_of(w.fits.begin(), w.fits.end(), least))
            throw Error(
                AJAR_ERROR_INPUT,
                "Mesh \"" + mesh.name + "\" has " + std::to_string(w.fits.size()) +
                    " charts, more than one lightmap page takes. Split it, raise the page size or lower the padding.",
                mesh.name);
        w.density *= w.shrinks++ < kFineShrinks ? kShrink : kCoarseShrink;
    }

    /// Packs a shared mesh into a rectangle of its own, at the density of its coarsest user so that
    /// padding suffices for all.
    void pack_local(const LayoutMesh& mesh, Work& w) {
        const std::vector<double>& factor = w.unwrapped.user_factor;
        const double coarsest = *std::min_element(factor.begin(), factor.end());
        const bool mixed = *std::max_element(factor.begin(), factor.end()) > coarsest * 1.0001;
        const uint32_t padding = settings.padding + (mixed ? 1 : 0); // scaled texels no longer align
        for (PagePlan local;; shrink(mesh, w)) {
            items.clear();
            shapes.clear();
            w.local_density = w.density * coarsest;
            add_charts(mesh, w, w.local_density, 0);
            local = plan_pages(items, 1, settings.atlas_size, padding);
            if (!local.failed.empty()) continue;
            place_local(w, local, int(padding));
            break;
        }
        w.user_density.clear();
        for (double f : factor)
            w.user_density.push_back(std::min(f / coarsest, usable_edge() / std::max(w.local_size.x, w.local_size.y)));
    }

    static void place_local(Work& w, const PagePlan& local, int padding) {
        w.local.clear();
        w.local_size = glm::dvec2(0.0);
        for (size_t c = 0; c < w.fits.size(); ++c) {
            Placement at = local.items[c].at;
            at.x -= padding;
            at.y -= padding;
            const TexelFit& fit = w.fits[c];
            const glm::dvec2 size = at.turned ? glm::dvec2(fit.height, fit.width) : glm::dvec2(fit.width, fit.height);
            w.local_size = glm::max(w.local_size, glm::dvec2(at.x, at.y) + size);
            w.local.push_back(at);
        }
    }

    /// One item per user: the mesh's rectangle at the user's density. It may not turn, because a
    /// user only has a scale and an offset.
    void add_users(const LayoutMesh& mesh, Work& w) {
        for (size_t u = 0; u < w.user_density.size(); ++u) {
            const TexelFit fit(w.local_size, w.user_density[u]);
            BitRows bits(fit.width, fit.height);
            for (size_t c = 0; c < w.charts().size(); ++c)
                draw_chart(mesh, w, c, bits, [&](const glm::dvec2& uv) {
                    return fit.apply(on_page(w.local[c], w.fits[c].height, w.fits[c].apply(uv)));
                });
            add_item(Footprint(std::move(bits)), false, w.first_group + uint32_t(u));
        }
    }

    uint32_t add_all_items() {
        items.clear();
        shapes.clear();
        uint32_t groups = 0;
        for (size_t m = 0; m < meshes.size(); ++m) {
            Work& w = work[m];
            w.first_group = groups;
            w.first_item = uint32_t(items.size());
            if (w.shared())
                add_users(meshes[m], w);
            else
                add_charts(meshes[m], w, w.density, groups);
            groups += uint32_t(meshes[m].users.size());
        }
        return groups;
    }

    /// Shrinks a large object with one user until it fits into an empty page.
    void fit_alone(const LayoutMesh& mesh, Work& w) {
        for (;; shrink(mesh, w)) {
            items.clear();
            shapes.clear();
            add_charts(mesh, w, w.density, 0);
            double area = 0.0;
            bool large = false;
            for (const PackItem& item : items) {
                area += double(item.shape->width()) * item.shape->height();
                large |= std::max(item.shape->width(), item.shape->height()) > kTestAlone * settings.atlas_size;
            }
            if (!large && area < kTestAlone * settings.atlas_size * settings.atlas_size) return;
            if (plan_pages(items, 1, settings.atlas_size, settings.padding).failed.empty()) return;
        }
    }

    void unwrap_all() {
        for (const LayoutMesh& mesh : meshes) {
            Work w;
            w.unwrapped =
                unwrap_mesh(mesh, settings.texels_per_meter, settings.chart_angle, kExtentShare * usable_edge());
            report_unwrap(mesh, w.unwrapped.charts, warnings);
            limit_density(w);
            if (!w.charts().empty()) {
                if (w.shared())
                    pack_local(mesh, w);
                else
                    fit_alone(mesh, w);
            } else {
                warnings.push_back({mesh.name, "has no polygons to light"});
                w.unwrapped.user_factor.resize(1); // nothing to place for any user
            }
            work.push_back(std::move(w));
        }
    }

    void pack_all() {
        for (;;) {
            const uint32_t groups = add_all_items();
            plan = plan_pages(items, groups, settings.atlas_size, settings.padding);
            if (plan.failed.empty()) return;
            for (uint32_t group : plan.failed) shrink_group(group);
        }
    }

    void shrink_group(uint32_t group) {
        for (size_t m = 0; m < meshes.size(); ++m) {
            Work& w = work[m];
            if (group < w.first_group || group >= w.first_group + meshes[m].users.size()) continue;
            if (w.shared())
                w.user_density[group - w.first_group] *= kShrink;
            else
                shrink(meshes[m], w);
        }
    }

    glm::dvec2 page_texels(uint32_t page) const { return {plan.pages[page].width, plan.pages[page].height}; }

    void write_mesh(size_t m) {
        const LayoutMesh& mesh = meshes[m];
        Work& w = work[m];
        std::vector<float>& out = uv[m];
        out.assign(mesh.corner_vertex.size() * 2, 0.0f);
        for (size_t c = 0; c < w.charts().size(); ++c) {
            const ItemPlace place = w.shared() ? ItemPlace{0, w.local[c]} : plan.items[w.first_item + c];
            const glm::dvec2 whole = w.shared() ? w.local_size : page_texels(place.page);
            each_corner(mesh, w.charts()[c], [&](uint32_t start, uint32_t size) {
                for (uint32_t corner = start; corner < start + size; ++corner) {
                    const glm::dvec2 inside = w.fits[c].apply(w.unwrapped.charts.corner_uv[corner]);
                    const glm::dvec2 p = on_page(place.at, w.fits[c].height, inside) / whole;
                    out[2 * size_t(corner)] = float(std::clamp(p.x, 0.0, 1.0));
                    out[2 * size_t(corner) + 1] = float(std::clamp(p.y, 0.0, 1.0));
                }
            });
        }
    }

    void write_users(size_t m) {
        const Work& w = work[m];
        for (uint32_t u = 0; u < meshes[m].users.size(); ++u) {
            LayoutUser result;
            const double wanted = settings.texels_per_meter * meshes[m].users[u].texel_scale;
            double reached = w.density;
            if (w.shared()) {
                const ItemPlace& place = plan.items[w.first_item + u];
                const TexelFit fit(w.local_size, w.user_density[u]);
                const glm::dvec2 page = page_texels(place.page);
                const glm::dvec2 scale = w.local_size * fit.scale / page;
                const glm::dvec2 offset = (glm::dvec2(place.at.x, place.at.y) + fit.offset) / page;
                result.page = place.page;
                for (int i = 0; i < 2; ++i) {
                    result.scale[i] = float(scale[i]);
                    result.offset[i] = float(offset[i]);
                }
                reached = w.local_density * w.user_density[u] / w.unwrapped.user_factor[u];
            } else if (!w.charts().empty()) {
                result.page = plan.items[w.first_item].page;
            }
            result.texels_per_meter = float(wanted * reached);
            if (reached < 0.999)
                warnings.push_back({meshes[m].name, density_text(wanted * reached, wanted, settings.atlas_size)});
            users[m].push_back(result);
        }
    }

    void need_done() const {
        if (!done) throw Error(AJAR_ERROR_STATE, "the lightmap layout has not been run yet");
    }
    void need_mesh(uint32_t mesh) const {
        need_done();
        if (mesh >= meshes.size())
            throw Error(AJAR_ERROR_ARGUMENT, "no mesh " + std::to_string(mesh) + " in the layout");
    }
};

Layout::Layout(const ajar_layout_settings& settings) : impl_(std::make_unique<Impl>()) {
    const auto bad = [](const char* what) { throw Error(AJAR_ERROR_ARGUMENT, what); };
    if (!(settings.texels_per_meter > 0.0f) || !std::isfinite(settings.texels_per_meter))
        bad("texels_per_meter must be positive");
    if (settings.atlas_size < 16 || settings.atlas_size > 16384) bad("atlas_size must be 16 to 16384 texels");
    if (settings.padding > 64 || 4 * settings.padding >= settings.atlas_size)
        bad("padding must be 0 to 64 texels and small against atlas_size");
    if (!(settings.chart_angle >= 0.0f && settings.chart_angle <= 1.5f)) bad("chart_angle must be 0 to 1.5 radians");
    impl_->settings = settings;
}

Layout::~Layout() = default;
Layout::Layout(Layout&&) noexcept = default;
Layout& Layout::operator=(Layout&&) noexcept = default;

uint32_t Layout::add_mesh(const ajar_layout_mesh_desc& desc) {
    if (impl_->done) throw Error(AJAR_ERROR_STATE, "the lightmap layout has already been run");
    impl_->meshes.push_back(copy_layout_mesh(desc));
    return uint32_t(impl_->meshes.size() - 1);
}

void Layout::run() {
    Impl& impl = *impl_;
    if (impl.done) throw Error(AJAR_ERROR_STATE, "the lightmap layout has already been run");
    impl.work.clear();
    impl.warnings.clear();
    impl.unwrap_all();
    impl.pack_all();
    impl.uv.resize(impl.meshes.size());
    impl.users.assign(impl.meshes.size(), {});
    for (size_t m = 0; m < impl.meshes.size(); ++m) {
        impl.write_mesh(m);
        impl.write_users(m);
    }
    impl.work.clear();
    impl.items.clear();
    impl.shapes.clear();
    impl.done = true;
}

uint32_t Layout::page_count() const {
    impl_->need_done();
    return uint32_t(impl_->plan.pages.size());
}

PageSize Layout::page_size(uint32_t page) const {
    impl_->need_done();
    if (page >= impl_->plan.pages.size())
        throw Error(AJAR_ERROR_ARGUMENT, "no page " + std::to_string(page) + " in the layout");
    return impl_->plan.pages[page];
}

std::span<const float> Layout::mesh_uv(uint32_t mesh) const {
    impl_->need_mesh(mesh);
    return impl_->uv[mesh];
}

LayoutUser Layout::user(uint32_t mesh, uint32_t user) const {
    impl_->need_mesh(mesh);
    if (user >= impl_->users[mesh].size())
        throw Error(AJAR_ERROR_ARGUMENT, "no such user of the mesh", impl_->meshes[mesh].name);
    return impl_->users[mesh][user];
}

const std::vector<Warning>& Layout::warnings() const { return impl_->warnings; }

} // namespace ajar
