// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pass/bake.h"

namespace ajar {

/// Adds light that most receivers missed to the standard errors of a bake, calibrated already, and to their spread.
///
/// A small bright opening is met by few rays. A receiver whose rays met it says so: one ray is most of its light. One
/// whose rays did not is too dark, and its strata, which all saw the same, call that exact. What the first have more
/// than the others is what these lack: of a tile's mean light m it is the share
///     s = 1 - mean of the others / mean of all,
/// so one with light l lacks l s / (1 - s). If a part p of all met it, s m comes with chance p: standard error s m /
/// sqrt(p). Where few in a whole scene met it, s is not known either, which the spread says.
void state_missed_light(const LightmapReceivers& receivers, BakeResult& result);

} // namespace ajar
