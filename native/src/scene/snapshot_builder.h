// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "scene/snapshot.h"

namespace ajar {

/// Copies and validates the caller's scene; the only place that rejects data. Throws Error with
/// the name of the culprit; what is merely odd becomes a warning and is left out.
class SnapshotBuilder {
public:
    explicit SnapshotBuilder(std::string name);

    uint32_t add_texture(const ajar_texture_desc& desc);
    uint32_t add_material(const ajar_material_desc& desc);
    uint32_t add_mesh(const ajar_mesh_desc& desc);
    uint32_t add_element(const ajar_element_desc& desc);
    uint32_t add_instance(const ajar_instance_desc& desc);
    uint32_t add_light(const ajar_light_desc& desc);
    uint32_t add_page(uint32_t width, uint32_t height);
    void set_sky(const ajar_sky_desc& desc);
    /// Flattens instances into world space and freezes the scene; no add after it.
    void commit();

    bool committed() const { return committed_; }
    const std::vector<Warning>& warnings() const { return snapshot_->warnings; }
    std::shared_ptr<const Snapshot> snapshot() const { return snapshot_; }

private:
    void warn(const std::string& culprit, const std::string& text);
    void check_materials() const;
    void check_element(uint32_t id, bool light_set, const std::string& culprit) const;
    void check_instance(const Instance& instance) const;
    void give_fallback_material();
    void choose_origin();
    void flatten(uint32_t instance_index);
    void group_triangles();

    std::shared_ptr<Snapshot> snapshot_;
    bool committed_ = false;
};

} // namespace ajar
