// SPDX-License-Identifier: GPL-3.0-or-later
#include "golden_measure.h"

#include <cmath>
#include <map>
#include <stdexcept>

namespace golden {

namespace {

constexpr double kRounding = 2e-5;   ///< relative; region means of float texels
constexpr double kFaintShare = 3e-4; ///< of the base's mean light

std::string product_name(const GoldenScene& scene, const std::vector<uint32_t>& product) {
    std::string name;
    for (const uint32_t e : product) name += (name.empty() ? "" : "*") + std::string(scene.elements[e].name);
    return name.empty() ? "base" : name;
}

/// Index of each term by its elements.
std::map<std::vector<uint32_t>, uint32_t> terms_by_product(const kit::Bake& bake) {
    std::map<std::vector<uint32_t>, uint32_t> out;
    const std::vector<ajar_term_info> terms = bake.terms();
    for (uint32_t t = 0; t < terms.size(); ++t)
        out[{terms[t].elements, terms[t].elements + terms[t].element_count}] = t;
    return out;
}

kit::Layer black(uint32_t width, uint32_t height) {
    return {width, height, 3, std::vector<float>(size_t{3} * width * height)};
}

double luminance(const kit::Layer& layer, uint32_t x, uint32_t y) {
    return 0.2126 * layer.at(x, y, 0) + 0.7152 * layer.at(x, y, 1) + 0.0722 * layer.at(x, y, 2);
}

/// Texels that were filled in count too: which those are depends on the rays, here and there.
bool covered(float validity) { return validity == 1.0f || validity == 0.5f; }

} // namespace

std::string Region::text() const {
    const std::string head = term + " page " + std::to_string(page);
    return whole ? head : head + " at " + std::to_string(x) + "," + std::to_string(y);
}

void Measurement::add_page(const kit::Layer& layer, const kit::Layer& validity, Region whole,
                           std::vector<Place>& places, std::vector<Color>& light) {
    std::map<std::pair<uint32_t, uint32_t>, size_t> blocks;
    const auto region = [&](Region r) {
        places.push_back({std::move(r), {}});
        light.push_back({});
        return places.size() - 1;
    };
    const size_t page = region(whole);
    for (uint32_t y = 0; y < layer.height; ++y)
        for (uint32_t x = 0; x < layer.width; ++x) {
            if (!covered(validity.at(x, y))) continue;
            if (next_texel_ == noise_.size()) noise_.emplace_back();
            noise_[next_texel_].add(luminance(layer, x, y));
            const auto corner = std::pair(x / scene_.block * scene_.block, y / scene_.block * scene_.block);
            auto at = blocks.find(corner);
            if (at == blocks.end())
                at = blocks.emplace(corner, region({whole.term, whole.page, corner.first, corner.second})).first;
            for (const size_t i : {page, at->second}) {
                places[i].texels.push_back(next_texel_);
                for (uint32_t c = 0; c < 3; ++c) light[i][c] += layer.at(x, y, c);
            }
            ++next_texel_;
        }
}

kit::Bake bake(const GoldenScene& scene, ajar_settings settings, uint32_t seed) {
    settings.seed = seed;
    return kit::Bake(scene.scene, settings);
}

void Measurement::add(const kit::Bake& bake) {
    const auto terms = terms_by_product(bake);
    std::vector<Place> places;
    std::vector<Color> light;
    next_texel_ = 0;
    for (const std::vector<uint32_t>& product : scene_.products())
        for (uint32_t p = 0; p < scene_.pages.size(); ++p) {
            const auto [width, height] = scene_.pages[p];
            const auto term = terms.find(product);
            const kit::Layer layer =
                term == terms.end() ? black(width, height) : bake.term(term->second, width, height, p);
            add_page(layer, bake.layer(AJAR_LAYER_VALIDITY, p), {product_name(scene_, product), p, 0, 0, true}, places,
                     light);
        }
    if (!places_.empty() && places != places_)
        throw std::runtime_error(scene_.name + ": covered texels depend on the seed");
    for (size_t i = 0; i < places.size(); ++i)
        for (double& v : light[i]) v /= static_cast<double>(std::max<size_t>(1, places[i].texels.size()));
    places_ = std::move(places);
    bakes_.push_back(std::move(light));
}

std::vector<RegionLight> Measurement::regions() const {
    std::vector<RegionLight> out;
    for (size_t i = 0; i < places_.size(); ++i) {
        RegionLight r{places_[i].region, static_cast<uint32_t>(places_[i].texels.size()), {}, {}, {}, 0.0};
        for (size_t c = 0; c < 3; ++c) {
            kit::Sample sample;
            for (const auto& bake : bakes_) sample.add(bake[i][c]);
            r.mean[c] = sample.mean();
            r.error[c] = sample.error();
            r.deviation[c] = std::sqrt(sample.variance());
        }
        for (const uint32_t t : places_[i].texels) r.noise += noise_[t].variance() / r.texels;
        out.push_back(r);
    }
    return out;
}

double faint_light(const std::vector<RegionLight>& golden) {
    double sum = 0.0, texels = 0.0;
    for (const RegionLight& g : golden) {
        if (!g.region.whole || g.region.term != "base") continue;
        sum += (g.mean[0] + g.mean[1] + g.mean[2]) / 3.0 * g.texels;
        texels += g.texels;
    }
    return kFaintShare * sum / texels;
}

double expected_deviation(const RegionLight& g, int c, double averaged, double faint) {
    const double bakes = g.deviation[c] / std::sqrt(averaged), rounding = kRounding * std::abs(g.mean[c]) + faint;
    return std::sqrt(bakes * bakes + g.error[c] * g.error[c] + rounding * rounding);
}

double chi_square(const std::vector<RegionLight>& golden, const std::vector<Color>& light, double averaged) {
    const double faint = faint_light(golden);
    double sum = 0.0;
    for (size_t i = 0; i < golden.size(); ++i)
        for (int c = 0; c < 3 && !golden[i].region.whole; ++c) {
            const double z = (light[i][c] - golden[i].mean[c]) / expected_deviation(golden[i], c, averaged, faint);
            sum += z * z;
        }
    return sum;
}

} // namespace golden
