// SPDX-License-Identifier: GPL-3.0-or-later
// Hard cases, each as it is, a thousandth and a thousand times as large, ten kilometres away, under a million
// times the light, and with two threads: one number per case that must stay below a bound.
//
//     AJAR_HARD_TABLE=FILE.md build/release/bin/hard_suite_test     # also writes the numbers as a table
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "hard_case.h"

namespace hard {

/// For what GoogleTest says of a case.
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

} // namespace hard

namespace {

using hard::Case;
using kit::Variant;

const Variant kVariants[] = {{},
                             {.name = "/ 1000", .scale = 1e-3f},
                             {.name = "* 1000", .scale = 1e3f},
                             {.name = "10 km away", .away = 1e4},
                             {.name = "light * 1e6", .light = 1e6},
                             {.name = "2 threads", .threads = 2}};

std::vector<Case> all_cases() {
    std::vector<Case> out;
    for (const auto cases :
         {hard::geometry_cases, hard::lamp_cases, hard::element_cases, hard::switch_cases, hard::door_cases,
          hard::set_cases, hard::leak_cases, hard::unmapped_cases, hard::layer_cases, hard::near_cases,
          hard::range_cases, hard::furnace_cases, hard::side_cases, hard::hall_cases, hard::hole_cases})
        for (const Case& c : cases()) out.push_back(c);
    return out;
}

std::map<std::string, std::map<std::string, double>> table; ///< numbers by case and variant

class HardSuite : public testing::TestWithParam<Case> {};

/// All variants in one test: to start a process takes longer than most of them.
TEST_P(HardSuite, StaysInBounds) {
    const Case& c = GetParam();
    for (const Variant& v : kVariants) {
        const double measured = c.measure(v);
        table[c.name][v.name] = measured;
        EXPECT_LE(measured, c.bound) << c.name << ", " << v.name << ": " << c.number;
    }
}

/// "wall of 5 mm" as Wall_of_5_mm would be in a test's name.
std::string test_name(const testing::TestParamInfo<Case>& info) {
    std::string name = info.param.name;
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(All, HardSuite, testing::ValuesIn(all_cases()), test_name);

const char* name_of(hard::Origin origin) {
    return origin == hard::Origin::kBase ? "base" : origin == hard::Origin::kReport ? "reported" : "sibling";
}

/// Writes what was measured, if asked to.
class TableWriter : public testing::Environment {
    void TearDown() override {
        const char* path = std::getenv("AJAR_HARD_TABLE");
        std::FILE* file = path != nullptr ? std::fopen(path, "w") : nullptr;
        if (file == nullptr) return;
        std::fprintf(file, "| kind | origin | case | what breaks naive bakers | number | bound |");
        for (const Variant& v : kVariants) std::fprintf(file, " %s |", v.name);
        std::fprintf(file, "\n|---|---|---|---|---|---|");
        for (size_t i = 0; i < std::size(kVariants); ++i) std::fprintf(file, "---|");
        for (const Case& c : all_cases()) {
            std::fprintf(file, "\n| %s | %s | %s | %s | %s | %g |", c.kind, name_of(c.origin), c.name, c.trap, c.number,
                         c.bound);
            for (const Variant& v : kVariants) std::fprintf(file, " %.2g |", table[c.name][v.name]);
        }
        std::fprintf(file, "\n");
        std::fclose(file);
    }
};
[[maybe_unused]] const testing::Environment* const kWriter = testing::AddGlobalTestEnvironment(new TableWriter);

} // namespace
