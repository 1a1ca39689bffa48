// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "terms_file.h"

namespace ajar::runtime {

// Checksums tell damage; these tell files that were made wrong, by error or intent. Both return what
// is wrong, or null.

/// Elements, pages and terms of a file whose sections are in place.
const char* find_table_fault(const TermsFile& file, size_t string_bytes);

/// Dispatches of a file whose tables are right. Takes a bit of memory per texel of the pages.
const char* find_dispatch_fault(const TermsFile& file);

} // namespace ajar::runtime
