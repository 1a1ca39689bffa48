// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/page_plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ajar {
namespace {

constexpr double kFillGuess = 0.97;  ///< share of a page first filled with padded footprints
constexpr size_t kManyItems = 30000; ///< beyond this only one page width is tried
constexpr int kRepacks = 6;          ///< tries to fill a page before smaller groups are dropped

uint32_t round_up_4(uint32_t value) { return (value + 3u) & ~3u; }

class Planner {
public:
    Planner(const std::vector<PackItem>& items, uint32_t group_count, uint32_t max_edge, uint32_t padding)
        : items_(items),
          edge_(int(max_edge)),
          padding_(int(padding)),
          groups_(group_count),
          group_area_(group_count, 0.0) {
        plan_.items.resize(items.size());
        for (uint32_t i = 0; i < items.size(); ++i) {
            groups_[items[i].group].push_back(i);
            group_area_[items[i].group] += padded_area(*items[i].shape);
        }
        for (uint32_t g = 0; g < group_count; ++g)
            if (!groups_[g].empty()) waiting_.push_back(g);
        std::stable_sort(waiting_.begin(), waiting_.end(),
                         [&](uint32_t a, uint32_t b) { return group_area_[a] > group_area_[b]; });
    }

    PagePlan run() {
        while (!waiting_.empty()) {
            if (!last_page()) full_page();
        }
        return std::move(plan_);
    }

private:
    struct Attempt {
        PagePacker page;
        std::vector<std::pair<uint32_t, Placement>> placed;
        std::vector<uint32_t> failed_groups;
    };

    /// Texels a footprint takes with half of the padding around it.
    double padded_area(const Footprint& shape) const {
        const double outline = shape.width() + shape.height();
        return double(shape.mask().count()) + outline * padding_ + padding_ * padding_;
    }

    double total_area(const std::vector<uint32_t>& groups) const {
        double sum = 0.0;
        for (uint32_t g : groups) sum += group_area_[g];
        return sum;
    }

    /// Large and long items first.
    std::vector<uint32_t> pack_order(const std::vector<uint32_t>& groups) const {
        std::vector<uint32_t> order;
        for (uint32_t g : groups) order.insert(order.end(), groups_[g].begin(), groups_[g].end());
        const auto key = [&](uint32_t i) {
            const Footprint& s = *items_[i].shape;
            return std::max(s.width(), s.height()) * 2 + std::min(s.width(), s.height());
        };
        std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
            const int ka = key(a), kb = key(b);
            return ka != kb ? ka > kb : a < b;
        });
        return order;
    }

    /// Packs the groups' items into attempt.page; a group that fails is left out from there on.
    void pack(const std::vector<uint32_t>& groups, Attempt& attempt, bool all_or_nothing) const {
        std::vector<uint8_t> failed(groups_.size(), 0);
        for (uint32_t i : pack_order(groups)) {
            const PackItem& item = items_[i];
            if (failed[item.group]) continue;
            if (const auto at = attempt.page.place(*item.shape, item.turned)) {
                attempt.placed.emplace_back(i, *at);
                continue;
            }
            failed[item.group] = 1;
            attempt.failed_groups.push_back(item.group);
            if (all_or_nothing) return;
        }
    }

    Attempt pack_page(const std::vector<uint32_t>& groups, int width, bool all_or_nothing) const {
        Attempt attempt{PagePacker(width, edge_, padding_), {}, {}};
        pack(groups, attempt, all_or_nothing);
        return attempt;
    }

    /// If all that waits fits into one page: the smallest of several page widths.
    bool last_page() {
        const double area = total_area(waiting_);
        if (area > double(edge_) * edge_) return false;
        size_t count = 0;
        for (uint32_t g : waiting_) count += groups_[g].size();
        std::vector<double> widths{1.0, 0.86, 1.16, 1.35, 0.74};
        if (count > kManyItems) widths.resize(1);
        std::optional<Attempt> best;
        int tried = 0;
        for (double factor : widths) {
            const int width = page_width(factor * std::sqrt(area));
            if (width == tried) continue;
            tried = width;
            Attempt attempt = pack_page(waiting_, width, true);
            if (attempt.failed_groups.empty() && (!best || page_area(attempt) < page_area(*best)))
                best.emplace(std::move(attempt));
        }
        if (!best) {
            Attempt attempt = pack_page(waiting_, edge_, true);
            if (!attempt.failed_groups.empty()) return false;
            best.emplace(std::move(attempt));
        }
        emit(*best, true);
        return true;
    }

    int page_width(double wanted) const {
        int widest = 0;
        for (uint32_t g : waiting_)
            for (uint32_t i : groups_[g]) {
                const Footprint& s = *items_[i].shape;
                widest = std::max(widest, items_[i].turned ? std::min(s.width(), s.height()) : s.width());
            }
        const int least = widest + 2 * padding_;
        return std::min(edge_, int(round_up_4(uint32_t(std::max(least, int(std::ceil(wanted)))))));
    }

    static double page_area(const Attempt& attempt) {
        return double(round_up_4(uint32_t(attempt.page.used_width()))) *
               double(round_up_4(uint32_t(attempt.page.used_height())));
    }

    /// Fills one page of the largest size with as much of what waits as it takes.
    void full_page() {
        std::vector<uint32_t> chosen;
        double area = 0.0;
        for (uint32_t g : waiting_)
            if (chosen.empty() || area + group_area_[g] <= kFillGuess * edge_ * edge_) {
                chosen.push_back(g);
                area += group_area_[g];
            }
        Attempt attempt = pack_page(chosen, edge_, false);
        for (int tries = 0; !attempt.failed_groups.empty(); ++tries) {
            if (chosen.size() == 1) {
                plan_.failed.push_back(chosen[0]);
                std::erase(waiting_, chosen[0]);
                return;
            }
            if (tries < kRepacks) {
                std::erase(chosen, attempt.failed_groups.back()); // the last to fail missed by the least
            } else {
                chosen.resize((chosen.size() + 1) / 2);
            }
            attempt = pack_page(chosen, edge_, false);
        }
        fill_gaps(chosen, attempt);
        emit(attempt, false);
    }

    /// Tries the groups that still wait one by one in what is left of a page.
    void fill_gaps(const std::vector<uint32_t>& chosen, Attempt& attempt) const {
        double left = double(edge_) * edge_ - total_area(chosen);
        for (uint32_t g : waiting_) {
            if (std::find(chosen.begin(), chosen.end(), g) != chosen.end() || group_area_[g] > left) continue;
            Attempt next = attempt;
            pack({g}, next, true);
            if (!next.failed_groups.empty()) continue;
            left -= group_area_[g];
            attempt = std::move(next);
        }
    }

    void emit(const Attempt& attempt, bool shrink) {
        const uint32_t page = uint32_t(plan_.pages.size()), edge = uint32_t(edge_);
        const uint32_t width = std::min(round_up_4(uint32_t(attempt.page.used_width())), edge);
        const uint32_t height = std::min(round_up_4(uint32_t(attempt.page.used_height())), edge);
        plan_.pages.push_back(shrink ? PageSize{width, height} : PageSize{edge, edge});
        std::vector<uint8_t> done(groups_.size(), 0);
        for (const auto& [item, at] : attempt.placed) {
            plan_.items[item] = {page, at};
            done[items_[item].group] = 1;
        }
        std::erase_if(waiting_, [&](uint32_t g) { return done[g] != 0; });
    }

    const std::vector<PackItem>& items_;
    int edge_, padding_;
    std::vector<std::vector<uint32_t>> groups_;
    std::vector<double> group_area_;
    std::vector<uint32_t> waiting_; ///< groups without a page, largest first
    PagePlan plan_;
};

} // namespace

PagePlan plan_pages(const std::vector<PackItem>& items, uint32_t group_count, uint32_t max_edge, uint32_t padding) {
    return Planner(items, group_count, max_edge, padding).run();
}

} // namespace ajar
