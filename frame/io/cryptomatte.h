#pragma once

#include <OpenEXR/ImfHeader.h>

#include <vector>

namespace becalm::io {

/// Removes from `headers` what is told of the Cryptomattes (`cryptomatte/ID/name`, `cryptomatte/ID/manifest`
/// ...) of which `before` has channels and `headers` have none left: readers look for those channels. See
/// Friedman and Jones 2015, Cryptomatte specification.
void leave_out_mattes(const std::vector<Imf::Header>& before, std::vector<Imf::Header>& headers);

}  // namespace becalm::io
