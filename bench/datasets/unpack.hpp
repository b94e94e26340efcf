#pragma once

#include <cstdint>
#include <string>

namespace evbench {

/// Unpacks an archive (zip, tar.gz) into a folder that is there and empty. An archive whose content is all in one
/// folder gives that folder's content.
///
/// Throws BadArchive (core/io/archive.hpp), naming the archive and the entry, for a damaged archive, a name that leads
/// out of the folder (absolute, ".."), a link or device, a name that is there twice, and for more than `limit` bytes in
/// all; InputError where writing fails and for an Interruption. Files that were unpacked until then stay.
void unpack(const std::string& archive, const std::string& folder, std::uint64_t limit);

}  // namespace evbench
