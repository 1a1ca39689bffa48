// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include "ajar_runtime.h"

namespace ajar::runtime {

/// A failure that reaches the caller of the ABI as code and message.
class Error : public std::runtime_error {
public:
    Error(ajar_runtime_result code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ajar_runtime_result code() const { return code_; }

private:
    ajar_runtime_result code_;
};

} // namespace ajar::runtime
