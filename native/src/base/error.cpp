// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.h"

namespace ajar {

const char* result_text(ajar_result code) {
    switch (code) {
        case AJAR_OK:
            return "success";
        case AJAR_CANCELLED:
            return "cancelled";
        case AJAR_RUNNING:
            return "still running";
        case AJAR_ERROR_ARGUMENT:
            return "invalid argument";
        case AJAR_ERROR_STRUCT_SIZE:
            return "unknown struct size";
        case AJAR_ERROR_HANDLE:
            return "invalid handle";
        case AJAR_ERROR_STATE:
            return "call out of order";
        case AJAR_ERROR_INPUT:
            return "scene data cannot be baked";
        case AJAR_ERROR_MEMORY:
            return "out of memory";
        case AJAR_ERROR_IO:
            return "file could not be read or written";
        case AJAR_ERROR_BUFFER:
            return "buffer too small";
        case AJAR_ERROR_CPU:
            return "processor not supported";
        case AJAR_ERROR_INTERNAL:
            return "internal error";
        default:
            return "unknown result code";
    }
}

} // namespace ajar
