// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <string>
#include <vector>

#include "ajar/ajar.h"
#include "byte_source.h"

/// Calls the engine's ABI at random. Pointers are NULL or good, since a C function cannot tell others; counts never
/// exceed the memory behind them; scenes, pages and samples are so few that a bake takes milliseconds.
class EngineFuzz {
public:
    /// folder: packages are written into it and nowhere else.
    EngineFuzz(ByteSource& bytes, std::string folder);
    ~EngineFuzz();
    EngineFuzz(const EngineFuzz&) = delete;
    EngineFuzz& operator=(const EngineFuzz&) = delete;

    /// One call, or a few that belong together. Says which rule of the ABI they broke; empty if none.
    std::string step();

private:
    static constexpr size_t kMemory = 512;    ///< numbers to point at
    static constexpr uint32_t kMostBakes = 6; ///< jobs and references, as they take the most time

    // What arguments are made of.
    uint32_t pick(uint32_t count) { return bytes_.pick(count); }
    bool chance(double p) { return bytes_.chance(p); }
    uint32_t integer() { return bytes_.integer(); }
    float scalar() { return bytes_.scalar(); }
    uint32_t size_of(size_t right) { return chance(0.97) ? static_cast<uint32_t>(right) : integer(); }
    /// Usual, and at times any number.
    uint32_t mostly(uint32_t usual, double p = 0.95) { return chance(p) ? usual : integer(); }
    /// Usual, and at times a number that is far too high: costly numbers must not be drawn from all.
    uint32_t cheap(uint32_t usual);
    template <class T>
    T* maybe(T* p) {
        return chance(0.97) ? p : nullptr;
    }
    template <class Handle>
    Handle some(const std::vector<Handle>& known) {
        if (known.empty() || chance(0.05)) return std::bit_cast<Handle>(uintptr_t{integer()});
        return known[known.size() - 1 - pick(static_cast<uint32_t>(known.size()))];
    }
    const char* name();
    void transform(double* m);
    /// Memory with at least count numbers behind it: calm ones, those of 0..1, or wild ones.
    const float* numbers(size_t count);
    const float* unit_numbers(size_t count);
    const uint32_t* indices(size_t count);
    void poke();

    /// Notes what a result breaks, and passes it on.
    ajar_result note(ajar_result result);
    template <class Handle>
    ajar_result release(std::vector<Handle>& known, ajar_result (*call)(Handle*));
    template <class Handle>
    ajar_result keep(std::vector<Handle>& known, Handle created, ajar_result result) {
        if (created != nullptr) known.push_back(created);
        return note(result);
    }
    /// A scene of ordinary numbers has ordinary light.
    void expect_finite(const std::vector<float>& light, const char* what);
    void library_call();

    // engine_fuzz_scene.cpp
    void scene_call();
    void room();
    void create_scene();
    void add_part(ajar_scene scene);
    void add_element(ajar_scene scene, uint32_t kind);
    void add_instance(ajar_scene scene);
    void add_light(ajar_scene scene);
    void add_page(ajar_scene scene);
    void set_sky(ajar_scene scene);
    void read_scene(ajar_scene scene);

    // engine_fuzz_surface.cpp
    void add_texture(ajar_scene scene);
    ajar_input input();
    void add_material(ajar_scene scene);
    void add_mesh(ajar_scene scene);
    void add_soup(ajar_scene scene, ajar_mesh_desc& d);
    void add_shape(ajar_scene scene, ajar_mesh_desc& d);

    // engine_fuzz_job.cpp
    void job_call();
    ajar_settings settings();
    void start_job(ajar_scene scene);
    void read_job(ajar_job job);
    void read_layer(ajar_job job, uint32_t page, uint32_t layer);
    void read_term(ajar_job job, uint32_t term);
    void read_report(ajar_job job);
    void write_package(ajar_job job);
    void open_package(const std::string& folder);

    // engine_fuzz_reference.cpp
    void reference_call();
    ajar_reference_settings reference_settings(std::vector<float>& weights);
    void start_reference(ajar_scene scene);
    void read_reference(ajar_reference reference);

    // engine_fuzz_layout.cpp
    void layout_call();
    void atlas();
    void create_layout();
    void add_layout_mesh(ajar_layout layout);
    void add_layout_soup(ajar_layout layout, ajar_layout_mesh_desc& d);
    void add_layout_shape(ajar_layout layout, ajar_layout_mesh_desc& d);
    void read_layout(ajar_layout layout);

    ByteSource& bytes_;
    const std::string folder_;
    std::string broken_;
    bool any_wild_ = false; ///< wild_ was pointed at
    uint32_t bakes_left_ = kMostBakes;
    float wild_[kMemory], calm_[kMemory], unit_[kMemory];
    uint32_t indices_[kMemory];
    std::vector<ajar_scene> scenes_;
    std::vector<ajar_job> jobs_;
    std::vector<ajar_reference> references_;
    std::vector<ajar_layout> layouts_;
};

template <class Handle>
ajar_result EngineFuzz::release(std::vector<Handle>& known, ajar_result (*call)(Handle*)) {
    if (known.empty() || chance(0.1)) {
        Handle foreign = std::bit_cast<Handle>(uintptr_t{integer()} << 32);
        return note(call(maybe(&foreign)));
    }
    const size_t i = pick(static_cast<uint32_t>(known.size()));
    const ajar_result result = call(&known[i]);
    known.erase(known.begin() + static_cast<ptrdiff_t>(i));
    return note(result);
}
