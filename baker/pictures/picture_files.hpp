// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "baker/pictures/picture.hpp"

namespace spm::baker {

/// Makes the folder of `--png`, if it does not exist. Throws BakeError file_or_device where it
/// cannot be made.
std::filesystem::path make_picture_folder(const std::string& name);

/// Writes a picture as a PNG file and returns its path. Throws BakeError as write_file does.
std::string save_picture(const Picture& picture, const std::filesystem::path& path);

}  // namespace spm::baker
