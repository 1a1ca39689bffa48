// SPDX-License-Identifier: GPL-3.0-or-later
// Version, error texts and the tables behind the handles.
#include "api/guard.h"
#include "api/tables.h"

namespace ajar {

// Leaked on purpose: a host may release handles while static objects are being destroyed.
HandleTable<SnapshotBuilder>& scenes() {
    static auto* table = new HandleTable<SnapshotBuilder>(0x1001);
    return *table;
}
HandleTable<Job>& jobs() {
    static auto* table = new HandleTable<Job>(0x1002);
    return *table;
}
HandleTable<Layout>& layouts() {
    static auto* table = new HandleTable<Layout>(0x1003);
    return *table;
}
HandleTable<ReferenceJob>& references() {
    static auto* table = new HandleTable<ReferenceJob>(0x1004);
    return *table;
}

LastError& last_error() {
    static thread_local LastError error;
    return error;
}

ajar_result remember(ajar_result code, const char* message, const char* culprit) noexcept {
    try {
        last_error().message = message;
        last_error().culprit = culprit;
    } catch (...) { // no memory even for the message: the code has to do
    }
    return code;
}

} // namespace ajar

extern "C" {

AJAR_API uint32_t ajar_abi_version(void) { return AJAR_ABI_VERSION; }
AJAR_API const char* ajar_version(void) { return AJAR_VERSION_TEXT; }
AJAR_API const char* ajar_result_text(ajar_result code) { return ajar::result_text(code); }
AJAR_API const char* ajar_error_message(void) { return ajar::last_error().message.c_str(); }
AJAR_API const char* ajar_error_culprit(void) { return ajar::last_error().culprit.c_str(); }

AJAR_API const char* ajar_stage_name(uint32_t stage) {
    static const char* const names[] = {"idle",  "lightmap texels", "ray tracer", "direct light", "bounces",
                                        "pilot", "final gather",    "seams",      "encode",       "done"};
    static_assert(std::size(names) == AJAR_STAGE_COUNT);
    return stage < AJAR_STAGE_COUNT ? names[stage] : "unknown";
}

} // extern "C"
