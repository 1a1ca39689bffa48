// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>

#include "package/manifest.h"

namespace ajar {

/// Content whose terms take their light from what the pages hold once packed. A door that starts open takes, as it
/// closes, light from the base, which packing has rounded by up to 0.8 % (blue 1.6 %): the rest would glow in a dark
/// room. Terms of one door or toggle alone are therefore scaled as the base was rounded, and what takes all of it takes
/// a little more than was stored, so that half floats leave nothing.
class RoundedContent {
public:
    /// content and its arrays must outlive it.
    explicit RoundedContent(const PackageContent& content);
    const PackageContent& content() const { return content_; }

private:
    PackageContent content_;
    std::deque<std::vector<float>> irradiance_; ///< of the terms that are changed
};

} // namespace ajar
