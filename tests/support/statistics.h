// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Distributions that tests compare counts and means with. Series and continued fractions after
// Abramowitz and Stegun 6.5.29, 6.5.31 and 26.5.8.

#include <cmath>
#include <limits>
#include <vector>

namespace kit {

namespace detail {

/// Evaluates the continued fraction 1 / (b0 + a1 / (b1 + a2 / ...)) by Lentz's method.
template <class A, class B>
double continued_fraction(A a, B b) {
    constexpr double kTiny = 1e-300;
    double d = 1.0 / b(0), c = 1.0 / kTiny, f = d;
    for (int i = 1; i < 100000; ++i) {
        d = b(i) + a(i) * d;
        c = b(i) + a(i) / c;
        d = 1.0 / (std::abs(d) < kTiny ? kTiny : d);
        f *= c * d;
        if (std::abs(c * d - 1.0) < 1e-15) break;
    }
    return f;
}

inline double beta_fraction(double a, double b, double x) {
    const auto term = [&](int i) {
        const double m = i / 2;
        return i % 2 == 0 ? m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
                          : -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    };
    return continued_fraction(term, [](int) { return 1.0; });
}

} // namespace detail

/// Chance that a chi-square variable with this many degrees of freedom exceeds x.
inline double chi_square_tail(double x, double freedom) {
    const double a = 0.5 * freedom, h = 0.5 * x;
    if (h <= 0.0) return 1.0;
    const double scale = std::exp(a * std::log(h) - h - std::lgamma(a));
    if (h >= a + 1.0)
        return scale *
               detail::continued_fraction([&](int i) { return i * (a - i); }, [&](int i) { return h + 2 * i + 1 - a; });
    double sum = 1.0 / a, term = sum;
    for (int i = 1; term > 1e-16 * sum; ++i) sum += term *= h / (a + i);
    return 1.0 - scale * sum;
}

/// Chance that a Student t variable is further from 0 than t, on either side.
inline double student_tail(double t, double freedom) {
    const double x = freedom / (freedom + t * t), a = 0.5 * freedom, b = 0.5;
    if (!(x < 1.0)) return 1.0;
    const double log_scale =
        std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x);
    if (x < (a + 1) / (a + b + 2)) return std::exp(log_scale) * detail::beta_fraction(a, b, x) / a;
    return 1.0 - std::exp(log_scale) * detail::beta_fraction(b, a, 1.0 - x) / b;
}

/// Chance level of each of count independent tests that together raise a false alarm with chance
/// alpha (Sidak).
inline double sidak(double alpha, double count) { return -std::expm1(std::log1p(-alpha) / count); }

/// Pearson's test: chance of counts at least as far from expected as these. Cells that expect
/// fewer than 5 are pooled; a hit where nothing is expected gives 0.
inline double chi_square_test(const std::vector<double>& counts, const std::vector<double>& expected) {
    double chi = 0.0, rare_count = 0.0, rare_expected = 0.0;
    int cells = 0;
    const auto add = [&](double count, double wanted) {
        if (wanted > 0.0)
            chi += (count - wanted) * (count - wanted) / wanted, ++cells;
        else if (count > 0.0)
            chi = std::numeric_limits<double>::infinity();
    };
    for (size_t i = 0; i < counts.size(); ++i) {
        if (expected[i] >= 5.0 || expected[i] == 0.0)
            add(counts[i], expected[i]);
        else
            rare_count += counts[i], rare_expected += expected[i];
    }
    if (rare_expected > 0.0) add(rare_count, rare_expected);
    return std::isfinite(chi) ? chi_square_tail(chi, cells - 1) : 0.0;
}

/// Mean, variance and standard error of the mean of numbers that arrive one by one (Welford).
class Sample {
public:
    void add(double v) {
        ++count_;
        const double d = v - mean_;
        mean_ += d / count_;
        squares_ += d * (v - mean_);
    }
    double count() const { return count_; }
    double mean() const { return mean_; }
    double variance() const { return count_ > 1 ? squares_ / (count_ - 1) : 0.0; }
    double error() const { return std::sqrt(variance() / count_); }

private:
    double count_ = 0.0, mean_ = 0.0, squares_ = 0.0;
};

} // namespace kit
