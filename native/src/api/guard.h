// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstring>
#include <new>
#include <string>

#include "base/error.h"

namespace ajar {

/// Last failure of this thread, behind ajar_error_message and ajar_error_culprit.
struct LastError {
    std::string message, culprit;
};
LastError& last_error();

ajar_result remember(ajar_result code, const char* message, const char* culprit) noexcept;

/// Runs the body of an ABI function; every failure becomes a code and nothing is thrown past it.
template <class Body>
ajar_result guarded(Body&& body) noexcept {
    try {
        return body();
    } catch (const Error& e) {
        return remember(e.code(), e.what(), e.culprit().c_str());
    } catch (const std::bad_alloc&) {
        return remember(AJAR_ERROR_MEMORY, "not enough memory", "");
    } catch (const std::length_error&) {
        return remember(AJAR_ERROR_ARGUMENT, "a count is too large", "");
    } catch (const std::exception& e) {
        return remember(AJAR_ERROR_INTERNAL, e.what(), "");
    } catch (...) {
        return remember(AJAR_ERROR_INTERNAL, "unknown failure", "");
    }
}

/// Checks a public struct: not null and of a size this library knows.
template <class T>
const T& checked(const T* desc) {
    if (desc == nullptr) throw Error(AJAR_ERROR_ARGUMENT, "a description is null");
    if (desc->struct_size != sizeof(T))
        throw Error(AJAR_ERROR_STRUCT_SIZE,
                    "struct_size is not one this library knows; fill the struct with its init function");
    return *desc;
}

template <class T>
T& required(T* out) {
    if (out == nullptr) throw Error(AJAR_ERROR_ARGUMENT, "an output pointer is null");
    return *out;
}

/// Zeroed struct with its size set.
template <class T>
void init_struct(T* s) {
    if (s == nullptr) return;
    std::memset(s, 0, sizeof(T));
    s->struct_size = sizeof(T);
}

/// Copies text, cut to size and NUL-terminated; nothing if there is no room at all.
inline void copy_text(const std::string& text, char* out, uint64_t size) {
    if (out == nullptr || size == 0) return;
    const size_t n = std::min<size_t>(text.size(), size - 1);
    std::memcpy(out, text.data(), n);
    out[n] = 0;
}

} // namespace ajar
