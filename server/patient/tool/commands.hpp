// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <memory>

#include "common/model/newborn_shape.hpp"
#include "common/process/command_line.hpp"
#include "server/patient/imaging/read.hpp"
#include "server/patient/segmentation/surfaces.hpp"
#include "server/patient/tool/terminal.hpp"

namespace eti::tool {

/// The selected command; set by parsing the command line.
using Run = std::function<Result()>;

void add_build(CommandLine& app, Run& run);
void add_check(CommandLine& app, Run& run);

/// Options for all parameters of the newborn's shape.
class ShapeOptions {
  public:
    explicit ShapeOptions(CommandLine& command);
    /// The requested shape. Throws std::runtime_error if there is no such newborn.
    [[nodiscard]] NewbornShape shape() const;
    /// Whether any of the options was given.
    [[nodiscard]] bool any() const;

  private:
    struct Typed;
    std::shared_ptr<Typed> typed_;
};

/// Reads a volume and prints its remarks. `series`: see imaging::read_dicom(). Throws imaging::VolumeError,
/// CancelledError.
[[nodiscard]] imaging::LoadedVolume read_volume(const std::filesystem::path& file,
                                                const std::string& series = {});
/// Reads labels with eti-anatomy's numbering, or a segmentation whose segments have names (.seg.nrrd).
[[nodiscard]] imaging::Mask read_labels(const std::filesystem::path& file);

/// Reads a points file and prints its remarks; no points for an empty name.
[[nodiscard]] Points read_landmarks(const std::filesystem::path& file);

/// Writes each surface as STL into a folder, which is created, and reports it.
[[nodiscard]] Result write_surfaces(const std::vector<NamedSurface>& surfaces,
                                    const std::filesystem::path& folder);

}  // namespace eti::tool
