// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "api/handles.h"
#include "api/job.h"
#include "api/reference_job.h"
#include "receiver/layout.h"
#include "scene/snapshot_builder.h"

namespace ajar {

HandleTable<SnapshotBuilder>& scenes();
HandleTable<Job>& jobs();
HandleTable<Layout>& layouts();
HandleTable<ReferenceJob>& references();

} // namespace ajar
