// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <mutex>
#include <unordered_map>

#include "base/error.h"

namespace ajar {

/// Objects behind the opaque handles of the ABI. A handle is a number that is never used twice,
/// dressed as a pointer, so NULL, stale and foreign values are recognised without reading them.
template <class Object>
class HandleTable {
public:
    void* add(std::shared_ptr<Object> object) {
        const std::scoped_lock lock(mutex_);
        const uintptr_t id = next_;
        next_ += 16;
        objects_.emplace(id, std::move(object));
        return reinterpret_cast<void*>(id);
    }
    std::shared_ptr<Object> get(const void* handle) const {
        const std::scoped_lock lock(mutex_);
        const auto it = objects_.find(reinterpret_cast<uintptr_t>(handle));
        if (it == objects_.end()) throw Error(AJAR_ERROR_HANDLE, "the handle is null, released or not of this kind");
        return it->second;
    }
    std::shared_ptr<Object> take(const void* handle) {
        const std::scoped_lock lock(mutex_);
        const auto node = objects_.extract(reinterpret_cast<uintptr_t>(handle));
        if (node.empty()) throw Error(AJAR_ERROR_HANDLE, "the handle is null, released or not of this kind");
        return node.mapped();
    }

    /// Tables start apart, so that a handle of one kind is foreign to the others.
    explicit HandleTable(uintptr_t first) : next_(first) {}

private:
    mutable std::mutex mutex_;
    std::unordered_map<uintptr_t, std::shared_ptr<Object>> objects_;
    uintptr_t next_;
};

} // namespace ajar
