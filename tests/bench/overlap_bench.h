// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// Registers updates of packages made of numbers, of 1 to 300 terms at each texel, with all light sets on and with one.
/// same: all texels have the same terms; mixed: neighbours differ.
void add_overlap_benches();
