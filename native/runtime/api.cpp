// SPDX-License-Identifier: Apache-2.0
// ajar_runtime_*: check, guard, forward.
#include <cmath>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>
#include <unordered_map>

#include "error.h"
#include "light_patch.h"
#include "runtime.h"

namespace {

using namespace ajar::runtime;

std::string& last_message() {
    static thread_local std::string message;
    return message;
}

ajar_runtime_result remember(ajar_runtime_result code, const char* message) noexcept {
    try {
        last_message() = message;
    } catch (...) { // no memory even for the message: the code has to do
    }
    return code;
}

/// Runs the body of a function; every failure becomes a code and nothing is thrown past it.
template <class Body>
ajar_runtime_result guarded(Body&& body) noexcept {
    try {
        body();
        return AJAR_RUNTIME_OK;
    } catch (const Error& e) {
        return remember(e.code(), e.what());
    } catch (const std::bad_alloc&) {
        return remember(AJAR_RUNTIME_ERROR_MEMORY, "not enough memory");
    } catch (const std::exception& e) {
        return remember(AJAR_RUNTIME_ERROR_INTERNAL, e.what());
    } catch (...) {
        return remember(AJAR_RUNTIME_ERROR_INTERNAL, "unknown failure");
    }
}

/// The runtimes behind handles. A handle is a number that is never used twice, dressed as a pointer,
/// so NULL, stale and foreign values are recognised without reading them.
class Handles {
public:
    ajar_runtime add(std::shared_ptr<Runtime> runtime) {
        const std::scoped_lock lock(mutex_);
        next_ += 16;
        runtimes_.emplace(next_, std::move(runtime));
        return reinterpret_cast<ajar_runtime>(next_);
    }
    std::shared_ptr<Runtime> get(ajar_runtime handle) {
        const std::scoped_lock lock(mutex_);
        return find(handle)->second;
    }
    void release(ajar_runtime handle) {
        const std::scoped_lock lock(mutex_);
        runtimes_.erase(find(handle));
    }

private:
    std::unordered_map<uintptr_t, std::shared_ptr<Runtime>>::iterator find(ajar_runtime handle) {
        const auto it = runtimes_.find(reinterpret_cast<uintptr_t>(handle));
        if (it == runtimes_.end()) throw Error(AJAR_RUNTIME_ERROR_HANDLE, "the handle is null, released or foreign");
        return it;
    }

    std::mutex mutex_;
    std::unordered_map<uintptr_t, std::shared_ptr<Runtime>> runtimes_;
    uintptr_t next_ = 0x2001;
};

// Leaked on purpose: a host may release handles while static objects are being destroyed.
Handles& handles() {
    static auto* table = new Handles;
    return *table;
}

template <class T>
T& required(T* pointer) {
    if (pointer == nullptr) throw Error(AJAR_RUNTIME_ERROR_ARGUMENT, "a pointer is null");
    return *pointer;
}

/// An output struct: not null and of a size this library knows.
template <class T>
T& checked(T* out) {
    if (required(out).struct_size != sizeof(T))
        throw Error(AJAR_RUNTIME_ERROR_STRUCT_SIZE, "struct_size is not one this library knows; use the init function");
    return *out;
}

template <class T>
void init_struct(T* s) {
    if (s == nullptr) return;
    std::memset(s, 0, sizeof(T));
    s->struct_size = sizeof(T);
}

const ElementState& element_of(const Runtime& runtime, uint32_t element) {
    if (element >= runtime.elements().size())
        throw Error(AJAR_RUNTIME_ERROR_ARGUMENT, "there is no element " + std::to_string(element));
    return runtime.elements()[element];
}

Page& page_of(Runtime& runtime, uint32_t page) {
    if (page >= runtime.pages().size())
        throw Error(AJAR_RUNTIME_ERROR_ARGUMENT, "there is no page " + std::to_string(page));
    return runtime.pages()[page];
}

void fill_element(const ElementState& state, ajar_runtime_element& out) {
    out.kind = static_cast<uint32_t>(state.kind);
    out.name = state.name.c_str();
    out.weight = state.weight;
    out.start_weight = state.start_weight;
    out.color[0] = state.color.r;
    out.color[1] = state.color.g;
    out.color[2] = state.color.b;
    out.dispatches = static_cast<uint32_t>(state.dispatches.size());
    out.texels = state.texels;
}

uint32_t find_element(const Runtime& runtime, const char* name) {
    for (uint32_t i = 0; i < runtime.elements().size(); ++i)
        if (runtime.elements()[i].name == name) return i;
    throw Error(AJAR_RUNTIME_ERROR_NOT_FOUND, std::string("the package has no element \"") + name + "\"");
}

void read_irradiance(Page& page, uint32_t channels, float* buffer, uint64_t float_count) {
    if (channels != 3 && channels != 4) throw Error(AJAR_RUNTIME_ERROR_ARGUMENT, "channels must be 3 or 4");
    if (float_count != uint64_t{channels} * page.width() * page.height())
        throw Error(AJAR_RUNTIME_ERROR_BUFFER, "the buffer must hold width * height * channels floats");
    page.read_irradiance(channels, &required(buffer));
}

} // namespace

extern "C" {

uint32_t ajar_runtime_abi_version(void) { return AJAR_RUNTIME_ABI_VERSION; }

const char* ajar_runtime_result_text(ajar_runtime_result code) {
    switch (code) {
        case AJAR_RUNTIME_OK:
            return "success";
        case AJAR_RUNTIME_ERROR_ARGUMENT:
            return "an argument is out of range";
        case AJAR_RUNTIME_ERROR_STRUCT_SIZE:
            return "struct_size is not one this library knows";
        case AJAR_RUNTIME_ERROR_HANDLE:
            return "the handle is null, released or foreign";
        case AJAR_RUNTIME_ERROR_NOT_FOUND:
            return "there is no such element";
        case AJAR_RUNTIME_ERROR_DATA:
            return "the package is damaged or of another version";
        case AJAR_RUNTIME_ERROR_MEMORY:
            return "not enough memory";
        case AJAR_RUNTIME_ERROR_IO:
            return "a file cannot be read";
        case AJAR_RUNTIME_ERROR_BUFFER:
            return "a buffer is of wrong size";
        case AJAR_RUNTIME_ERROR_INTERNAL:
            return "internal error";
        default:
            return "unknown result";
    }
}

const char* ajar_runtime_error_message(void) { return last_message().c_str(); }

ajar_runtime_result ajar_runtime_open(const char* directory, ajar_runtime* out_runtime) {
    return guarded([&] {
        required(out_runtime) = nullptr;
        *out_runtime = handles().add(std::make_shared<Runtime>(&required(directory)));
    });
}

ajar_runtime_result ajar_runtime_release(ajar_runtime* runtime) {
    return guarded([&] {
        handles().release(required(runtime));
        *runtime = nullptr;
    });
}

void ajar_runtime_element_init(ajar_runtime_element* element) { init_struct(element); }

ajar_runtime_result ajar_runtime_element_count(ajar_runtime runtime, uint32_t* out_count) {
    return guarded([&] { required(out_count) = static_cast<uint32_t>(handles().get(runtime)->elements().size()); });
}

ajar_runtime_result ajar_runtime_get_element(ajar_runtime runtime, uint32_t element,
                                             ajar_runtime_element* out_element) {
    return guarded([&] {
        const auto r = handles().get(runtime);
        fill_element(element_of(*r, element), checked(out_element));
    });
}

ajar_runtime_result ajar_runtime_find_element(ajar_runtime runtime, const char* name, uint32_t* out_element) {
    return guarded([&] { required(out_element) = find_element(*handles().get(runtime), &required(name)); });
}

ajar_runtime_result ajar_runtime_set_weight(ajar_runtime runtime, uint32_t element, float weight) {
    return guarded([&] { handles().get(runtime)->set_weight(element, weight); });
}

ajar_runtime_result ajar_runtime_set_color(ajar_runtime runtime, uint32_t element, const float color[3]) {
    return guarded([&] {
        const auto r = handles().get(runtime);
        required(color);
        r->set_color(element, {color[0], color[1], color[2]});
    });
}

float ajar_runtime_door_openness(float angle, float open_angle) {
    constexpr float kHalfTurn = 3.14159265f;
    if (!(std::fabs(angle) > 0.0f) || !(std::fabs(open_angle) > 0.0f)) return 0.0f; // or NaN
    const float full = std::fmin(std::fabs(open_angle), kHalfTurn);
    return std::fmin(std::sin(std::fmin(std::fabs(angle), full) * 0.5f) / std::sin(full * 0.5f), 1.0f);
}

void ajar_runtime_stats_init(ajar_runtime_stats* stats) { init_struct(stats); }

ajar_runtime_result ajar_runtime_update(ajar_runtime runtime, ajar_runtime_stats* out_stats) {
    return guarded([&] {
        const auto r = handles().get(runtime);
        if (out_stats != nullptr) checked(out_stats);
        const ajar_runtime_stats stats = r->update();
        if (out_stats != nullptr) *out_stats = stats;
    });
}

ajar_runtime_result ajar_runtime_page_count(ajar_runtime runtime, uint32_t* out_count) {
    return guarded([&] { required(out_count) = static_cast<uint32_t>(handles().get(runtime)->pages().size()); });
}

ajar_runtime_result ajar_runtime_page_size(ajar_runtime runtime, uint32_t page, uint32_t* out_width,
                                           uint32_t* out_height) {
    return guarded([&] {
        const auto r = handles().get(runtime);
        const Page& p = page_of(*r, page);
        required(out_width) = p.width();
        required(out_height) = p.height();
    });
}

ajar_runtime_result ajar_runtime_page_dirty(ajar_runtime runtime, uint32_t page, ajar_runtime_rect* out_rect) {
    return guarded([&] {
        const auto r = handles().get(runtime);
        page_of(*r, page);
        required(out_rect) = r->dirty(page);
    });
}

ajar_runtime_result ajar_runtime_page_texels(ajar_runtime runtime, uint32_t page, const uint32_t** out_irradiance,
                                             const uint32_t** out_direction) {
    return guarded([&] {
        const auto r = handles().get(runtime);
        Page& p = page_of(*r, page);
        required(out_irradiance) = p.irradiance();
        required(out_direction) = p.direction();
    });
}

ajar_runtime_result ajar_runtime_page_scale(ajar_runtime runtime, uint32_t page, float* out_scale) {
    return guarded([&] {
        const auto r = handles().get(runtime);
        required(out_scale) = page_of(*r, page).scale();
    });
}

ajar_runtime_result ajar_runtime_read_irradiance(ajar_runtime runtime, uint32_t page, uint32_t channels, float* buffer,
                                                 uint64_t float_count) {
    return guarded([&] {
        const auto r = handles().get(runtime);
        read_irradiance(page_of(*r, page), channels, buffer, float_count);
    });
}

void ajar_runtime_patch_init(ajar_runtime_patch* patch) { init_struct(patch); }

ajar_runtime_result ajar_runtime_add_patch(const ajar_runtime_patch* patch, const uint16_t* atlas, uint32_t atlas_width,
                                           uint32_t atlas_height, const float factor[3], float* light, uint32_t width,
                                           uint32_t height) {
    return guarded([&] {
        checked(patch);
        required(atlas), required(factor), required(light);
        add_patch(*patch, atlas, atlas_width, atlas_height, factor, light, width, height);
    });
}

void ajar_runtime_buffers_init(ajar_runtime_buffers* buffers) { init_struct(buffers); }

ajar_runtime_result ajar_runtime_get_buffers(ajar_runtime runtime, ajar_runtime_buffers* out_buffers) {
    return guarded([&] {
        const auto r = handles().get(runtime);
        checked(out_buffers) = r->buffers();
    });
}

void ajar_runtime_work_init(ajar_runtime_work* work) {
    init_struct(work);
    if (work != nullptr) ajar_runtime_stats_init(&work->stats);
}

ajar_runtime_result ajar_runtime_plan_update(ajar_runtime runtime, ajar_runtime_work* out_work) {
    return guarded([&] {
        const auto r = handles().get(runtime);
        checked(out_work);
        *out_work = r->plan_update();
    });
}

} // extern "C"
