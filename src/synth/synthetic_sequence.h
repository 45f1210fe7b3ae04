// SPDX-License-Identifier: Apache-2.0
// Writes a synthetic world to disk in the layout of the TUM RGB-D benchmark.
#pragma once

#include <filesystem>
#include <functional>

#include "synth/synthetic_world.h"

namespace rds {

// Writes rgb/ depth/ mask/ (PNG), rgb.txt, depth.txt, mask.txt, associations.txt, groundtruth.txt and camera.yaml into
// `directory`, which is created; files of the same names are replaced. Text files come last, so a sequence that was
// cut short is seen to be incomplete. `on_frame` is called after each frame with the number of frames written; may be
// empty. Throws InputError, naming the file, if something cannot be written.
void WriteSyntheticSequence(const SyntheticWorld& world, const std::filesystem::path& directory,
                            const std::function<void(int)>& on_frame = {});

}  // namespace rds
