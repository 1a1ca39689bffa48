// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "ajar/ajar.h"

namespace ajar {

/// A failure that reaches the caller of the ABI as code, message and culprit.
class Error : public std::runtime_error {
public:
    Error(ajar_result code, const std::string& message, std::string culprit = {})
        : std::runtime_error(message), code_(code), culprit_(std::move(culprit)) {}
    ajar_result code() const { return code_; }
    /// Name of the object, image or file at fault; empty if there is none.
    const std::string& culprit() const { return culprit_; }

private:
    ajar_result code_;
    std::string culprit_;
};

/// Something wrong that was worked around; told to the artist by name.
struct Warning {
    std::string culprit;
    std::string text;
};

/// English text of a result code, static storage.
const char* result_text(ajar_result code);

} // namespace ajar
