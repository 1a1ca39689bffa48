// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// An OpenGL context without a window, to run a compute shader on whatever driver there is: Mesa's
// software one on a machine without a graphics card.

#include <cstdint>
#include <string>
#include <vector>

namespace kit {

/// The only context of its process while it lives.
class ComputeContext {
public:
    /// ok() is false where no driver offers OpenGL 4.3; why() says what was missing.
    ComputeContext();
    ~ComputeContext();
    ComputeContext(const ComputeContext&) = delete;
    ComputeContext& operator=(const ComputeContext&) = delete;

    bool ok() const { return missing_.empty(); }
    const std::string& why() const { return missing_; }
    /// Name of the driver.
    std::string renderer() const;

    /// Compiles a compute shader and uses it. Throws std::runtime_error with the compiler's message.
    void use(const std::string& source);
    /// Fills the storage buffer of a binding; 0 words make it one word long.
    void fill(uint32_t binding, const uint32_t* words, size_t count);
    std::vector<uint32_t> read(uint32_t binding) const;
    /// Runs work groups and waits for them. Throws std::runtime_error on an OpenGL error.
    void dispatch(uint32_t groups);

private:
    void* display_ = nullptr;
    void* context_ = nullptr;
    uint32_t program_ = 0;
    std::vector<uint32_t> buffers_;
    std::vector<size_t> sizes_;
    std::string missing_;
};

} // namespace kit
