// SPDX-License-Identifier: GPL-3.0-or-later
#include "package/fill_terms.h"

#include <gtest/gtest.h>

namespace ajar {
namespace {

TEST(FillTerms, FilledTexelsFollowTheirSource) {
    // Texels 0 and 5 copy texel 1, texel 3 copies texel 4, which the second term does not keep.
    const std::vector<uint32_t> source = {1, 1, 2, 4, 4, 1};
    std::vector<BakedTerm> terms(2);
    terms[0].elements = {0};
    terms[0].texel = {1, 3, 4};
    terms[0].irradiance = {Vec3(1.0f), Vec3(3.0f), Vec3(4.0f)};
    terms[0].packed_direction = {10, 30, 40};
    terms[1].is_signed = true;
    terms[1].relative_error = 0.5f;
    terms[1].texel = {2, 3};
    terms[1].irradiance = {Vec3(-2.0f), Vec3(-3.0f)};
    terms[1].packed_direction = {20, 30};
    fill_terms(source, terms);
    EXPECT_EQ(terms[0].elements, std::vector<uint32_t>{0});
    EXPECT_EQ(terms[0].texel, (std::vector<uint32_t>{0, 1, 3, 4, 5}));
    EXPECT_EQ(terms[0].irradiance, (std::vector<Vec3>{Vec3(1.0f), Vec3(1.0f), Vec3(4.0f), Vec3(4.0f), Vec3(1.0f)}));
    EXPECT_EQ(terms[0].packed_direction, (std::vector<uint32_t>{10, 10, 40, 40, 10}));
    EXPECT_EQ(terms[1].texel, std::vector<uint32_t>{2}); // texel 3 gives way to its source
    EXPECT_TRUE(terms[1].is_signed);
    EXPECT_EQ(terms[1].relative_error, 0.5f);
}

TEST(FillTerms, NoTermsNoWork) {
    std::vector<BakedTerm> terms;
    fill_terms({0, 0}, terms);
    EXPECT_TRUE(terms.empty());
}

} // namespace
} // namespace ajar
