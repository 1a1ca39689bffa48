// SPDX-License-Identifier: GPL-3.0-or-later
#include "golden_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

namespace golden {

namespace {

constexpr const char* kHeader = "ajar-golden-1";

std::ostream& operator<<(std::ostream& out, const Color& c) { return out << ' ' << c[0] << ' ' << c[1] << ' ' << c[2]; }
std::istream& operator>>(std::istream& in, Color& c) { return in >> c[0] >> c[1] >> c[2]; }

void average_noise(std::vector<RegionLight>& regions, const std::vector<Measurement>& groups) {
    std::vector<double> logs(regions.size(), 0.0);
    for (const Measurement& group : groups) {
        const std::vector<RegionLight> noisy = group.regions();
        for (size_t i = 0; i < noisy.size(); ++i) logs[i] += std::log(std::max(noisy[i].noise, kLeastNoise));
    }
    for (size_t i = 0; i < logs.size(); ++i) regions[i].noise = std::exp(logs[i] / static_cast<double>(groups.size()));
}

} // namespace

GoldenData join(const Measurement& fine, const Measurement& tested, const std::vector<Measurement>& groups) {
    GoldenData data{fine.count(), tested.count(), 0.0, 0.0, fine.regions()};
    const std::vector<RegionLight> noisy = tested.regions();
    if (noisy.size() != data.regions.size()) throw std::runtime_error("terms depend on the settings");
    for (size_t i = 0; i < noisy.size(); ++i) {
        RegionLight& r = data.regions[i];
        if (noisy[i].region != r.region || noisy[i].texels != r.texels)
            throw std::runtime_error("covered texels depend on the settings: " + r.region.text());
        r.deviation = noisy[i].deviation;
    }
    average_noise(data.regions, groups);
    kit::Sample chi;
    for (const auto& light : tested.bakes()) chi.add(chi_square(data.regions, light, 1.0));
    data.chi_mean = chi.mean();
    data.chi_variance = chi.variance();
    return data;
}

void write_golden(const GoldenData& data, const std::string& path) {
    std::ofstream out(path);
    out.precision(6);
    out << kHeader << '\n'
        << "# fine bakes, tested bakes, mean and variance of chi-square, regions; then per region: term, page,\n"
        << "# x, y, whole page, texels, mean RGB, its standard error RGB, deviation of one bake RGB,\n"
        << "# variance of a texel. Written by golden_make, see README.md.\n"
        << data.fine_bakes << ' ' << data.tested_bakes << ' ' << data.chi_mean << ' ' << data.chi_variance << ' '
        << data.regions.size() << '\n';
    for (const RegionLight& r : data.regions) {
        out << r.region.term << ' ' << r.region.page << ' ' << r.region.x << ' ' << r.region.y << ' ' << r.region.whole
            << ' ' << r.texels;
        out.precision(7);
        out << r.mean;
        out.precision(3);
        out << r.error << r.deviation;
        out.precision(6);
        out << ' ' << r.noise << '\n';
    }
    if (!out.flush()) throw std::runtime_error("cannot write " + path);
}

GoldenData read_golden(const std::string& path) {
    std::ifstream in(path);
    std::string line;
    if (!std::getline(in, line) || line != kHeader) throw std::runtime_error("no golden data in " + path);
    while (in.peek() == '#') std::getline(in, line);
    GoldenData data;
    size_t regions = 0;
    in >> data.fine_bakes >> data.tested_bakes >> data.chi_mean >> data.chi_variance >> regions;
    for (size_t i = 0; in && i < regions; ++i) {
        RegionLight r;
        in >> r.region.term >> r.region.page >> r.region.x >> r.region.y >> r.region.whole >> r.texels >> r.mean >>
            r.error >> r.deviation >> r.noise;
        data.regions.push_back(r);
    }
    if (!in || regions == 0) throw std::runtime_error("golden data end too early in " + path);
    return data;
}

} // namespace golden
